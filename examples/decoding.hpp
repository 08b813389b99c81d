// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A pipeline that decodes one file, still picture or video, up to its first picture.
//   filesrc ! decodebin ! videoconvert ! appsink
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <gst/app/gstappsink.h>
#include <gst/gst.h>

namespace decoding {

struct Unref {
  void operator()(GstSample* sample) const { gst_sample_unref(sample); }
};
using Sample = std::unique_ptr<GstSample, Unref>;

inline constexpr GstClockTime kPatience = 10 * GST_SECOND;  // until a file shows its first picture

inline void link_decoded(GstElement* /*decodebin*/, GstPad* pad, gpointer sink) {
  if (!gst_pad_is_linked(GST_PAD(sink))) gst_pad_link(pad, GST_PAD(sink));
}

// The faster transform of jpegdec, its default, moves corners by some hundredths of a pixel.
inline void decode_exactly(GstBin* /*decodebin*/, GstBin* /*in*/, GstElement* element,
                           gpointer /*unused*/) {
  if (g_object_class_find_property(G_OBJECT_GET_CLASS(element), "idct-method") != nullptr) {
    gst_util_set_object_arg(G_OBJECT(element), "idct-method", "islow");
  }
}

// The first type that decodebin tells is that of the file: "image/..." of a still picture. It tells
// none of a text.
inline gboolean note_type(GstElement* /*decodebin*/, GstPad* /*pad*/, GstCaps* caps, gpointer of) {
  auto& type = *static_cast<std::string*>(of);
  if (type.empty()) type = gst_structure_get_name(gst_caps_get_structure(caps, 0));
  return TRUE;  // decodebin goes on as without this function
}

// The pipeline for one file. Its sink takes the first decoded stream that is video, as `gray`.
inline GstElement* make_decoder(const std::filesystem::path& file, std::string& type) {
  GstElement* pipeline = gst_pipeline_new(nullptr);
  GstElement* source = gst_element_factory_make("filesrc", nullptr);
  GstElement* decoder = gst_element_factory_make("decodebin", nullptr);
  GstElement* convert = gst_element_factory_make("videoconvert", nullptr);
  GstElement* sink = gst_element_factory_make("appsink", "picture");
  g_autoptr(GstCaps) gray = gst_caps_from_string("video/x-raw,format=GRAY8");
  g_object_set(source, "location", file.c_str(), nullptr);
  g_object_set(sink, "caps", gray, "sync", FALSE, "max-buffers", 1, nullptr);
  gst_bin_add_many(GST_BIN(pipeline), source, decoder, convert, sink, nullptr);
  gst_element_link(source, decoder);
  gst_element_link(convert, sink);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(convert, "sink");
  g_signal_connect(decoder, "deep-element-added", G_CALLBACK(decode_exactly), nullptr);
  g_signal_connect(decoder, "autoplug-continue", G_CALLBACK(note_type), &type);
  g_signal_connect_object(decoder, "pad-added", G_CALLBACK(link_decoded), pad, G_CONNECT_DEFAULT);
  return pipeline;
}

// In place of an error's words, of a file that decodebin takes for a text.
inline constexpr const char* kText = "text";

// Waits until the sink has a picture, or its stream has ended without one. What went wrong, if
// anything did. `type` is what make_decoder() has noted: parsers, too, call a picture that is cut
// off of a wrong type.
inline std::string preroll(GstElement* pipeline, const std::string& type) {
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(
      bus, kPatience, static_cast<GstMessageType>(GST_MESSAGE_ASYNC_DONE | GST_MESSAGE_ERROR));
  if (message == nullptr) return "it takes longer than 10 s";
  if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) return "";
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  const bool is_wrong_type =
      g_error_matches(error, GST_STREAM_ERROR, GST_STREAM_ERROR_WRONG_TYPE) != FALSE;
  if (is_wrong_type && type.empty()) return kText;
  return error->message;
}

}  // namespace decoding
