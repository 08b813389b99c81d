// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sticky downstream event `calvin-rig`.

#include "common/rig_event.hpp"

#include "common/values.hpp"

namespace calvin::gst {

static constexpr char kRigEvent[] = "calvin-rig";

GstEvent* new_rig_event(const std::string& json) {
  return gst_event_new_custom(
      GST_EVENT_CUSTOM_DOWNSTREAM_STICKY,
      gst_structure_new(kRigEvent, "json", G_TYPE_STRING, json.c_str(), nullptr));
}

std::optional<std::string> parse_rig_event(GstEvent* event) {
  if (GST_EVENT_TYPE(event) != GST_EVENT_CUSTOM_DOWNSTREAM_STICKY ||
      !gst_event_has_name(event, kRigEvent)) {
    return std::nullopt;
  }
  return get_string(gst_event_get_structure(event), "json");
}

}  // namespace calvin::gst
