// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pictures through one pipeline, one after the other, and what its elements say of each.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>

#include "calibrate_images_folder.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/io/calibration_io.hpp"

namespace calibrate_images {

struct Options {
  std::string board = "checkerboard:9x6:25mm";
  std::string model = "brown5";
  std::string fix;
  std::string initial;
  std::vector<std::string> leave_out;
  bool one_camera = false;
  bool verdict = false;
  std::optional<double> accuracy;  // px
  std::filesystem::path output = ".";
  std::filesystem::path folder;

  [[nodiscard]] std::string location() const { return (output / "camera.json").string(); }
};

// What became of the pictures: the corners of each where a board was found, by its place in the
// list, and why not.
struct Outcome {
  bool good = false;
  std::map<std::size_t, int> corners;
  std::map<std::size_t, std::string> reasons;
  std::optional<calvin::Calibration> calibration;
};

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

// Picture n is at n seconds, by which views are known again: files do not say when they are.
inline GstPadProbeReturn set_time(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer number) {
  auto* buffer = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_BUFFER_PTS(buffer) = (*static_cast<guint64*>(number))++ * GST_SECOND;
  GST_PAD_PROBE_INFO_DATA(info) = buffer;
  return GST_PAD_PROBE_OK;
}

inline std::size_t picture_at(std::uint64_t time) {
  return static_cast<std::size_t>(time / GST_SECOND);
}

// Adds filesrc ! decodebin ! videoconvert for one picture in front of the concat.
inline void add_picture(GstBin* bin, GstElement* concat, const Picture& picture) {
  GstElement* source = gst_element_factory_make("filesrc", nullptr);
  GstElement* decoder = gst_element_factory_make("decodebin", nullptr);
  GstElement* convert = gst_element_factory_make("videoconvert", nullptr);
  g_object_set(source, "location", picture.path.c_str(), nullptr);
  gst_bin_add_many(bin, source, decoder, convert, nullptr);
  gst_element_link(source, decoder);
  gst_element_link(convert, concat);
  g_autoptr(GstPad) sink = gst_element_get_static_pad(convert, "sink");
  g_signal_connect(decoder, "deep-element-added", G_CALLBACK(decode_exactly), nullptr);
  g_signal_connect_object(decoder, "pad-added", G_CALLBACK(link_decoded), sink, G_CONNECT_DEFAULT);
}

inline GstElement* make_pipeline(const Options& options, const std::vector<Picture>& pictures) {
  GstElement* pipeline = gst_pipeline_new(nullptr);
  GstElement* concat = gst_element_factory_make("concat", nullptr);
  GstElement* filter = gst_element_factory_make("capsfilter", nullptr);
  GstElement* calibrate = gst_element_factory_make("calibrate", nullptr);
  GstElement* sink = gst_element_factory_make("fakesink", nullptr);
  if (concat == nullptr || calibrate == nullptr) {
    fmt::print(stderr, "the element {} is missing: is GST_PLUGIN_PATH set?\n",
               concat == nullptr ? "concat" : "calibrate");
    return nullptr;
  }
  g_autoptr(GstCaps) gray = gst_caps_from_string("video/x-raw,format=GRAY8");
  g_object_set(filter, "caps", gray, nullptr);
  g_object_set(calibrate, "board", options.board.c_str(), "model", options.model.c_str(),
               "location", options.location().c_str(), "overlay", FALSE, "post-messages", TRUE,
               nullptr);
  if (!options.fix.empty()) g_object_set(calibrate, "fix", options.fix.c_str(), nullptr);
  if (!options.initial.empty())
    g_object_set(calibrate, "initial", options.initial.c_str(), nullptr);
  // Pictures wait for the detector, and every board counts.
  gst_util_set_object_arg(G_OBJECT(calibrate), "mode", "sync");
  gst_util_set_object_arg(G_OBJECT(calibrate), "capture-mode", "all");
  gst_bin_add_many(GST_BIN(pipeline), concat, filter, calibrate, sink, nullptr);
  gst_element_link_many(concat, filter, calibrate, sink, nullptr);
  for (const Picture& picture : pictures) add_picture(GST_BIN(pipeline), concat, picture);
  g_autoptr(GstPad) out = gst_element_get_static_pad(filter, "src");
  gst_pad_add_probe(out, GST_PAD_PROBE_TYPE_BUFFER, set_time, g_new0(guint64, 1), g_free);
  return pipeline;
}

// Why a picture without a board is none, and what to do.
inline std::string words_for(const GstStructure* detection, const std::string& board) {
  const char* reason = gst_structure_get_string(detection, "reason");
  const char* seen = gst_structure_get_string(detection, "seen");
  if (seen != nullptr) {
    return fmt::format("it shows a board of {} inner corners, and {} is looked for: see --board.",
                       seen, board);
  }
  if (reason != nullptr && g_str_equal(reason, "wrong-board")) {
    return fmt::format("it shows another board than {}: see --board.", board);
  }
  return "no board was found: all of it in the picture, sharp and evenly lit?";
}

inline void look_at(const GstStructure* s, const std::vector<Picture>& pictures,
                    const std::string& board, Outcome& outcome) {
  int index = 0;
  guint64 time = 0;
  gst_structure_get(s, "index", G_TYPE_INT, &index, nullptr);
  if (!gst_structure_get_uint64(s, "timestamp", &time)) return;
  const std::size_t picture = picture_at(time);
  if (picture >= pictures.size()) return;
  int points = 0;
  gst_structure_get_int(s, "points", &points);
  if (points > 0) outcome.corners[picture] += points;
  if (points == 0 && index == 0) outcome.reasons[picture] = words_for(s, board);
  fmt::print("{}/{} {}: {} corners ({})\n", picture + 1, pictures.size(), pictures[picture].name(),
             points, gst_structure_get_string(s, "reason"));
  std::fflush(stdout);
}

// A view that was found and is not taken.
inline void refuse(const GstStructure* s, Outcome& outcome) {
  gboolean accepted = TRUE;
  guint64 time = 0;
  gst_structure_get_boolean(s, "accepted", &accepted);
  const char* reason = gst_structure_get_string(s, "reason");
  if (accepted || reason == nullptr || !gst_structure_get_uint64(s, "timestamp", &time)) return;
  const bool outlier = g_str_equal(reason, "outlier");
  outcome.reasons[picture_at(time)] =
      outlier ? "its corners contradict those of the others: look for a bent board, blur, or "
                "another camera."
              : fmt::format("its board is {}.", reason);
}

inline void take_result(const GstStructure* s, Outcome& outcome) {
  const char* json = gst_structure_get_string(s, "json");
  if (json == nullptr) return;
  if (auto calibration = calvin::parse_calibration(json, "the result")) {
    outcome.calibration = *std::move(calibration);
  }
}

// What the elements say, until the end. `board` is what is looked for.
inline Outcome run(GstElement* pipeline, const std::vector<Picture>& pictures,
                   const std::string& board) {
  Outcome outcome;
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (bool done = false; !done;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
    const GstStructure* s = gst_message_get_structure(message);
    g_autoptr(GError) error = nullptr;
    switch (GST_MESSAGE_TYPE(message)) {
      case GST_MESSAGE_ELEMENT:
        if (gst_structure_has_name(s, "calib-detection")) look_at(s, pictures, board, outcome);
        if (gst_structure_has_name(s, "calib-view")) refuse(s, outcome);
        if (gst_structure_has_name(s, "calib-result")) take_result(s, outcome);
        break;
      case GST_MESSAGE_WARNING:
        gst_message_parse_warning(message, &error, nullptr);
        fmt::print(stderr, "{}\n", error->message);
        break;
      case GST_MESSAGE_ERROR:
        gst_message_parse_error(message, &error, nullptr);
        fmt::print(stderr, "{}\n", error->message);
        done = true;
        break;
      case GST_MESSAGE_EOS:
        outcome.good = done = true;
        break;
      default:
        break;
    }
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  return outcome;
}

}  // namespace calibrate_images
