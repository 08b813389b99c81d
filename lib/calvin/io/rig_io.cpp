// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rig <-> JSON, around the native form of each camera's calibration.

#include "calvin/io/rig_io.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/node_map.hpp"
#include "calvin/io/text_document.hpp"

namespace calvin {

namespace {

using io::Fields;
using io::Node;
using io::NodeMap;

constexpr std::string_view kFormat = "calvin-rig";
constexpr int kVersion = 1;
constexpr std::size_t kPose = 6;

// ---- Reading ------------------------------------------------------------------------------------

RigCamera read_rig_camera(Fields fields) {
  RigCamera camera;
  const std::string name = fields.string("camera");
  camera.calibration = io::read_camera(fields);
  if (fields.failed()) return camera;
  camera.calibration.camera = name;
  camera.rig_from_camera = io::read_pose(fields.map("rig_from_camera"));
  if (const Node* rows = fields.find("covariance"); rows != nullptr && !rows->items.empty()) {
    camera.covariance = io::read_covariance(fields, kPose, "numbers say where a camera is");
  }
  camera.rms = fields.optional_number("rms");
  io::check_place(fields, "rig_from_camera", camera.rig_from_camera, "covariance",
                  camera.covariance);
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

Result<Rig> parse_text(std::string_view content) {
  if (content.size() > kMaxRigBytes) {
    return make_error(
        ErrorCode::kMalformed,
        fmt::format("it is larger than the {} MiB that a rig may have", kMaxRigBytes >> 20));
  }
  const auto root = io::parse_text_document(content);
  if (!root) return tl::unexpected(root.error());
  if (root->kind != Node::Kind::kMap) {
    return make_error(ErrorCode::kMalformed, "it has none of the fields of a rig");
  }
  std::optional<Error> problem;
  Fields fields(*root, "", problem);
  io::read_head(fields, kFormat, kVersion, "a rig");
  Rig rig;
  if (!problem) read_cameras(fields, problem, rig);
  rig.world = fields.optional_string("world");
  rig.rms = fields.optional_number("rms");
  rig.pairing_tolerance = fields.optional_time("pairing_tolerance_ns").value_or(0);
  if (problem) return tl::unexpected(*problem);
  return rig;
}

std::string explain(std::string_view name, std::string_view why) {
  const std::string reason = shortened(why, 400);
  const std::string file =
      name.empty() ? std::string("The text of a rig") : fmt::format("'{}'", shortened(name, 400));
  return fmt::format("{} cannot be used as a rig: {}{} Give a file that calvin-rig has written.",
                     file, reason, reason.ends_with('.') ? "" : ".");
}

// ---- Writing ------------------------------------------------------------------------------------

Result<Node> camera_node(const RigCamera& camera) {
  auto calibration = io::camera_node(camera.calibration);
  if (!calibration) return calibration;
  NodeMap map;
  map.put("camera", io::text_node(camera.calibration.camera));
  map.put("rig_from_camera", io::pose_node(camera.rig_from_camera));
  map.put_rows("covariance", camera.covariance, kPose);
  map.put("rms", camera.rms);
  map.put("calibration", *std::move(calibration));
  return map.take();
}

}  // namespace

Result<Rig> parse_rig(std::string_view content, std::string_view name) {
  Result<Rig> result;
  try {
    result = parse_text(content);
  } catch (const std::exception& exception) {  // out of memory, or a parser's own surprise
    result = make_error(ErrorCode::kMalformed, exception.what());
  }
  if (!result) result.error().message = explain(name, result.error().message);
  return result;
}

Result<Rig> read_rig(const std::filesystem::path& path) {
  const auto content = read_file(path.string(), kMaxRigBytes);
  if (!content) return tl::unexpected(content.error());
  return parse_rig(*content, path.string());
}

Result<std::string> print_rig(const Rig& rig) {
  try {
    Node cameras = {Node::Kind::kList, {}, {}, {}};
    for (const RigCamera& camera : rig.cameras) {
      auto node = camera_node(camera);
      if (!node) return tl::unexpected(node.error());
      cameras.items.push_back(*std::move(node));
    }
    NodeMap map;
    map.put("format", io::text_node(kFormat));
    map.put("version", io::integer_node(kVersion));
    map.put("world", io::text_node(rig.world));
    map.put("rms", rig.rms);
    map.put("pairing_tolerance_ns", io::integer_node(rig.pairing_tolerance));
    map.put("cameras", std::move(cameras));
    return io::print_json(map.take());
  } catch (const std::exception& exception) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The rig cannot be written: {}.", exception.what()));
  }
}

Status write_rig(const std::filesystem::path& path, const Rig& rig) {
  const auto printed = print_rig(rig);
  if (!printed) return tl::unexpected(printed.error());
  return write_file(path.string(), *printed);
}

}  // namespace calvin
