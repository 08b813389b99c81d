// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A stereo pair in the names of OpenCV's sample stereo_calib, in one file or in two, and each
// camera of it for ROS.

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_lens.hpp"
#include "calvin/io/opencv_storage.hpp"
#include "calvin/io/rig_fields.hpp"
#include "calvin/io/rig_formats.hpp"
#include "calvin/io/stereo_io.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Matrix;
using io::Node;

constexpr std::array<std::string_view, 4> kLenses = {"M1", "D1", "M2", "D2"};
constexpr std::array<std::string_view, 2> kPlaces = {"R", "T"};

bool has_all(const Node& root, std::span<const std::string_view> keys) {
  const Node& map = io::content_of(root);
  return std::ranges::all_of(keys, [&](std::string_view key) { return map.find(key) != nullptr; });
}

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
                                            const char* coefficients, bool is_fisheye,
                                            ImageSize size) {
  io::OpenCvCamera camera;
  camera.k = io::read_3x3(fields, matrix);
  camera.distortion = io::read_matrix(fields, coefficients).data;
  camera.fisheye = is_fisheye;
  if (fields.failed()) return std::nullopt;
  // What is wrong of a lens of no known size is wrong at any.
  const bool is_sized = size != ImageSize{};
  auto calibration = io::camera_of(fields, matrix, camera, is_sized ? size : ImageSize{1, 1});
  if (!calibration) return std::nullopt;
  calibration->image_size = size;
  return RigCamera{*std::move(calibration), {}, {}, {}};
}

// What is told of the lenses, and of where they stand.
struct StereoStorage {
  io::Storage lenses;
  io::Storage places;
};

Result<StereoStorage> to_storage(const Rig& rig, const RectifiedPair& pair) {
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
  StereoStorage storage;
  storage.lenses = {{"image_width", left.calibration.image_size.width},
                    {"image_height", left.calibration.image_size.height}};
  if (first->fisheye) storage.lenses.emplace_back("fisheye_model", 1);
  storage.lenses.insert(storage.lenses.end(), {{"M1", square(first->k)},
                                               {"D1", coefficients(*first)},
                                               {"M2", square(second->k)},
                                               {"D2", coefficients(*second)}});
  storage.places = {{"R", square(row_major(right_from_left.rotation))},
                    {"T", Matrix{3, 1, {t.x(), t.y(), t.z()}}},
                    {"R1", square(pair.rectified_from_left)},
                    {"R2", square(pair.rectified_from_right)},
                    {"P1", Matrix{3, 4, {left_projection.begin(), left_projection.end()}}},
                    {"P2", Matrix{3, 4, {right_projection.begin(), right_projection.end()}}},
                    {"Q", disparity_to_depth(pair)}};
  return storage;
}

}  // namespace

namespace io {

bool is_opencv_stereo(const Node& root) { return has_all(root, kLenses) && has_all(root, kPlaces); }

bool is_half_of_opencv_stereo(const Node& root) {
  return has_all(root, kLenses) != has_all(root, kPlaces);
}

Result<Rig> read_half_of_opencv_stereo(const Node& root) {
  constexpr const char* kMissing[2][3] = {
      {"where the cameras stand, R and T", "the lenses of both, M1 D1 M2 D2", "intrinsics.yml"},
      {"the lenses of a stereo pair, M1 D1 M2 D2", "where they stand, R and T", "extrinsics.yml"}};
  const auto& missing = kMissing[has_all(root, kLenses) ? 1 : 0];
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("it has {}, and not {}, which OpenCV's sample writes to {}: lay that beside it, "
                  "or name both, as intrinsics.yml,extrinsics.yml",
                  missing[0], missing[1], missing[2]));
}

bool is_half_of_opencv_stereo(std::string_view content) noexcept {
  try {
    const auto root = parse_text_document(content);
    return root && is_half_of_opencv_stereo(*root);
  } catch (const std::exception&) {
    return false;
  }
}

Result<Rig> join_opencv_stereo(std::string_view one, std::string_view other) {
  try {
    const auto first_root = parse_text_document(one);
    if (!first_root) return tl::unexpected(first_root.error());
    const auto second_root = parse_text_document(other);
    if (!second_root) {
      return make_error(second_root.error().code,
                        "of the other one, " + second_root.error().message);
    }
    Node all = content_of(*first_root);
    const Node& second = content_of(*second_root);
    for (std::size_t i = 0; i < second.keys.size(); ++i) {
      if (all.find(second.keys[i]) != nullptr) continue;
      all.keys.push_back(second.keys[i]);
      all.items.push_back(second.items[i]);
    }
    return is_opencv_stereo(all) ? read_opencv_stereo(all) : read_half_of_opencv_stereo(all);
  } catch (const std::exception& exception) {
    return make_error(ErrorCode::kMalformed, exception.what());
  }
}

Result<Rig> read_opencv_stereo(const Node& root) {
  std::optional<Error> problem;
  Fields fields(content_of(root), "", problem);
  // The sample does not write it.
  ImageSize size;
  if (fields.find("image_width") != nullptr || fields.find("image_height") != nullptr) {
    size = {fields.integer("image_width"), fields.integer("image_height")};
  }
  const bool is_fisheye = read_fisheye(fields);
  auto left = read_stereo_camera(fields, "M1", "D1", is_fisheye, size);
  auto right = read_stereo_camera(fields, "M2", "D2", is_fisheye, size);
  const std::array<double, 9> r = read_3x3(fields, "R");
  const Matrix t = read_matrix(fields, "T");
  if (t.data.size() != 3) fields.complain("T", "has not three numbers");
  if (problem) return tl::unexpected(*problem);
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const SE3 right_from_left = {closest_rotation(Eigen::Map<const RowMajor>(r.data())),
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
  auto storage = to_storage(rig, pair);
  if (!storage) return tl::unexpected(storage.error());
  io::Storage all = std::move(storage->lenses);
  std::ranges::move(storage->places, std::back_inserter(all));
  return io::print_opencv_yaml(all);
}

Result<OpenCvStereoFiles> print_opencv_stereo_files(const Rig& rig, const RectifiedPair& pair) {
  const auto storage = to_storage(rig, pair);
  if (!storage) return tl::unexpected(storage.error());
  return OpenCvStereoFiles{io::print_opencv_yaml(storage->lenses),
                           io::print_opencv_yaml(storage->places)};
}

Result<std::string> print_ros_stereo(const Rig& rig, const RectifiedPair& pair, bool is_left) {
  const io::RosRectification rectification = {
      is_left ? pair.rectified_from_left : pair.rectified_from_right, projection_of(pair, is_left)};
  return io::print_ros(rig.cameras[is_left ? pair.left : pair.right].calibration, rectification);
}

}  // namespace calvin
