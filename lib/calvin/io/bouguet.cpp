// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The results of J.-Y. Bouguet's Camera Calibration Toolbox: Calib_Results.m of one camera, and the
// .mat, saved by Octave as text, of one or of a stereo pair. The toolbox counts pixels from the
// centre of the first one on and has the coefficients of OpenCV in OpenCV's order.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"

namespace calvin::io {

namespace {

constexpr double kMillimetre = 1e-3;  // in which the toolbox asks for the squares of its board

// What it calls uncertainty is about three standard deviations.
constexpr double kUncertainty = 3;

bool has(const Node& root, std::string_view name, std::string_view side) {
  return root.find(fmt::format("{}{}", name, side)) != nullptr;
}

// One camera of a file: `side` is empty, "_left" or "_right".
class CameraVariables {
 public:
  CameraVariables(const Node& root, Fields& fields, std::string side)
      : root_(root), fields_(fields), side_(std::move(side)) {}

  std::optional<Calibration> read() {
    const auto focal = fields_.numbers(name("fc"), 2);
    const auto center = fields_.numbers(name("cc"), 2);
    const auto skew = optional("alpha_c", 1);
    OpenCvCamera camera;
    camera.distortion = optional("kc", 0);
    const ImageSize size = {fields_.integer("nx"), fields_.integer("ny")};
    if (fields_.failed()) return std::nullopt;
    // x = fc_1 (x_d + alpha_c y_d) + cc_1
    camera.k = {
        focal[0], skew.empty() ? 0 : skew[0] * focal[0], center[0], 0, focal[1], center[1], 0, 0,
        1};
    auto calibration = camera_of(fields_, name("fc"), camera, size);
    if (calibration) add_sigmas(*calibration, focal[0]);
    return calibration;
  }

 private:
  [[nodiscard]] std::string name(std::string_view variable) const {
    return fmt::format("{}{}", variable, side_);
  }
  std::vector<double> optional(std::string_view variable, std::size_t count) {
    if (!has(root_, variable, side_)) return {};
    return fields_.numbers(name(variable), count);
  }

  // Zero is the uncertainty of what was not estimated.
  void add_sigmas(Calibration& calibration, double focal) {
    const auto add = [&](std::string_view parameter, double uncertainty) {
      const auto found = std::ranges::find(calibration.parameters, parameter, &Parameter::name);
      if (found == calibration.parameters.end() || !(uncertainty > 0)) return;
      found->sigma = uncertainty / kUncertainty;
    };
    const auto add_all = [&](std::string_view variable, const auto& parameters, double scale) {
      const auto values = errors(variable);
      for (std::size_t i = 0; i < std::min(values.size(), parameters.size()); ++i) {
        add(parameters[i], values[i] * scale);
      }
    };
    add_all("fc", std::array{"fx", "fy"}, 1);
    add_all("cc", std::array{"cx", "cy"}, 1);
    add_all("kc", std::array{"k1", "k2", "p1", "p2", "k3"}, 1);
    add_all("alpha_c", std::array{"skew"}, focal);
  }

  // Of a variable; none where they are not there, or no numbers (those of a solve that failed).
  [[nodiscard]] std::vector<double> errors(std::string_view variable) const {
    for (const std::string& key :
         {fmt::format("{}_error{}", variable, side_), fmt::format("{}{}_error", variable, side_)}) {
      std::optional<Error> problem;
      Fields fields(root_, "", problem);
      if (root_.find(key) == nullptr) continue;
      auto values = fields.numbers(key);
      if (!problem) return values;
    }
    return {};
  }

  const Node& root_;
  Fields& fields_;
  std::string side_;
};

// right_from_left by om, a Rodrigues vector, else by R.
std::optional<Eigen::Matrix3d> read_rotation(const Node& root, Fields& fields) {
  if (root.find("om") != nullptr) {
    const auto om = fields.numbers("om", 3);
    if (fields.failed()) return std::nullopt;
    return to_se3(Pose{{om[0], om[1], om[2]}, {}}).rotation;
  }
  const auto rows = fields.rows("R", 3);
  if (fields.failed() || rows.size() != 3) return std::nullopt;
  std::vector<double> numbers;
  for (const auto& row : rows) numbers.insert(numbers.end(), row.begin(), row.end());
  return rotation_near(matrix_of(numbers));
}

}  // namespace

bool is_bouguet(const Node& root) {
  return (has(root, "fc", "") && has(root, "cc", "")) || is_bouguet_stereo(root);
}

Result<Calibration> read_bouguet_camera(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  auto calibration = CameraVariables(root, fields, has(root, "fc", "") ? "" : "_left").read();
  if (problem) return tl::unexpected(*problem);
  // Of both coordinates of a corner; of a script it is not known.
  if (root.find("err_std") != nullptr) {
    const auto deviations = fields.numbers("err_std", 2);
    if (!problem) calibration->rms = std::hypot(deviations[0], deviations[1]);
  }
  return *std::move(calibration);
}

bool is_bouguet_stereo(const Node& root) {
  const bool has_cameras = has(root, "fc", "_left") && has(root, "fc", "_right");
  return has_cameras && has(root, "T", "") && (has(root, "om", "") || has(root, "R", ""));
}

Result<Rig> read_bouguet_stereo(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  Rig rig;
  rig.world = "left";
  for (const char* side : {"left", "right"}) {
    auto calibration = CameraVariables(root, fields, fmt::format("_{}", side)).read();
    if (!calibration) break;
    calibration->camera = side;
    rig.cameras.push_back({*std::move(calibration), {}, {}, {}});
  }
  const auto rotation = read_rotation(root, fields);
  const auto place = fields.numbers("T", 3);
  if (problem) return tl::unexpected(*problem);
  if (!rotation) return make_error(ErrorCode::kMalformed, "'R' is no rotation");
  const SE3 right_from_left = {*rotation,
                               kMillimetre * Eigen::Vector3d(place[0], place[1], place[2])};
  if (!is_near(right_from_left.translation)) {
    return make_error(ErrorCode::kMalformed, "'T' is out of range (1e6 m)");
  }
  rig.cameras[1].rig_from_camera = to_pose(right_from_left.inverse());
  return rig;
}

}  // namespace calvin::io
