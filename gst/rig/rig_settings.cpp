// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads the settings of calibrig, and refuses those of which no rig can come.

#include "rig/rig_settings.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/utf8.hpp"
#include "calvin/detect/board_identifier.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/camera_baselines.hpp"
#include "calvin/io/camera_places.hpp"
#include "calvin/io/rig_world.hpp"
#include "calvin/rig/joint/board_scale.hpp"
#include "calvin/rig/result/rig_frame.hpp"
#include "calvin/rig/solve_light.hpp"
#include "calvin/session/rig/rig_exports.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::gst {

namespace {

// The boards that count, as calibdetect takes them; none: every board, as with `auto`, of which
// calibdetect says what it has found.
Result<std::vector<Board>> counted_boards(const std::string& text) {
  if (text.empty()) return std::vector<Board>();
  if (const auto any = parse_auto_board(text)) {
    if (!*any) return tl::unexpected<Error>(any->error());
    return std::vector<Board>();
  }
  return parse_boards(text);
}

// What is to be known of a solve by a light.
Result<LightOptions> light_options(const RigSettings& settings,
                                   const std::vector<CameraBaseline>& baselines) {
  LightOptions options;
  options.model = settings.model;
  options.center_sigma = settings.center_sigma;
  options.wand_sigma = settings.wand_sigma;
  options.fix.clear();
  for (const std::string_view name : split(settings.fix, ',')) {
    if (!trim(name).empty() && trim(name) != "none") options.fix.emplace_back(trim(name));
  }
  if (const Status good = check(options); !good) return tl::unexpected(good.error());
  // Places of two cameras give the unit alone.
  if (settings.places.empty() && baselines.size() == 1 && !baselines.front().a.empty()) {
    set_known_distance(baselines.front(), options);
  }
  if (settings.places.empty()) return options;
  auto places = read_camera_places(settings.places);
  if (!places) return tl::unexpected(places.error());
  options.places = *std::move(places);
  return options;
}

// Whether it is known before anything is seen that cameras look at a light.
bool expects_light(const RigSessionSettings& session) {
  if (session.method != RigMethod::kAuto) return session.method == RigMethod::kSvoboda;
  const auto is_light = [](const Board& board) { return board.as<PointLight>() != nullptr; };
  return !session.boards.empty() && std::ranges::all_of(session.boards, is_light);
}

// Of known distances those with names, or without.
Status check_distances(std::vector<CameraBaseline> baselines, bool with_names,
                       const std::vector<std::string>& cameras) {
  std::erase_if(baselines, [with_names](const CameraBaseline& one) {
    return (one.a.empty() && one.b.empty()) == with_names;
  });
  const auto known = rig::known_distances(baselines, cameras);
  return known ? Status() : tl::unexpected<Error>(known.error());
}

Status check_settings(const RigSessionSettings& session) {
  if (expects_light(session)) return check_light(session.options, session.light);
  if (session.options.mode != RigMode::kFloor ||
      session.options.intrinsics == RigIntrinsics::kHeld) {
    return {};
  }
  return make_error(ErrorCode::kInvalidArgument,
                    "A board on the floor tells where cameras stand and not their intrinsics: take "
                    "estimate-intrinsics=no, or mode=joint and carry the board before two cameras "
                    "at a time.");
}

}  // namespace

Status check_light(const RigOptions& options, const LightOptions& light) {
  const auto invalid = [](const char* message) {
    return make_error(ErrorCode::kInvalidArgument, message);
  };
  if (options.mode == RigMode::kFloor) {
    return invalid("A light is no floor that cameras stand above: take mode=joint.");
  }
  if (options.intrinsics != RigIntrinsics::kHeld) {
    return invalid(
        "Before a light the lenses of all cameras without intrinsics are found, and no others: "
        "take estimate-intrinsics=no, and leave out the intrinsics of the pads whose lenses are "
        "to be found.");
  }
  if (options.world) {
    return invalid("Before a light places give the frame of the rig, and not world.");
  }
  if (!options.baselines.empty() && light.places.empty()) {
    return invalid(
        "Before a light one known distance, with the names of its cameras, gives the unit. Where "
        "more is known take places.");
  }
  return {};
}

Status check_cameras(RigModeChoice mode, const RigOptions& options,
                     const std::vector<std::string>& names) {
  std::set<std::string> known;
  for (const std::string& name : names) {
    if (known.insert(name).second) continue;
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Two cameras of the rig are called '{}': give each a name of its "
                                  "own, as sink_1::camera=right.",
                                  shortened(name, 64)));
  }
  if (names.size() <= 2) return {};
  if (mode == kRigStereo) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("A stereo rig has two cameras, and {} are linked: take "
                                  "mode=joint.",
                                  names.size()));
  }
  return check_distances(options.baselines, false, names);
}

Status check_named(const RigOptions& options, const std::vector<std::string>& pads) {
  if (pads.size() < 2) return {};
  if (options.world) {
    if (Status known = rig::check_world(*options.world, pads); !known) return known;
  }
  return check_distances(options.baselines, true, pads);
}

Result<RigSessionSettings> session_settings(const RigSettings& now) {
  RigSessionSettings session;
  auto boards = counted_boards(now.board);
  if (!boards) return tl::unexpected(boards.error());
  session.boards = *std::move(boards);
  if (const auto exports = parse_rig_exports(now.exports); !exports) {
    return tl::unexpected(exports.error());
  }
  auto baselines = parse_camera_baselines(now.baseline);
  if (!baselines) return tl::unexpected(baselines.error());
  auto light = light_options(now, *baselines);
  if (!light) return tl::unexpected(light.error());
  auto world = parse_rig_world(now.world);
  if (!world) return tl::unexpected(world.error());
  session.options.mode = now.mode == kRigFloor ? RigMode::kFloor : RigMode::kJoint;
  session.options.tolerance = now.tolerance;
  session.options.baselines = *std::move(baselines);
  session.options.board_sigma = now.board_sigma;
  session.options.fixed_boards = now.fixed_boards;
  session.options.intrinsics = now.intrinsics;
  session.options.world = *std::move(world);
  session.method = now.method;
  session.light = *std::move(light);
  if (const Status possible = check_settings(session); !possible) {
    return tl::unexpected(possible.error());
  }
  return session;
}

}  // namespace calvin::gst
