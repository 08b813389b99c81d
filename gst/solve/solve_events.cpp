// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The names of the custom events and of the keys.

#include "solve/solve_events.hpp"

#include <string_view>

#include <gst/video/navigation.h>

#include "common/points/point_values.hpp"

namespace calvin::gst {

namespace {

using Kind = SolveCommand::Kind;

struct Row {
  const char* event;
  const char* key;  // as X11 names it
  Kind kind;
};
constexpr Row kRows[] = {
    {"calvin-capture-view", "space", Kind::kCaptureView},
    {"calvin-solve", "Return", Kind::kSolve},
    {"calvin-reset", "Delete", Kind::kReset},
    {"calvin-remove-view", nullptr, Kind::kRemoveView},
    {kPointName, nullptr, Kind::kPoint},
    {kRemovePointName, nullptr, Kind::kRemovePoint},
    {nullptr, "BackSpace", Kind::kUndo},
};

std::optional<SolveCommand> of_custom(const GstStructure* structure) {
  for (const Row& row : kRows) {
    if (row.event == nullptr || !gst_structure_has_name(structure, row.event)) continue;
    return SolveCommand{row.kind, read_index(structure), true, read_point(structure)};
  }
  return std::nullopt;
}

std::optional<SolveCommand> of_key(GstEvent* event) {
  const char* key = nullptr;
  if (!gst_navigation_event_parse_key_event(event, &key) || key == nullptr) return std::nullopt;
  for (const Row& row : kRows) {
    if (row.key != nullptr && std::string_view(key) == row.key) return SolveCommand{row.kind};
  }
  return std::nullopt;
}

}  // namespace

std::optional<SolveCommand> solve_command(GstEvent* event) {
  const GstStructure* structure = gst_event_get_structure(event);
  if (structure == nullptr) return std::nullopt;
  if (GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM ||
      GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_BOTH ||
      GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_BOTH_OOB) {
    return of_custom(structure);
  }
  if (const auto click = read_click(event)) {
    return SolveCommand{
        click->takes_out ? Kind::kTakeOut : Kind::kClick, std::nullopt, false, {click->at, {}, {}}};
  }
  if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION ||
      gst_navigation_event_get_type(event) != GST_NAVIGATION_EVENT_KEY_PRESS) {
    return std::nullopt;
  }
  return of_key(event);
}

}  // namespace calvin::gst
