// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rig <-> JSON, around the native form of each camera's calibration.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/utf8.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/node_map.hpp"
#include "calvin/io/rig_formats.hpp"

namespace calvin::io {

namespace {

constexpr std::string_view kRigFormat = "calvin-rig";
constexpr int kRigVersion = 1;
constexpr std::string_view kNoUnit = "none";
constexpr std::size_t kPose = 6;
constexpr std::size_t kMostBoards = 4096;

// ---- Reading ------------------------------------------------------------------------------------

std::optional<TimeOffset> read_time_offset(Fields& fields) {
  if (fields.find("time_offset") == nullptr) return std::nullopt;
  Fields own = fields.map("time_offset");
  const TimeOffset offset = {own.number("seconds"), own.number("sigma")};
  if (!(std::abs(offset.seconds) <= kMostTimeOffset))
    own.complain("seconds", "is more than an hour");
  if (!(offset.sigma >= 0 && offset.sigma <= kMostTimeOffset))
    own.complain("sigma", "is no sigma in seconds");
  return offset;
}

RigCamera read_rig_camera(Fields fields) {
  RigCamera camera;
  const std::string name = fields.string("camera");
  camera.calibration = read_camera(fields);
  if (fields.failed()) return camera;
  camera.calibration.camera = name;
  camera.rig_from_camera = read_pose(fields.map("rig_from_camera"));
  if (const Node* rows = fields.find("covariance"); rows != nullptr && !rows->items.empty()) {
    camera.covariance = read_covariance(fields, kPose, "numbers say where a camera is");
  }
  camera.rms = fields.optional_number("rms");
  camera.time_offset = read_time_offset(fields);
  check_place(fields, "rig_from_camera", camera.rig_from_camera, "covariance", camera.covariance);
  return camera;
}

// Absent: metres.
void read_unit(Fields& fields, Rig& rig) {
  const Node* unit = fields.find("unit");
  if (unit == nullptr) return;
  rig.is_metric = false;
  if (unit->kind == Node::Kind::kString && unit->text == kNoUnit) return;
  fields.complain("unit", "is \"none\" where lengths have none, and absent where they are metres");
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

// Calls `read` for every group of a list of boards.
template <typename Read>
void read_boards(Fields& fields, const std::string& name, std::optional<Error>& problem,
                 const Read& read) {
  const auto& list = fields.list(name);
  if (list.size() > kMostBoards) {
    fields.complain(name,
                    fmt::format("has {}; no rig keeps more than {}", list.size(), kMostBoards));
  }
  for (std::size_t i = 0; i < list.size() && !fields.failed(); ++i) {
    if (list[i].kind != Node::Kind::kMap) {
      fields.complain(name, "is not a list of groups");
      return;
    }
    read(Fields(list[i], fmt::format("{}[{}].", name, i), problem));
  }
}

void read_shown_boards(Fields& fields, std::optional<Error>& problem, Rig& rig) {
  read_boards(fields, "boards", problem, [&](Fields one) {
    RigBoard board = {one.string("board"), read_pose(one.map("rig_from_board"))};
    check_place(one, "rig_from_board", board.rig_from_board, "", {});
    rig.boards.push_back(std::move(board));
  });
}

void read_fixed_boards(Fields& fields, std::optional<Error>& problem, Rig& rig) {
  read_boards(fields, "fixed_boards", problem, [&](Fields one) {
    FixedBoard board = {one.string("board"), one.string("on"), read_pose(one.map("on_from_board")),
                        read_covariance(one, kPose, "numbers say where a board is")};
    check_place(one, "on_from_board", board.on_from_board, "covariance", board.covariance);
    rig.fixed_boards.push_back(std::move(board));
  });
}

// ---- Writing ------------------------------------------------------------------------------------

Result<Node> rig_camera_node(const RigCamera& camera) {
  auto calibration = camera_node(camera.calibration);
  if (!calibration) return calibration;
  NodeMap map;
  map.put("camera", text_node(camera.calibration.camera));
  map.put("rig_from_camera", pose_node(camera.rig_from_camera));
  map.put_rows("covariance", camera.covariance, kPose);
  map.put("rms", camera.rms);
  if (camera.time_offset) {
    NodeMap offset;
    offset.put("seconds", camera.time_offset->seconds);
    offset.put("sigma", camera.time_offset->sigma);
    map.put("time_offset", offset.take());
  }
  map.put("calibration", *std::move(calibration));
  return map.take();
}

void put_boards(const Rig& rig, NodeMap& map) {
  Node shown = {Node::Kind::kList, {}, {}, {}};
  for (const RigBoard& board : rig.boards) {
    shown.items.push_back(NodeMap()
                              .put("board", text_node(board.board))
                              .put("rig_from_board", pose_node(board.rig_from_board))
                              .take());
  }
  Node fixed = {Node::Kind::kList, {}, {}, {}};
  for (const FixedBoard& board : rig.fixed_boards) {
    NodeMap one;
    one.put("board", text_node(board.board));
    one.put("on", text_node(board.on));
    one.put("on_from_board", pose_node(board.on_from_board));
    one.put_rows("covariance", board.covariance, kPose);
    fixed.items.push_back(one.take());
  }
  if (!rig.boards.empty()) map.put("boards", std::move(shown));
  if (!rig.fixed_boards.empty()) map.put("fixed_boards", std::move(fixed));
}

}  // namespace

bool is_native_rig(const Node& root) {
  const Node* format = root.find("format");
  return format != nullptr && format->text == kRigFormat;
}

Result<Rig> read_native_rig(const Node& root) {
  std::optional<Error> problem;
  Fields fields(root, "", problem);
  read_head(fields, kRigFormat, kRigVersion, "a rig");
  Rig rig;
  if (!problem) read_cameras(fields, problem, rig);
  if (!problem) read_shown_boards(fields, problem, rig);
  if (!problem) read_fixed_boards(fields, problem, rig);
  rig.world = fields.optional_string("world");
  read_unit(fields, rig);
  rig.rms = fields.optional_number("rms");
  rig.pairing_tolerance = fields.optional_time("pairing_tolerance_ns").value_or(0);
  if (problem) return tl::unexpected(*problem);
  return rig;
}

Result<std::string> print_native_rig(const Rig& rig) {
  Node cameras = {Node::Kind::kList, {}, {}, {}};
  for (const RigCamera& camera : rig.cameras) {
    auto node = rig_camera_node(camera);
    if (!node) return tl::unexpected(node.error());
    cameras.items.push_back(*std::move(node));
  }
  NodeMap map;
  map.put("format", text_node(kRigFormat));
  map.put("version", integer_node(kRigVersion));
  map.put("world", text_node(rig.world));
  if (!rig.is_metric) map.put("unit", text_node(kNoUnit));
  map.put("rms", rig.rms);
  map.put("pairing_tolerance_ns", integer_node(rig.pairing_tolerance));
  map.put("cameras", std::move(cameras));
  put_boards(rig, map);
  return print_json(map.take());
}

}  // namespace calvin::io
