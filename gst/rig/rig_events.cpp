// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The events of calibrig, and what they command.

#include "rig/rig_events.hpp"

#include <gst/video/navigation.h>

#include "common/points/point_values.hpp"
#include "common/values.hpp"
#include "rig/rig_pad.hpp"

namespace calvin::gst {

namespace {

using Kind = RigCommand::Kind;

struct Row {
  const char* event;
  Kind kind;
};
constexpr Row kRows[] = {
    {"calvin-reinsert", Kind::kReinsert},
    {kPointName, Kind::kPoint},
    {kRemovePointName, Kind::kRemovePoint},
};

std::optional<RigCommand> of_custom(GstEvent* event) {
  for (const Row& row : kRows) {
    if (!gst_event_has_name(event, row.event)) continue;
    const GstStructure* s = gst_event_get_structure(event);
    return RigCommand{row.kind, get_string(s, "camera"), read_index(s), read_point(s), true};
  }
  return std::nullopt;
}

}  // namespace

std::optional<RigCommand> rig_command(GstEvent* event) {
  const GstEventType type = GST_EVENT_TYPE(event);
  if (type == GST_EVENT_CUSTOM_UPSTREAM || type == GST_EVENT_CUSTOM_BOTH ||
      type == GST_EVENT_CUSTOM_BOTH_OOB) {
    return of_custom(event);
  }
  const auto click = read_click(event);
  if (!click) return std::nullopt;
  return RigCommand{
      click->takes_out ? Kind::kTakeOut : Kind::kClick, "", std::nullopt, {click->at, {}, {}}};
}

void run_command(RigSolver& solver, const RigCommand& command, GstPad* sink) {
  const std::size_t own = camera_of(sink);
  const bool is_named = !command.camera.empty();
  switch (command.kind) {
    case Kind::kReinsert:
      (void)(is_named ? solver.reinsert(command.camera) : solver.reinsert(own));
      break;
    case Kind::kPoint:
      if (is_named) {
        (void)solver.add_point(command.camera, command.point);
      } else {
        solver.add_point(own, command.point);
      }
      break;
    case Kind::kRemovePoint:
      (void)(is_named ? solver.remove_point(command.camera, command.index)
                      : solver.remove_point(own, command.index));
      break;
    case Kind::kClick:
      if (solver.clicks_choose(own)) solver.add_point(own, command.point);
      break;
    case Kind::kTakeOut:
      if (solver.has_points(own)) (void)solver.remove_point(own, std::nullopt);
      break;
  }
}

}  // namespace calvin::gst
