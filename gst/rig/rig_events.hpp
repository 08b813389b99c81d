// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What events from downstream ask of calibrig: its action signals as custom events.
#pragma once

#include <optional>
#include <string>

#include <gst/gst.h>

namespace calvin::gst {

// The name of the camera that `calvin-reinsert` {camera} is about; empty: that of the pad which the
// event comes to. Absent for other events.
[[nodiscard]] std::optional<std::string> reinsert_request(GstEvent* event);

}  // namespace calvin::gst
