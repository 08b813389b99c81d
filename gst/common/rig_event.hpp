// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sticky downstream event `calvin-rig` {json}.
#pragma once

#include <optional>
#include <string>

#include <gst/gst.h>

namespace calvin::gst {

// `json` is a native rig.
[[nodiscard]] GstEvent* new_rig_event(const std::string& json);

// The JSON; absent where the event is another one.
[[nodiscard]] std::optional<std::string> parse_rig_event(GstEvent* event);

}  // namespace calvin::gst
