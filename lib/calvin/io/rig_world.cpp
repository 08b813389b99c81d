// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the text apart between its colons.

#include "calvin/io/rig_world.hpp"

#include <limits>
#include <string>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin {

namespace {

std::optional<RigWorld::Turn> to_turn(std::string_view text) {
  constexpr int kQuarter = 90;  // degrees
  constexpr int kMost = 360;
  constexpr std::string_view kAxes = "xyz";
  const auto axis = text.empty() ? std::string_view::npos : kAxes.find(text.front());
  if (axis == std::string_view::npos) return std::nullopt;
  const auto degrees = parse_int(text.substr(1));
  if (!degrees || *degrees % kQuarter != 0 || *degrees < -kMost || *degrees > kMost) {
    return std::nullopt;
  }
  return RigWorld::Turn{static_cast<int>(axis), *degrees / kQuarter};
}

std::optional<double> to_time(std::string_view text) {
  if (text == "last") return std::numeric_limits<double>::infinity();
  if (text.ends_with('s')) text.remove_suffix(1);
  const auto time = parse_double(text);
  return time && *time >= 0 ? time : std::nullopt;
}

std::optional<RigWorld> to_world(std::string_view text) {
  const auto fields = split(text, ':');
  RigWorld world;
  std::size_t next = 1;
  if (fields[0] != kBoardWorld) {
    world.camera = fields[0];
    if (world.camera.empty()) return std::nullopt;
  } else if (fields.size() > 1) {
    world.time = to_time(fields[1]);
    if (world.time) ++next;
  }
  for (; next < fields.size(); ++next) {
    const auto turn = to_turn(fields[next]);
    if (!turn) return std::nullopt;
    world.turns.push_back(*turn);
  }
  return world;
}

}  // namespace

Result<std::optional<RigWorld>> parse_rig_world(std::string_view text) {
  text = trim(text);
  if (text.empty()) return std::nullopt;
  auto world = to_world(text);
  if (!world) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("'{}' is no frame of a rig: name a camera, or a board as board (where it was "
                    "first), board:12.5 (where it was at that second) or board:last, and quarter "
                    "turns of the axes, as board:x180 with z up from a board on the floor.",
                    shortened(text, 80)));
  }
  return world;
}

}  // namespace calvin
