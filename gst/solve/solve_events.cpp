// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The names of the custom events and of the keys.

#include "solve/solve_events.hpp"

#include <string_view>

#include <gst/video/navigation.h>

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
    {"calvin-remove-view", "BackSpace", Kind::kRemoveView},
};

// The largest number, which no view has, for what is no index.
std::optional<unsigned> index_of(const GstStructure* structure) {
  if (!gst_structure_has_field(structure, "index")) return std::nullopt;
  guint index = 0;
  if (gst_structure_get_uint(structure, "index", &index)) return index;
  int number = 0;
  if (gst_structure_get_int(structure, "index", &number) && number >= 0) {
    return static_cast<unsigned>(number);
  }
  return G_MAXUINT;
}

std::optional<SolveCommand> of_custom(const GstStructure* structure) {
  for (const Row& row : kRows) {
    if (!gst_structure_has_name(structure, row.event)) continue;
    return SolveCommand{row.kind, index_of(structure), true};
  }
  return std::nullopt;
}

std::optional<SolveCommand> of_key(GstEvent* event) {
  const char* key = nullptr;
  if (!gst_navigation_event_parse_key_event(event, &key) || key == nullptr) return std::nullopt;
  for (const Row& row : kRows) {
    if (std::string_view(key) == row.key) return SolveCommand{row.kind, std::nullopt, false};
  }
  return std::nullopt;
}

std::optional<SolveCommand> of_click(GstEvent* event) {
  constexpr int kLeft = 1;
  int button = 0;
  double x = 0;
  double y = 0;
  if (!gst_navigation_event_parse_mouse_button_event(event, &button, &x, &y)) return std::nullopt;
  if (button != kLeft) return std::nullopt;
  return SolveCommand{Kind::kCaptureView, std::nullopt, false};
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
  if (GST_EVENT_TYPE(event) != GST_EVENT_NAVIGATION) return std::nullopt;
  switch (gst_navigation_event_get_type(event)) {
    case GST_NAVIGATION_EVENT_KEY_PRESS:
      return of_key(event);
    case GST_NAVIGATION_EVENT_MOUSE_BUTTON_PRESS:
      return of_click(event);
    default:
      return std::nullopt;
  }
}

}  // namespace calvin::gst
