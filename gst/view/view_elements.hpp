// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The two elements of which calibview holds one: neither is registered by a name of its own.
#pragma once

#include <memory>

#include <gst/gst.h>

#include "view/view_state.hpp"

namespace calvin::gst {

// Makes frames.
[[nodiscard]] GstElement* new_view_source(std::shared_ptr<ViewState> state);

// Makes one for each frame that comes in, at its time, of the rig that `calvin-rig` events tell.
[[nodiscard]] GstElement* new_view_filter(std::shared_ptr<ViewState> state);

}  // namespace calvin::gst
