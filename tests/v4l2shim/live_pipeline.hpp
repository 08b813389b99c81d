// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A pipeline with an emulated camera, and all that its bus says.
// Include it before gstcheck.h, which defines the macro `fail`.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <gst/check/gstcheck.h>

namespace calvin::check {

class LivePipeline {
 public:
  explicit LivePipeline(const std::string& line)
      : element_(gst_parse_launch(line.c_str(), nullptr)) {
    fail_unless(element_ != nullptr, "%s", line.c_str());
    bus_ = gst_element_get_bus(element_);
  }
  LivePipeline(const LivePipeline&) = delete;
  LivePipeline& operator=(const LivePipeline&) = delete;
  ~LivePipeline() {
    stop();
    for (GstMessage* message : messages_) gst_message_unref(message);
    gst_object_unref(bus_);
    gst_object_unref(element_);
  }

  [[nodiscard]] GstElement* element() const { return element_; }
  // Owned by the pipeline.
  [[nodiscard]] GstElement* get(const char* name) const {
    GstElement* child = gst_bin_get_by_name(GST_BIN(element_), name);
    fail_unless(child != nullptr, "no %s", name);
    gst_object_unref(child);
    return child;
  }
  GstStateChangeReturn play() const { return gst_element_set_state(element_, GST_STATE_PLAYING); }
  void end() const { gst_element_send_event(element_, gst_event_new_eos()); }
  // Messages that were still on the bus are kept.
  void stop() {
    gst_element_set_state(element_, GST_STATE_READY);
    while (GstMessage* message = gst_bus_pop(bus_)) messages_.push_back(message);
    gst_element_set_state(element_, GST_STATE_NULL);
  }

  using Wanted = std::function<bool(GstMessage*)>;
  // The next message that is as wanted; the test fails where none comes. Borrowed.
  GstMessage* wait(const char* what, const Wanted& is_wanted) {
    const gint64 most = g_get_monotonic_time() + 40 * G_USEC_PER_SEC;
    while (g_get_monotonic_time() < most) {
      GstMessage* message = gst_bus_timed_pop(bus_, GST_SECOND);
      if (message == nullptr) continue;
      messages_.push_back(message);
      if (is_wanted(message)) return message;
    }
    fail("waited in vain for %s", what);
    return nullptr;
  }
  GstMessage* wait(GstMessageType type) {
    return wait(gst_message_type_get_name(type),
                [type](GstMessage* message) { return GST_MESSAGE_TYPE(message) == type; });
  }
  // The next element message of that name that is as wanted.
  using WantedStructure = std::function<bool(const GstStructure*)>;
  const GstStructure* wait(const char* name, const WantedStructure& is_wanted) {
    return gst_message_get_structure(wait(name, [&](GstMessage* message) {
      const GstStructure* s = gst_message_get_structure(message);
      return s != nullptr && gst_structure_has_name(s, name) && is_wanted(s);
    }));
  }

  // All so far.
  [[nodiscard]] const std::vector<GstMessage*>& messages() const { return messages_; }
  // Errors and INFOs whose text holds `part`.
  [[nodiscard]] bool says(GstMessageType type, const char* part) const {
    return std::any_of(messages_.begin(), messages_.end(), [&](GstMessage* message) {
      return GST_MESSAGE_TYPE(message) == type && text_of(message).find(part) != std::string::npos;
    });
  }
  [[nodiscard]] static std::string text_of(GstMessage* message) {
    g_autoptr(GError) error = nullptr;
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      gst_message_parse_error(message, &error, nullptr);
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
      gst_message_parse_warning(message, &error, nullptr);
    } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_INFO) {
      gst_message_parse_info(message, &error, nullptr);
    }
    return error == nullptr ? "" : error->message;
  }

 private:
  GstElement* element_;
  GstBus* bus_ = nullptr;
  std::vector<GstMessage*> messages_;
};

}  // namespace calvin::check
