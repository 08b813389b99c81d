// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A whole pipeline under test: what passes its elements, and what it says.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "support.hpp"

#include <gst/check/gstcheck.h>

namespace calvin::check {

// The buffers that passed a pad; written by a streaming thread.
class Kept {
 public:
  Kept() = default;
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  ~Kept() {
    for (GstBuffer* buffer : all_) gst_buffer_unref(buffer);
  }
  void add(GstBuffer* buffer) {
    const std::lock_guard guard(lock_);
    all_.push_back(gst_buffer_ref(buffer));
  }
  [[nodiscard]] std::size_t size() {
    const std::lock_guard guard(lock_);
    return all_.size();
  }
  // Borrowed.
  [[nodiscard]] GstBuffer* at(std::size_t n) {
    const std::lock_guard guard(lock_);
    return all_.at(n);
  }
  [[nodiscard]] GstBuffer* back() { return at(size() - 1); }

 private:
  std::mutex lock_;
  std::vector<GstBuffer*> all_;
};

// A whole pipeline, some of whose elements are listened to.
class Pipeline {
 public:
  explicit Pipeline(const std::string& line)
      : element_(gst_parse_launch(line.c_str(), nullptr)), bus_(gst_element_get_bus(element_)) {
    g_assert_nonnull(element_);
  }
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
  ~Pipeline() {
    gst_bus_set_flushing(bus_, TRUE);
    gst_element_set_state(element_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(element_);
  }

  [[nodiscard]] GstBin* bin() const { return GST_BIN(element_); }
  // Owned by the pipeline.
  [[nodiscard]] GstElement* get(const char* name) const {
    GstElement* child = gst_bin_get_by_name(bin(), name);
    fail_unless(child != nullptr, "no %s", name);
    gst_object_unref(child);
    return child;
  }
  // Every buffer that leaves the element.
  void keep(const char* name) {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(get(name), "src");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer kept) {
          static_cast<Kept*>(kept)->add(GST_PAD_PROBE_INFO_BUFFER(info));
          return GST_PAD_PROBE_OK;
        },
        &kept_[name], nullptr);
  }
  [[nodiscard]] Kept& kept(const char* name) { return kept_[name]; }
  void set_state(GstState state) { gst_element_set_state(element_, state); }
  // Paused or better: there is a frame everywhere.
  void preroll(GstState state = GST_STATE_PAUSED) {
    set_state(state);
    fail_if(gst_element_get_state(element_, nullptr, nullptr, 30 * GST_SECOND) ==
            GST_STATE_CHANGE_FAILURE);
  }
  // Plays to the end; the element messages of that name that came.
  std::vector<GstStructure*> play(const char* name) {
    set_state(GST_STATE_PLAYING);
    std::vector<GstStructure*> found;
    for (;;) {
      g_autoptr(GstMessage) message = gst_bus_timed_pop(bus_, 60 * GST_SECOND);
      fail_unless(message != nullptr, "no end");
      fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR);
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) return found;
      const GstStructure* s = gst_message_get_structure(message);
      if (s != nullptr && gst_structure_has_name(s, name)) found.push_back(gst_structure_copy(s));
    }
  }
  // Until an element says that; it goes on playing.
  void wait_for(const char* name) {
    for (;;) {
      g_autoptr(GstMessage) message = gst_bus_timed_pop(bus_, 60 * GST_SECOND);
      fail_unless(message != nullptr, "no %s", name);
      fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR);
      if (gst_message_has_name(message, name)) return;
    }
  }

 private:
  GstElement* element_;
  GstBus* bus_;
  std::map<std::string, Kept> kept_;
};

}  // namespace calvin::check
