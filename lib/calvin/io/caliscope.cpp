// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The cameras of caliscope (camera_array.toml, and config.toml of older versions) and of aniposelib
// (calibration.toml), TOML. All have OpenCV's numbers, and for each camera the motion that takes
// the world to it, m.

#include <algorithm>
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

constexpr std::string_view kCameraPrefix = "cam_";

// ---- Reading ------------------------------------------------------------------------------------

bool is_camera(const Node& node) {
  return node.kind == Node::Kind::kMap && node.find("matrix") != nullptr &&
         node.find("distortions") != nullptr;
}

// Some versions write absent values as this text.
bool is_absent(const Node* node) { return node == nullptr || node->text == "null"; }

struct Entry {
  std::string key;  // of the group, as complaints have it
  std::string name;
  const Node* node;
  std::optional<int> number;
};

std::string name_of(const Node& node, std::string_view key) {
  const Node* name = node.find("name");
  if (name != nullptr && !name->text.empty()) return name->text;
  return parse_int(key) ? fmt::format("{}{}", kCameraPrefix, key) : std::string(key);
}

// By their numbers, where all have one: as texts, 10 is before 2. Those that the user has taken out
// are left out.
std::vector<Entry> entries_of(const Node& root) {
  std::vector<Entry> entries;
  const auto take = [&](const Node& group, std::string_view path) {
    for (std::size_t i = 0; i < group.keys.size(); ++i) {
      const Node& node = group.items[i];
      const Node* ignored = is_camera(node) ? node.find("ignore") : nullptr;
      if (!is_camera(node) || (ignored != nullptr && ignored->text == "true")) continue;
      const std::string& key = group.keys[i];
      std::string_view number = key;
      if (number.starts_with(kCameraPrefix)) number.remove_prefix(kCameraPrefix.size());
      entries.push_back(
          {fmt::format("{}{}", path, key), name_of(node, key), &node, parse_int(number)});
    }
  };
  const Node* cameras = root.find("cameras");
  if (cameras != nullptr) take(*cameras, "cameras.");
  if (entries.empty()) take(root, "");
  if (std::ranges::all_of(entries, [](const Entry& e) { return e.number.has_value(); })) {
    std::ranges::stable_sort(entries, {}, [](const Entry& e) { return *e.number; });
  }
  return entries;
}

Eigen::Matrix3d read_rows(Fields& fields, std::string_view key) {
  std::vector<double> numbers;
  const auto rows = fields.rows(key, 3);
  if (rows.size() != 3) fields.complain(key, "is not a matrix of 3x3");
  for (const auto& row : rows) numbers.insert(numbers.end(), row.begin(), row.end());
  numbers.resize(9);
  return matrix_of(numbers);
}

std::optional<Calibration> read_calibration(Fields& fields) {
  const Eigen::Matrix3d k = read_rows(fields, "matrix");
  OpenCvCamera camera;
  camera.distortion = fields.numbers("distortions");
  camera.fisheye = !is_absent(fields.find("fisheye")) && fields.flag("fisheye");
  const auto size = fields.numbers("size", 2);
  if (fields.failed()) return std::nullopt;
  for (int i = 0; i < 9; ++i) camera.k[static_cast<std::size_t>(i)] = k(i / 3, i % 3);
  const auto to_int = [](double length) { return static_cast<int>(std::clamp(length, 0.0, 1e6)); };
  return camera_of(fields, "matrix", camera, {to_int(size[0]), to_int(size[1])});
}

// A vector of Rodrigues, or the matrix of older versions.
std::optional<Eigen::Matrix3d> read_rotation(Fields& fields) {
  const Node* node = fields.find("rotation");
  const bool is_matrix = node->kind == Node::Kind::kList && !node->items.empty() &&
                         node->items.front().kind == Node::Kind::kList;
  if (is_matrix) {
    const Eigen::Matrix3d matrix = read_rows(fields, "rotation");
    if (fields.failed()) return std::nullopt;
    const auto rotation = rotation_near(matrix);
    if (!rotation) fields.complain("rotation", "is a matrix, but of no rotation");
    return rotation;
  }
  const auto vector = fields.numbers("rotation", 3);
  if (fields.failed()) return std::nullopt;
  const Eigen::Vector3d turn(vector[0], vector[1], vector[2]);
  if (is_near(turn)) return exp_so3(turn);
  fields.complain("rotation", "is out of range (1e6 rad)");
  return std::nullopt;
}

std::optional<SE3> read_pose(Fields& fields) {
  for (const char* key : {"rotation", "translation"}) {
    if (!is_absent(fields.find(key))) continue;
    fields.complain(key,
                    "is missing: the camera was not placed yet. Do that, or take it out by "
                    "ignore = true");
    return std::nullopt;
  }
  const auto rotation = read_rotation(fields);
  const auto place = fields.numbers("translation", 3);
  if (fields.failed() || !rotation) return std::nullopt;
  const Eigen::Vector3d translation(place[0], place[1], place[2]);
  if (is_near(translation)) return SE3{*rotation, translation};
  fields.complain("translation", "is out of range (1e6 m)");
  return std::nullopt;
}

Error no_camera() {
  return {ErrorCode::kMalformed, "it has no camera: a group with size, matrix and distortions"};
}

// ---- Writing ------------------------------------------------------------------------------------

// caliscope knows cameras by numbers: those in the names cam_0, cam_7 ... where all have one, else
// their order.
std::vector<int> numbers_of(const Rig& rig) {
  std::vector<int> numbers;
  for (const RigCamera& camera : rig.cameras) {
    std::string_view name = camera.calibration.camera;
    if (!name.starts_with(kCameraPrefix)) break;
    const auto number = parse_int(name.substr(kCameraPrefix.size()));
    if (!number || *number < 0 || std::ranges::count(numbers, *number) > 0) break;
    numbers.push_back(*number);
  }
  if (numbers.size() == rig.cameras.size()) return numbers;
  numbers.clear();
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) numbers.push_back(static_cast<int>(i));
  return numbers;
}

// TOML reads 1 as a whole number and caliscope's lists are of one kind: with a point or an exponent
// all are what they are.
std::string numbers_text(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) {
    std::string text = format_double(value + 0.0);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    texts.push_back(std::move(text));
  }
  return fmt::format("[{}]", join(texts, ", "));
}

Result<std::string> camera_text(const RigCamera& camera, int number) {
  const Calibration& calibration = camera.calibration;
  const auto numbers = to_opencv(calibration);
  if (!numbers) {
    return make_error(
        ErrorCode::kUnsupported,
        fmt::format("caliscope has no lens like that of '{}', a {}: calibrate with brown5 or "
                    "fisheye.",
                    shortened(calibration.camera, 64), calibration.model));
  }
  const auto& k = numbers->k;
  const SE3 camera_from_rig = to_se3(camera.rig_from_camera).inverse();
  const Eigen::Vector3d turn = log_so3(camera_from_rig.rotation);
  const Eigen::Vector3d& place = camera_from_rig.translation;
  return fmt::format(
      "[cameras.{}]\ncam_id = {}\nname = {}\nsize = [{}, {}]\nrotation_count = 0\n"
      "matrix = [{}, {}, {}]\ndistortions = {}\ntranslation = {}\nrotation = {}\nfisheye = {}\n"
      "ignore = false\n\n",
      number, number, json_string(calibration.camera), calibration.image_size.width,
      calibration.image_size.height, numbers_text({k[0], k[1], k[2]}),
      numbers_text({k[3], k[4], k[5]}), numbers_text({k[6], k[7], k[8]}),
      numbers_text(numbers->distortion), numbers_text({place.x(), place.y(), place.z()}),
      numbers_text({turn.x(), turn.y(), turn.z()}), numbers->fisheye);
}

}  // namespace

bool is_caliscope(const Node& root) {
  const Node* cameras = root.find("cameras");
  if (cameras != nullptr && std::ranges::any_of(cameras->items, is_camera)) return true;
  return std::ranges::any_of(root.items, is_camera);
}

bool is_caliscope_rig(const Node& root) { return entries_of(root).size() > 1; }

Result<Rig> read_caliscope(const Node& root) {
  std::optional<Error> problem;
  Rig rig;
  const auto entries = entries_of(root);
  if (entries.empty()) return tl::unexpected(no_camera());
  if (entries.size() > kMostRigCameras) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("it has {} cameras; no rig has more than {}", entries.size(), kMostRigCameras));
  }
  for (const Entry& entry : entries) {
    Fields fields(*entry.node, entry.key + ".", problem);
    auto calibration = read_calibration(fields);
    const auto camera_from_world = problem ? std::nullopt : read_pose(fields);
    if (problem) return tl::unexpected(*problem);
    calibration->camera = entry.name;
    rig.cameras.push_back({*std::move(calibration), to_pose(camera_from_world->inverse()), {}, {}});
  }
  if (const std::string* name = repeated_name(rig.cameras)) {
    return make_error(ErrorCode::kMalformed,
                      fmt::format("it has the camera '{}' twice", shortened(*name, 64)));
  }
  rig.world = world_of(rig.cameras);
  return rig;
}

Result<std::string> print_caliscope(const Rig& rig) {
  const std::vector<int> numbers = numbers_of(rig);
  std::string text;
  for (std::size_t n = 0; n < rig.cameras.size(); ++n) {
    auto camera = camera_text(rig.cameras[n], numbers[n]);
    if (!camera) return camera;
    text += *camera;
  }
  return text;
}

Result<Calibration> read_caliscope_camera(const Node& root) {
  const auto entries = entries_of(root);
  if (entries.size() > 1) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("it holds {} cameras. Give one of them alone, or the file where "
                                  "a rig is taken.",
                                  entries.size()));
  }
  if (entries.empty()) return tl::unexpected(no_camera());
  std::optional<Error> problem;
  Fields fields(*entries.front().node, entries.front().key + ".", problem);
  auto calibration = read_calibration(fields);
  if (problem) return tl::unexpected(*problem);
  calibration->camera = entries.front().name;
  return *std::move(calibration);
}

}  // namespace calvin::io
