// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A source of pictures, one after the other: each is decoded when the one before it has been taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include <gst/app/gstappsrc.h>
#include <gst/gst.h>

#include "calibrate_images_decode.hpp"

namespace calibrate_images {

// Picture n is at n seconds, by which views are known again: files do not say when they are.
inline std::size_t picture_at(std::uint64_t time) {
  return static_cast<std::size_t>(time / GST_SECOND);
}

struct Feed {
  std::vector<std::filesystem::path> files;
  std::size_t next = 0;
};

// The name of the element message about a picture that could be decoded before and no longer can:
// its index, and why.
inline constexpr const char* kLost = "picture-lost";

inline void post_lost(GstElement* source, std::size_t index, const std::string& why) {
  g_autofree char* text = g_utf8_make_valid(why.c_str(), -1);
  gst_element_post_message(
      source, gst_message_new_element(
                  GST_OBJECT(source),
                  gst_structure_new(kLost, "index", G_TYPE_UINT64, static_cast<guint64>(index),
                                    "why", G_TYPE_STRING, text, nullptr)));
}

// On the streaming thread of the source, whenever it has nothing left.
inline void push_next(GstElement* source, guint /*bytes*/, gpointer data) {
  Feed& feed = *static_cast<Feed*>(data);
  while (feed.next < feed.files.size()) {
    const std::size_t index = feed.next++;
    const auto sample = decode(feed.files[index]);
    if (!sample) {
      post_lost(source, index, sample.error().message);
      continue;
    }
    g_autoptr(GstBuffer) buffer = gst_buffer_copy(gst_sample_get_buffer(sample->get()));
    GST_BUFFER_PTS(buffer) = index * GST_SECOND;
    g_autoptr(GstSample) timed =
        gst_sample_new(buffer, gst_sample_get_caps(sample->get()), nullptr, nullptr);
    gst_app_src_push_sample(GST_APP_SRC(source), timed);
    return;
  }
  gst_app_src_end_of_stream(GST_APP_SRC(source));
}

// An element that gives the pictures of these files, then the end.
inline GstElement* make_feed(std::vector<std::filesystem::path> files) {
  GstElement* source = gst_element_factory_make("appsrc", nullptr);
  gst_util_set_object_arg(G_OBJECT(source), "format", "time");
  g_signal_connect_data(
      source, "need-data", G_CALLBACK(push_next), new Feed{std::move(files)},
      [](gpointer feed, GClosure* /*closure*/) { delete static_cast<Feed*>(feed); },
      G_CONNECT_DEFAULT);
  return source;
}

}  // namespace calibrate_images
