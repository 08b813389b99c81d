// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Element messages on the bus.

#include "common/messages.hpp"

#include "common/values.hpp"

namespace calvin::gst {

namespace {

struct GstCode {
  GQuark domain;
  int code;
};

GstCode gst_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kNotFound:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND};
    case ErrorCode::kIo:
      return {GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_READ_WRITE};
    case ErrorCode::kMalformed:
      return {GST_STREAM_ERROR, GST_STREAM_ERROR_FORMAT};
    case ErrorCode::kUnsupported:
      return {GST_STREAM_ERROR, GST_STREAM_ERROR_NOT_IMPLEMENTED};
    case ErrorCode::kDegenerate:
      return {GST_STREAM_ERROR, GST_STREAM_ERROR_FAILED};
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kCancelled:
      break;
  }
  return {GST_LIBRARY_ERROR, GST_LIBRARY_ERROR_SETTINGS};
}

void post(GstElement* element, GstMessageType type, const Error& error) {
  const GstCode code = gst_code(error.code);
  const std::string text = displayed(error.message);
  // Of an INFO, gst-launch-1.0 prints what is meant for debugging, and nothing else.
  const char* again = type == GST_MESSAGE_INFO ? text.c_str() : nullptr;
  gst_element_message_full(element, type, code.domain, code.code, g_strdup(text.c_str()),
                           g_strdup(again), __FILE__, GST_FUNCTION, __LINE__);
}

}  // namespace

FrameTimes frame_times(const GstSegment* segment, GstBuffer* buffer) {
  return frame_times(segment, GST_BUFFER_PTS(buffer), GST_BUFFER_DURATION(buffer));
}

FrameTimes frame_times(const GstSegment* segment, GstClockTime timestamp, GstClockTime duration) {
  FrameTimes times;
  times.timestamp = timestamp;
  times.duration = duration;
  if (segment->format == GST_FORMAT_TIME && GST_CLOCK_TIME_IS_VALID(times.timestamp)) {
    times.stream_time = gst_segment_to_stream_time(segment, GST_FORMAT_TIME, times.timestamp);
    times.running_time = gst_segment_to_running_time(segment, GST_FORMAT_TIME, times.timestamp);
  }
  return times;
}

GstStructure* new_message(const char* name, const FrameTimes& times, const std::string& camera) {
  return gst_structure_new(name, "timestamp", G_TYPE_UINT64, times.timestamp, "stream-time",
                           G_TYPE_UINT64, times.stream_time, "running-time", G_TYPE_UINT64,
                           times.running_time, "duration", G_TYPE_UINT64, times.duration, "camera",
                           G_TYPE_STRING, displayed(camera).c_str(), nullptr);
}

void post_message(GstElement* element, GstStructure* structure) {
  gst_element_post_message(element, gst_message_new_element(GST_OBJECT(element), structure));
}

void post_info(GstElement* element, const std::string& text) {
  post(element, GST_MESSAGE_INFO, {ErrorCode::kInvalidArgument, text});
}

void post_error(GstElement* element, const Error& error) {
  post(element, GST_MESSAGE_ERROR, error);
}

void post_warning(GstElement* element, const Error& error) {
  post(element, GST_MESSAGE_WARNING, error);
}

void warn_if_late(GstElement* element, const GParamSpec* spec) {
  if ((spec->flags & GST_PARAM_MUTABLE_READY) == 0 || GST_STATE(element) <= GST_STATE_READY) return;
  post_warning(element, {ErrorCode::kInvalidArgument,
                         "The property '" + std::string(spec->name) +
                             "' cannot change while the element runs: the new value takes effect "
                             "at the next start from READY."});
}

Posting::Posting(GstElement* element) : element_(element) {
  auto* object = GST_OBJECT(gst_object_ref(element));
  for (; object != nullptr; object = gst_object_get_parent(object)) {
    family_ = g_slist_prepend(family_, object);
  }
}

Posting::~Posting() {
  gst_element_call_async(
      element_, [](GstElement* /*element*/, gpointer /*family*/) {}, family_,
      [](gpointer family) { g_slist_free_full(static_cast<GSList*>(family), gst_object_unref); });
}

}  // namespace calvin::gst
