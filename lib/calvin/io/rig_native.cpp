// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rig <-> JSON, around the native form of each camera's calibration.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/rig_formats.hpp"

namespace calvin::io {

namespace {

constexpr std::string_view kFormat = "calvin-rig";
constexpr int kVersion = 1;
constexpr std::size_t kPose = 6;

// ---- Reading ------------------------------------------------------------------------------------

// What no rig has: so that whatever is computed of it stays finite.
void check_range(Fields& fields, const RigCamera& camera) {
  constexpr double kFarthest = 1e6;  // m; of a turn, rad
  const auto is_far = [](double x) { return !(std::abs(x) <= kFarthest); };
  if (std::ranges::any_of(camera.rig_from_camera.translation, is_far) ||
      std::ranges::any_of(camera.rig_from_camera.rotation, is_far)) {
    fields.complain("rig_from_camera", "is out of range (1e6 m, 1e6 rad)");
  }
  if (std::ranges::any_of(camera.covariance, [](double x) { return !(std::abs(x) <= 1e12); })) {
    fields.complain("covariance", "is out of range (1e12)");
  }
}

Result<Calibration> read_camera_calibration(const Node& node) {
  auto calibration = read_native(node);
  if (!calibration) return calibration;
  if (const auto camera = Camera::make(*calibration); !camera) {
    return tl::unexpected(camera.error());
  }
  return calibration;
}

RigCamera read_rig_camera(Fields fields) {
  RigCamera camera;
  const std::string name = fields.string("camera");
  const Node* node = fields.find("calibration");
  if (node == nullptr || node->kind != Node::Kind::kMap) {
    fields.complain("calibration", "is missing");
    return camera;
  }
  auto calibration = read_camera_calibration(*node);
  if (!calibration) {
    fields.complain("calibration", fmt::format("is wrong: {}", calibration.error().message),
                    calibration.error().code);
    return camera;
  }
  camera.calibration = *std::move(calibration);
  camera.calibration.camera = name;
  camera.rig_from_camera = read_pose(fields.map("rig_from_camera"));
  if (const Node* rows = fields.find("covariance"); rows != nullptr && !rows->items.empty()) {
    camera.covariance = read_covariance(fields, kPose, "numbers say where a camera is");
  }
  camera.rms = fields.optional_number("rms");
  check_range(fields, camera);
  return camera;
}

void read_cameras(Fields& fields, std::optional<Error>& problem, Rig& rig) {
  constexpr std::size_t kMost = 4096;
  const auto& list = fields.list("cameras");
  if (list.empty()) fields.complain("cameras", "has none");
  if (list.size() > kMost) {
    fields.complain("cameras", fmt::format("has {}; no rig has more than {}", list.size(), kMost));
  }
  for (std::size_t i = 0; i < list.size() && !fields.failed(); ++i) {
    if (list[i].kind != Node::Kind::kMap) {
      fields.complain("cameras", "is not a list of groups");
      return;
    }
    RigCamera camera = read_rig_camera(Fields(list[i], fmt::format("cameras[{}].", i), problem));
    const auto same = [&](const RigCamera& other) {
      return other.calibration.camera == camera.calibration.camera;
    };
    if (std::ranges::any_of(rig.cameras, same)) {
      fields.complain("cameras",
                      fmt::format("has '{}' twice", shortened(camera.calibration.camera, 64)));
    }
    rig.cameras.push_back(std::move(camera));
  }
}

// ---- Writing ------------------------------------------------------------------------------------

Node number(double x) { return {Node::Kind::kPlain, format_double(x), {}, {}}; }
Node text(std::string x) { return {Node::Kind::kString, std::move(x), {}, {}}; }

template <typename Numbers>
Node numbers(const Numbers& values) {
  Node list = {Node::Kind::kList, {}, {}, {}};
  for (const double x : values) list.items.push_back(number(x));
  return list;
}

class Map {
 public:
  Map& put(const char* key, Node value) {
    node_.keys.emplace_back(key);
    node_.items.push_back(std::move(value));
    return *this;
  }
  Map& put(const char* key, const std::optional<double>& value) {
    return value && std::isfinite(*value) ? put(key, number(*value)) : *this;
  }
  [[nodiscard]] Node take() { return std::move(node_); }

 private:
  Node node_{Node::Kind::kMap, {}, {}, {}};
};

Result<Node> camera_node(const RigCamera& camera) {
  const auto printed = print_native(camera.calibration);
  if (!printed) return tl::unexpected(printed.error());
  auto calibration = parse_json(*printed);
  if (!calibration) return calibration;
  Map map;
  map.put("camera", text(camera.calibration.camera));
  map.put("rig_from_camera", Map()
                                 .put("rotation", numbers(camera.rig_from_camera.rotation))
                                 .put("translation", numbers(camera.rig_from_camera.translation))
                                 .take());
  if (camera.covariance.size() == kPose * kPose) {
    Node rows = {Node::Kind::kList, {}, {}, {}};
    for (std::size_t r = 0; r < kPose; ++r) {
      const auto from = camera.covariance.begin() + static_cast<std::ptrdiff_t>(r * kPose);
      rows.items.push_back(numbers(std::vector<double>(from, from + kPose)));
    }
    map.put("covariance", std::move(rows));
  }
  map.put("rms", camera.rms);
  map.put("calibration", *std::move(calibration));
  return map.take();
}

}  // namespace

bool is_native_rig(const Node& root) {
  const Node* format = root.find("format");
  return format != nullptr && format->text == kFormat;
}

Result<Rig> read_native_rig(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  read_head(fields, kFormat, kVersion, "a rig");
  Rig rig;
  if (!problem) read_cameras(fields, problem, rig);
  rig.world = fields.optional_string("world");
  rig.rms = fields.optional_number("rms");
  rig.pairing_tolerance = fields.optional_time("pairing_tolerance_ns").value_or(0);
  if (problem) return tl::unexpected(*problem);
  return rig;
}

Result<std::string> print_native_rig(const Rig& rig) {
  Node cameras = {Node::Kind::kList, {}, {}, {}};
  for (const RigCamera& camera : rig.cameras) {
    auto node = camera_node(camera);
    if (!node) return tl::unexpected(node.error());
    cameras.items.push_back(*std::move(node));
  }
  Map map;
  map.put("format", text(std::string(kFormat)));
  map.put("version", {Node::Kind::kPlain, fmt::format("{}", kVersion), {}, {}});
  map.put("world", text(rig.world));
  map.put("rms", rig.rms);
  map.put("pairing_tolerance_ns",
          {Node::Kind::kPlain, fmt::format("{}", rig.pairing_tolerance), {}, {}});
  map.put("cameras", std::move(cameras));
  return print_json(map.take());
}

}  // namespace calvin::io
