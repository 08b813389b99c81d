// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Element messages on the bus, and what they all carry.
#pragma once

#include <string>

#include <gst/gst.h>

#include "calvin/core/result.hpp"
#include "calvin/session/frame_times.hpp"

namespace calvin::gst {

static_assert(GST_CLOCK_TIME_NONE == kNoTimestamp);  // of FrameTimes, and of an observation

// Computed on the streaming thread: the segment may change before a worker is done.
[[nodiscard]] FrameTimes frame_times(const GstSegment* segment, GstBuffer* buffer);
[[nodiscard]] FrameTimes frame_times(const GstSegment* segment, GstClockTime timestamp,
                                     GstClockTime duration);

// {name: timestamp, stream-time, running-time, duration, camera}; the caller adds the payload.
[[nodiscard]] GstStructure* new_message(const char* name, const FrameTimes& times,
                                        const std::string& camera);

// Posts it as an element message; takes the structure. Any thread.
void post_message(GstElement* element, GstStructure* structure);

// What the user may want to know, as an INFO of the element.
void post_info(GstElement* element, const std::string& text);

// A library error as an ERROR or WARNING of the element, in the matching GStreamer domain.
void post_error(GstElement* element, const Error& error);
void post_warning(GstElement* element, const Error& error);

// To be called for every property that is set: a WARNING where the change takes effect only when
// the element starts again.
void warn_if_late(GstElement* element, const GParamSpec* spec);

// To be held by a worker while it posts or notifies. Both take a reference for a moment; where the
// rest of the program lets go of the element meanwhile, that one is the last, and freeing the
// element would make the worker wait for itself. The references of this are dropped elsewhere. The
// bins around the element, whose buses pass its messages on, stay as long.
class Posting {
 public:
  explicit Posting(GstElement* element);
  Posting(const Posting&) = delete;
  Posting& operator=(const Posting&) = delete;
  ~Posting();

 private:
  GstElement* element_;
  GSList* family_ = nullptr;  // the element, its parent, that one's and so on
};

}  // namespace calvin::gst
