// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Converts between a calibration and OpenCV's camera matrix and distortion vector; finds the
// smallest model that holds the coefficients. Which lenses OpenCV has, they say themselves
// (LensTraits::opencv).

#include "calvin/io/opencv_camera.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calvin/camera/lens_table.hpp"

namespace calvin::io {

namespace {

// The lenses of that form by their number of coefficients: a file's take the first that fits.
std::vector<const LensTraits*> lenses_of(OpenCvForm form) {
  return lenses_where([form](const LensTraits& lens) { return lens.opencv == form; });
}

const LensTraits& largest(OpenCvForm form) { return *lenses_of(form).back(); }

// The smallest model that holds all coefficients that are not zero, brown5 at least from 5 on.
const LensTraits& smallest_model(const std::vector<double>& d) {
  std::size_t used = d.size();
  while (used > 5 && d[used - 1] == 0) --used;
  const auto family = lenses_of(OpenCvForm::kBrown);
  return **std::find_if(family.begin(), family.end(), [used](const LensTraits* lens) {
    return lens->coefficients.size() >= used;
  });
}

Result<const LensTraits*> model_for(const OpenCvCamera& camera) {
  const auto& d = camera.distortion;
  if (camera.fisheye) {
    const LensTraits& fisheye = largest(OpenCvForm::kFisheye);
    if (d.empty() || d.size() == fisheye.coefficients.size()) return &fisheye;
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("a fisheye camera has 4 distortion coefficients, not {}", d.size()));
  }
  const auto family = lenses_of(OpenCvForm::kBrown);
  if (std::none_of(family.begin(), family.end(),
                   [&](const LensTraits* lens) { return lens->coefficients.size() == d.size(); })) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("there are {} distortion coefficients; 4, 5, 8, 12 or 14 are right", d.size()));
  }
  return &smallest_model(d);
}

}  // namespace

const LensTraits* opencv_lens(std::string_view model) {
  const LensTraits* lens = find_lens(model);
  return lens == nullptr || lens->opencv == OpenCvForm::kNone ? nullptr : lens;
}

std::vector<std::string_view> coefficient_names(bool fisheye, std::size_t count) {
  if (fisheye) return largest(OpenCvForm::kFisheye).coefficients;
  auto names = largest(OpenCvForm::kBrown).coefficients;
  names.resize(std::min(count, names.size()));
  return names;
}

Result<Calibration> from_opencv(const OpenCvCamera& camera, ImageSize size) {
  const auto& k = camera.k;
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
    return make_error(ErrorCode::kMalformed,
                      "the camera matrix has not the form fx 0 cx, 0 fy cy, 0 0 1");
  }
  const auto lens = model_for(camera);
  if (!lens) return tl::unexpected(lens.error());
  Calibration calibration;
  calibration.image_size = size;
  calibration.model = (*lens)->model;
  calibration.parameters = {{"fx", k[0], {}}, {"fy", k[4], {}}, {"cx", k[2], {}}, {"cy", k[5], {}}};
  const auto& names = (*lens)->coefficients;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double value = camera.distortion.empty() ? 0 : camera.distortion[i];
    calibration.parameters.push_back({std::string(names[i]), value, {}});
  }
  if (k[1] != 0) calibration.parameters.push_back({"skew", k[1], {}});
  return calibration;
}

Result<OpenCvCamera> to_opencv(const Calibration& calibration) {
  const auto value = [&](std::string_view name) {
    const Parameter* p = calibration.find(name);
    return p == nullptr ? 0.0 : p->value;
  };
  OpenCvCamera camera;
  const LensTraits* lens = opencv_lens(calibration.model);
  if (lens == nullptr) {
    return make_error(ErrorCode::kUnsupported, "OpenCV has no such camera model.");
  }
  camera.fisheye = lens->opencv == OpenCvForm::kFisheye;
  camera.k = {value("fx"), value("skew"), value("cx"), 0, value("fy"), value("cy"), 0, 0, 1};
  for (const std::string_view name :
       coefficient_names(camera.fisheye, std::max<std::size_t>(lens->coefficients.size(), 4))) {
    camera.distortion.push_back(value(name));
  }
  // As it will be read again.
  if (!camera.fisheye) {
    camera.distortion.resize(smallest_model(camera.distortion).coefficients.size());
  }
  return camera;
}

}  // namespace calvin::io
