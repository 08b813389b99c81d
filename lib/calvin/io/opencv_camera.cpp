// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Converts between a calibration and OpenCV's camera matrix and distortion vector; finds the
// smallest model that holds the coefficients.

#include "calvin/io/opencv_camera.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace calvin::io {

namespace {

constexpr std::array<std::string_view, 14> kBrownOrder = {
    "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "taux", "tauy"};
constexpr std::array<std::string_view, 4> kFisheyeOrder = {"k1", "k2", "k3", "k4"};

struct Row {
  std::string_view model;
  std::size_t count;
};
// By size: a file's coefficients take the first model that fits.
constexpr std::array<Row, 6> kBrownFamily = {{{"pinhole", 0},
                                              {"brown4", 4},
                                              {"brown5", 5},
                                              {"rational8", 8},
                                              {"thinprism12", 12},
                                              {"tilted14", 14}}};

// The smallest model that holds all coefficients that are not zero, brown5 at least from 5 on.
const Row& smallest_model(const std::vector<double>& d) {
  std::size_t used = d.size();
  while (used > 5 && d[used - 1] == 0) --used;
  return *std::find_if(kBrownFamily.begin(), kBrownFamily.end(),
                       [&](const Row& row) { return row.count >= used; });
}

Result<std::string_view> model_for(const OpenCvCamera& camera) {
  const auto& d = camera.distortion;
  if (camera.fisheye) {
    if (d.empty() || d.size() == kFisheyeOrder.size()) return "fisheye";
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("a fisheye camera has 4 distortion coefficients, not {}", d.size()));
  }
  if (std::none_of(kBrownFamily.begin(), kBrownFamily.end(),
                   [&](const Row& row) { return row.count == d.size(); })) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("there are {} distortion coefficients; 4, 5, 8, 12 or 14 are right", d.size()));
  }
  return smallest_model(d).model;
}

}  // namespace

std::vector<std::string_view> coefficient_names(bool fisheye, std::size_t count) {
  if (fisheye) return {kFisheyeOrder.begin(), kFisheyeOrder.end()};
  return {kBrownOrder.begin(),
          kBrownOrder.begin() + static_cast<std::ptrdiff_t>(std::min(count, kBrownOrder.size()))};
}

std::optional<std::size_t> coefficient_count(std::string_view model) {
  if (model == "fisheye") return kFisheyeOrder.size();
  const auto row = std::find_if(kBrownFamily.begin(), kBrownFamily.end(),
                                [&](const Row& r) { return r.model == model; });
  return row == kBrownFamily.end() ? std::nullopt : std::optional(row->count);
}

Result<Calibration> from_opencv(const OpenCvCamera& camera, ImageSize size) {
  const auto& k = camera.k;
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1) {
    return make_error(ErrorCode::kMalformed,
                      "the camera matrix has not the form fx 0 cx, 0 fy cy, 0 0 1");
  }
  const auto model = model_for(camera);
  if (!model) return tl::unexpected(model.error());
  Calibration calibration;
  calibration.image_size = size;
  calibration.model = *model;
  calibration.parameters = {{"fx", k[0], {}}, {"fy", k[4], {}}, {"cx", k[2], {}}, {"cy", k[5], {}}};
  const auto names = coefficient_names(camera.fisheye, coefficient_count(*model).value_or(0));
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
  camera.fisheye = calibration.model == "fisheye";
  const auto count = coefficient_count(calibration.model);
  if (!count) return make_error(ErrorCode::kUnsupported, "OpenCV has no such camera model.");
  camera.k = {value("fx"), value("skew"), value("cx"), 0, value("fy"), value("cy"), 0, 0, 1};
  for (const std::string_view name :
       coefficient_names(camera.fisheye, std::max<std::size_t>(*count, 4))) {
    camera.distortion.push_back(value(name));
  }
  // As it will be read again.
  if (!camera.fisheye) camera.distortion.resize(smallest_model(camera.distortion).count);
  return camera;
}

}  // namespace calvin::io
