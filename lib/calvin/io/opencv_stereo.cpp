// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A stereo pair in the names of OpenCV's sample stereo_calib, and each camera of it for ROS.

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_storage.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"
#include "calvin/io/stereo_io.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Matrix;
using io::Node;

constexpr std::array<std::string_view, 6> kNeeded = {"M1", "D1", "M2", "D2", "R", "T"};

Matrix square(const std::array<double, 9>& values) {
  return {3, 3, {values.begin(), values.end()}};
}

std::array<double, 9> row_major(const Eigen::Matrix3d& m) {
  std::array<double, 9> values{};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data()) = m;
  return values;
}

// P of OpenCV and ROS: what it makes of the right camera's frame is in px of the left one's.
std::array<double, 12> projection_of(const RectifiedPair& pair, bool is_left) {
  std::array<double, 12> p = {pair.fx, 0, pair.cx, 0, 0, pair.fy, pair.cy, 0, 0, 0, 1, 0};
  if (is_left) return p;
  (pair.is_vertical ? p[7] : p[3]) = -pair.baseline * (pair.is_vertical ? pair.fy : pair.fx);
  return p;
}

// Q: px and disparity to a point in the frame of the rectified left camera, times a common factor.
Matrix disparity_to_depth(const RectifiedPair& pair) {
  const double focal = pair.is_vertical ? pair.fy : pair.fx;
  const double x = focal / pair.fx;
  const double y = focal / pair.fy;
  return {
      4,
      4,
      {x, 0, 0, -x * pair.cx, 0, y, 0, -y * pair.cy, 0, 0, 0, focal, 0, 0, 1 / pair.baseline, 0}};
}

std::optional<RigCamera> read_stereo_camera(Fields& fields, const char* matrix,
                                            const char* coefficients, ImageSize size) {
  io::OpenCvCamera camera;
  const Matrix k = io::read_matrix(fields, matrix);
  if (k.rows != 3 || k.cols != 3) fields.complain(matrix, "is not a matrix of 3x3");
  camera.distortion = io::read_matrix(fields, coefficients).data;
  const Node* fisheye = fields.find("fisheye_model");
  camera.fisheye = fisheye != nullptr && fisheye->text != "0";
  if (fields.failed()) return std::nullopt;
  std::copy(k.data.begin(), k.data.end(), camera.k.begin());
  auto calibration = io::camera_of(fields, matrix, camera, size);
  if (!calibration) return std::nullopt;
  return RigCamera{*std::move(calibration), {}, {}, {}};
}

}  // namespace

namespace io {

bool is_opencv_stereo(const Node& root) {
  return std::ranges::all_of(kNeeded,
                             [&](std::string_view key) { return root.find(key) != nullptr; });
}

Result<Rig> read_opencv_stereo(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  const ImageSize size = {fields.integer("image_width"), fields.integer("image_height")};
  auto left = read_stereo_camera(fields, "M1", "D1", size);
  auto right = read_stereo_camera(fields, "M2", "D2", size);
  const Matrix r = read_matrix(fields, "R");
  const Matrix t = read_matrix(fields, "T");
  if (r.data.size() != 9) fields.complain("R", "is not a matrix of 3x3");
  if (t.data.size() != 3) fields.complain("T", "has not three numbers");
  if (problem) return tl::unexpected(*problem);
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const SE3 right_from_left = {closest_rotation(Eigen::Map<const RowMajor>(r.data.data())),
                               Eigen::Map<const Eigen::Vector3d>(t.data.data())};
  if (!(right_from_left.translation.cwiseAbs().maxCoeff() < 1e6)) {
    return make_error(ErrorCode::kMalformed, "'T' is out of range (1e6 m)");
  }
  left->calibration.camera = "left";
  right->calibration.camera = "right";
  right->rig_from_camera = to_pose(right_from_left.inverse());
  Rig rig;
  rig.world = "left";
  rig.cameras = {*std::move(left), *std::move(right)};
  return rig;
}

}  // namespace io

Result<std::string> print_opencv_stereo(const Rig& rig, const RectifiedPair& pair) {
  const RigCamera& left = rig.cameras[pair.left];
  const RigCamera& right = rig.cameras[pair.right];
  const auto first = io::to_opencv(left.calibration);
  if (!first) return tl::unexpected(first.error());
  const auto second = io::to_opencv(right.calibration);
  if (!second) return tl::unexpected(second.error());
  if (first->fisheye != second->fisheye) {
    return make_error(ErrorCode::kUnsupported,
                      "OpenCV has no stereo pair of a fisheye lens and another one: calibrate both "
                      "with the same model.");
  }
  const auto coefficients = [](const io::OpenCvCamera& camera) {
    return Matrix{1, static_cast<int>(camera.distortion.size()), camera.distortion};
  };
  const SE3 right_from_left =
      to_se3(right.rig_from_camera).inverse() * to_se3(left.rig_from_camera);
  const Eigen::Vector3d& t = right_from_left.translation;
  const auto left_projection = projection_of(pair, true);
  const auto right_projection = projection_of(pair, false);
  io::Storage storage = {{"image_width", left.calibration.image_size.width},
                         {"image_height", left.calibration.image_size.height}};
  if (first->fisheye) storage.emplace_back("fisheye_model", 1);
  storage.insert(storage.end(),
                 {{"M1", square(first->k)},
                  {"D1", coefficients(*first)},
                  {"M2", square(second->k)},
                  {"D2", coefficients(*second)},
                  {"R", square(row_major(right_from_left.rotation))},
                  {"T", Matrix{3, 1, {t.x(), t.y(), t.z()}}},
                  {"R1", square(pair.rectified_from_left)},
                  {"R2", square(pair.rectified_from_right)},
                  {"P1", Matrix{3, 4, {left_projection.begin(), left_projection.end()}}},
                  {"P2", Matrix{3, 4, {right_projection.begin(), right_projection.end()}}},
                  {"Q", disparity_to_depth(pair)}});
  return io::print_opencv_yaml(storage);
}

Result<std::string> print_ros_stereo(const Rig& rig, const RectifiedPair& pair, bool is_left) {
  const io::RosRectification rectification = {
      is_left ? pair.rectified_from_left : pair.rectified_from_right, projection_of(pair, is_left)};
  return io::print_ros(rig.cameras[is_left ? pair.left : pair.right].calibration, rectification);
}

}  // namespace calvin
