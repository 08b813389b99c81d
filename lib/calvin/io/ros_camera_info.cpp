// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// ROS camera_info as YAML: the names and the nesting of camera_calibration_parsers, exactly; and
// read under those of the message sensor_msgs/CameraInfo too, as `ros2 topic echo` prints it.

#include <algorithm>

#include <fmt/format.h>

#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_lens.hpp"
#include "calvin/io/opencv_storage.hpp"

namespace calvin::io {

namespace {

struct Row {
  std::string_view name;
  bool fisheye;
  std::size_t most;  // coefficients
};
// The first that holds the coefficients is written; `fisheye` is a name that some tools write.
constexpr std::array<Row, 4> kDistortionModels = {{{"plumb_bob", false, 5},
                                                   {"rational_polynomial", false, 8},
                                                   {"equidistant", true, 4},
                                                   {"fisheye", true, 4}}};

const Row* find_model(std::string_view name) {
  const auto it = std::find_if(kDistortionModels.begin(), kDistortionModels.end(),
                               [&](const Row& row) { return row.name == name; });
  return it == kDistortionModels.end() ? nullptr : &*it;
}

// The first that holds that many coefficients, or nullptr.
const Row* model_for(bool fisheye, std::size_t coefficients) {
  const auto it = std::find_if(
      kDistortionModels.begin(), kDistortionModels.end(),
      [&](const Row& row) { return row.fisheye == fisheye && row.most >= coefficients; });
  return it == kDistortionModels.end() ? nullptr : &*it;
}

// Of a field in the files of camera_calibration_parsers, in the message of ROS 2 and in that of
// ROS 1.
using FieldNames = std::array<std::string_view, 3>;
constexpr FieldNames kWidthNames = {"image_width", "width", "width"};
constexpr FieldNames kHeightNames = {"image_height", "height", "height"};
constexpr FieldNames kMatrix = {"camera_matrix", "k", "K"};
constexpr FieldNames kCoefficients = {"distortion_coefficients", "d", "D"};

// The one that is there, or the first.
std::string_view name_in(const Fields& fields, const FieldNames& names) {
  const auto found = std::find_if(names.begin(), names.end(), [&](std::string_view name) {
    return fields.find(name) != nullptr;
  });
  return found == names.end() ? names.front() : *found;
}

std::string print_matrix(std::string_view name, const Matrix& matrix) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, matrix.rows, matrix.cols,
                     join_reals(matrix.data, ", "));
}

}  // namespace

bool ros_holds(std::string_view model) {
  const LensTraits* lens = opencv_lens(model);
  return lens != nullptr &&
         model_for(lens->opencv == OpenCvForm::kFisheye, lens->coefficients.size()) != nullptr;
}

bool is_ros(const Node& root) { return root.find("distortion_model") != nullptr; }

Result<Calibration> read_ros(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  const std::string_view width = name_in(fields, kWidthNames);
  const std::string_view height = name_in(fields, kHeightNames);
  const std::string_view coefficients = name_in(fields, kCoefficients);
  const ImageSize size = {fields.integer(width), fields.integer(height)};
  const std::string name = fields.word("distortion_model");
  const Row* model = find_model(name);
  if (model == nullptr) {
    fields.complain("distortion_model",
                    fmt::format("is '{}'; plumb_bob, rational_polynomial and equidistant are read",
                                name.substr(0, 40)),
                    ErrorCode::kUnsupported);
  }
  const std::array<double, 9> k = read_3x3(fields, name_in(fields, kMatrix));
  const Matrix d = read_matrix(fields, coefficients);
  // The lens is that of distortion_model; what else names it may not contradict.
  const bool is_fisheye = read_fisheye(fields);
  if (problem) return tl::unexpected(*problem);
  if (size.width < 1 || size.height < 1) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("'{}' or '{}' is not positive", width, height));
  }
  if (d.data.size() > model->most) {
    return make_error(ErrorCode::kMalformed, fmt::format("'{}' are {}, but {} has {}", coefficients,
                                                         d.data.size(), name, model->most));
  }
  auto calibration = from_opencv({k, d.data, is_fisheye}, size);
  if (calibration) calibration->camera = fields.word("camera_name");
  return calibration;
}

Result<std::string> print_ros(const Calibration& calibration) {
  return print_ros(calibration, std::nullopt);
}

Result<std::string> print_ros(const Calibration& calibration,
                              const std::optional<RosRectification>& rectification) {
  const Status sized = check_has_size(calibration, "ROS file");
  if (!sized) return tl::unexpected(sized.error());
  auto camera = to_opencv(calibration);
  if (!camera) return tl::unexpected(camera.error());
  auto& d = camera->distortion;
  const Row* model = model_for(camera->fisheye, d.size());
  if (model == nullptr) {
    return make_error(ErrorCode::kUnsupported, "ROS has no such camera model.");
  }
  d.resize(model->most);
  const auto& k = camera->k;
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n",
                                 calibration.image_size.width, calibration.image_size.height,
                                 json_string(calibration.camera));
  text += print_matrix("camera_matrix", {3, 3, {k.begin(), k.end()}});
  text += fmt::format("distortion_model: {}\n", model->name);
  text += print_matrix("distortion_coefficients", {1, static_cast<int>(d.size()), d});
  const RosRectification as_it_is = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                     {k[0], k[1], k[2], 0, 0, k[4], k[5], 0, 0, 0, 1, 0}};
  const RosRectification& shown = rectification.value_or(as_it_is);
  text +=
      print_matrix("rectification_matrix", {3, 3, {shown.rotation.begin(), shown.rotation.end()}});
  text +=
      print_matrix("projection_matrix", {3, 4, {shown.projection.begin(), shown.projection.end()}});
  return text;
}

}  // namespace calvin::io
