// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The custom events of calibrig.

#include "rig/rig_events.hpp"

#include "common/values.hpp"

namespace calvin::gst {

std::optional<std::string> reinsert_request(GstEvent* event) {
  const GstEventType type = GST_EVENT_TYPE(event);
  const bool is_custom = type == GST_EVENT_CUSTOM_UPSTREAM || type == GST_EVENT_CUSTOM_BOTH ||
                         type == GST_EVENT_CUSTOM_BOTH_OOB;
  if (!is_custom || !gst_event_has_name(event, "calvin-reinsert")) return std::nullopt;
  return get_string(gst_event_get_structure(event), "camera");
}

}  // namespace calvin::gst
