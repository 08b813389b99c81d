// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The .cameramodel of mrcal: one camera, and where it stands in a frame that the files of a rig
// share.

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"

namespace calvin::io {

namespace {

constexpr std::string_view kPrefix = "LENSMODEL_";

// Lenses by what follows the prefix. The numbers behind fx fy cx cy are those of OpenCV.
struct LensModel {
  std::string_view name;
  std::size_t coefficients;
};
constexpr std::array<LensModel, 5> kLensModels = {
    {{"PINHOLE", 0}, {"OPENCV4", 4}, {"OPENCV5", 5}, {"OPENCV8", 8}, {"OPENCV12", 12}}};

// ---- Reading ------------------------------------------------------------------------------------

// Files of older versions have `lens_model`, those before them `distortion_model`.
std::string_view lens_key(const Node& root) {
  for (const std::string_view key : {"lensmodel", "lens_model"}) {
    if (root.find(key) != nullptr) return key;
  }
  return "distortion_model";
}

const LensModel* read_lens(Fields& fields, std::string_view key) {
  const std::string text = fields.string(key);
  std::string_view name = text;
  for (const std::string_view prefix : {kPrefix, std::string_view("DISTORTION_")}) {
    if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  }
  if (name == "NONE") name = "PINHOLE";
  const auto lens = std::ranges::find(kLensModels, name, &LensModel::name);
  if (lens != kLensModels.end()) return &*lens;
  fields.complain(key,
                  fmt::format("is {}, which no camera model here is like: convert it with "
                              "mrcal-convert-lensmodel to LENSMODEL_OPENCV8",
                              shortened(text, 80)),
                  ErrorCode::kUnsupported);
  return nullptr;
}

// A closed line, whose last corner is the first one. What is no such region is left out, as mrcal
// does.
std::vector<Pixel> read_region(Fields& fields) {
  std::vector<Pixel> region;
  for (const auto& corner : fields.rows("valid_intrinsics_region", 2)) {
    region.push_back({corner[0], corner[1]});
  }
  const bool is_closed = region.size() > 1 && region.front().u == region.back().u &&
                         region.front().v == region.back().v;
  if (is_closed) region.pop_back();
  if (region.size() < 3) region.clear();
  return region;
}

std::optional<Calibration> read_camera(Fields& fields, std::string_view key) {
  const LensModel* lens = read_lens(fields, key);
  if (lens == nullptr) return std::nullopt;
  const auto numbers = fields.numbers("intrinsics", 4 + lens->coefficients);
  const auto size = fields.numbers("imagersize", 2);
  auto region = read_region(fields);
  if (fields.failed()) return std::nullopt;
  OpenCvCamera camera;
  camera.k = {numbers[0], 0, numbers[2], 0, numbers[1], numbers[3], 0, 0, 1};
  camera.distortion.assign(numbers.begin() + 4, numbers.end());
  const auto to_int = [](double length) { return static_cast<int>(std::clamp(length, 0.0, 1e6)); };
  const ImageSize image_size = {to_int(size[0]), to_int(size[1])};
  auto calibration = camera_of(fields, "intrinsics", camera, image_size);
  if (!calibration) return calibration;
  if (lens->coefficients == 0) {
    calibration->model = "pinhole";
    calibration->parameters.resize(4);
  }
  calibration->covered = std::move(region);
  return calibration;
}

// ---- Writing ------------------------------------------------------------------------------------

std::string rows_of(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text.append(" ").append(format_double(value)).append(",");
  return text;
}

std::string region_text(const std::vector<Pixel>& covered) {
  if (covered.size() < 3) return "";
  std::string text = "    'valid_intrinsics_region': [\n";
  for (std::size_t i = 0; i <= covered.size(); ++i) {
    const Pixel& corner = covered[i % covered.size()];
    text += fmt::format("    [ {}, {} ],\n", format_double(corner.u), format_double(corner.v));
  }
  return text + "    ],\n\n";
}

}  // namespace

bool mrcal_holds(std::string_view model) {
  constexpr std::array<std::string_view, 5> kHeld = {"pinhole", "brown4", "brown5", "rational8",
                                                     "thinprism12"};
  return std::ranges::find(kHeld, model) != kHeld.end();
}

bool is_mrcal(const Node& root) {
  return root.find("imagersize") != nullptr && root.find("intrinsics") != nullptr;
}

Result<RigCamera> read_mrcal(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  RigCamera camera;
  if (auto calibration = read_camera(fields, lens_key(root))) {
    camera.calibration = *std::move(calibration);
  }
  const auto pose = fields.numbers("extrinsics", 6);
  if (problem) return tl::unexpected(*problem);
  const Eigen::Vector3d place(pose[3], pose[4], pose[5]);
  if (!is_near(place) || !is_near({pose[0], pose[1], pose[2]})) {
    return make_error(ErrorCode::kMalformed, "'extrinsics' is out of range (1e6 m, 1e6 rad)");
  }
  const SE3 camera_from_reference = {exp_so3({pose[0], pose[1], pose[2]}), place};
  camera.rig_from_camera = to_pose(camera_from_reference.inverse());
  return camera;
}

Result<Calibration> read_mrcal_camera(const Node& root) {
  auto camera = read_mrcal(root);
  if (!camera) return tl::unexpected(camera.error());
  return std::move(camera->calibration);
}

Result<std::string> print_mrcal(const RigCamera& camera) {
  const Calibration& calibration = camera.calibration;
  const Status sized = check_has_size(calibration, "file of mrcal");
  if (!sized) return tl::unexpected(sized.error());
  auto numbers = to_opencv(calibration);
  const bool is_held = numbers && !numbers->fisheye && numbers->distortion.size() <= 12;
  if (!is_held || numbers->k[1] != 0) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("mrcal has no lens like that of '{}', a {}{}: calibrate with rational8 or "
                    "thinprism12.",
                    shortened(calibration.camera, 64), calibration.model,
                    is_held ? " with skew" : ""));
  }
  if (calibration.model == "pinhole") numbers->distortion.clear();
  const auto lens =
      std::ranges::find(kLensModels, numbers->distortion.size(), &LensModel::coefficients);
  std::vector<double> intrinsics = {numbers->k[0], numbers->k[4], numbers->k[2], numbers->k[5]};
  intrinsics.insert(intrinsics.end(), numbers->distortion.begin(), numbers->distortion.end());
  const SE3 camera_from_reference = to_se3(camera.rig_from_camera).inverse();
  const Eigen::Vector3d turn = log_so3(camera_from_reference.rotation);
  const Eigen::Vector3d& place = camera_from_reference.translation;
  // As mrcal prints, and with as many digits as there are.
  return fmt::format(
      "{{\n    'lensmodel':  '{}{}',\n\n"
      "    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n"
      "    'intrinsics': [{}],\n\n{}"
      "    # extrinsics are rt_fromref\n    'extrinsics': [{}],\n\n"
      "    'imagersize': [ {}, {},],\n}}\n",
      kPrefix, lens->name, rows_of(intrinsics), region_text(calibration.covered),
      rows_of({turn.x() + 0.0, turn.y() + 0.0, turn.z() + 0.0, place.x() + 0.0, place.y() + 0.0,
               place.z() + 0.0}),
      calibration.image_size.width, calibration.image_size.height);
}

Result<std::string> print_mrcal_camera(const Calibration& calibration) {
  return print_mrcal({calibration, {}, {}, {}});
}

}  // namespace calvin::io
