// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// An owned reference to a GstEvent.
#pragma once

#include <memory>

#include <gst/gst.h>

namespace calvin::gst {

struct UnrefEvent {
  void operator()(GstEvent* event) const { gst_event_unref(event); }
};
using EventPtr = std::unique_ptr<GstEvent, UnrefEvent>;

}  // namespace calvin::gst
