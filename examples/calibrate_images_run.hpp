// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pictures through one pipeline, one after the other, and what its elements say of each.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gst/gst.h>

#include "calibrate_images_feed.hpp"
#include "calibrate_images_folder.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/io/calibration_io.hpp"

namespace calibrate_images {

struct Options {
  std::string board = "checkerboard:9x6:25mm";
  std::string model = "brown5";
  std::string fix;
  std::string initial;
  std::string exports;
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
  std::set<std::size_t> seen;  // it was looked for boards in them
  std::map<std::size_t, int> corners;
  std::map<std::size_t, std::string> reasons;
  std::optional<calvin::Calibration> calibration;
};

inline std::vector<std::filesystem::path> paths_of(const std::vector<Picture>& pictures) {
  std::vector<std::filesystem::path> paths;
  for (const Picture& picture : pictures) paths.push_back(picture.path);
  return paths;
}

// Whether every element is there that this program makes; the one that is not is named.
inline bool check_elements() {
  for (const char* name : {"appsrc", "appsink", "filesrc", "decodebin", "videoconvert", "queue",
                           "calibrate", "calibundistort", "pngenc", "identity", "fakesink"}) {
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(name);
    if (factory == nullptr) {
      fmt::print(stderr, "the element {} is missing: is GST_PLUGIN_PATH set?\n", name);
      return false;
    }
  }
  return true;
}

inline GstElement* make_pipeline(const Options& options, const std::vector<Picture>& pictures) {
  GstElement* pipeline = gst_pipeline_new(nullptr);
  GstElement* feed = make_feed(paths_of(pictures));
  GstElement* queue = gst_element_factory_make("queue", nullptr);  // one is decoded beside a search
  GstElement* calibrate = gst_element_factory_make("calibrate", nullptr);
  GstElement* sink = gst_element_factory_make("fakesink", nullptr);
  g_object_set(queue, "max-size-buffers", 1, "max-size-bytes", 0, "max-size-time", guint64{0},
               nullptr);
  g_object_set(calibrate, "board", options.board.c_str(), "model", options.model.c_str(),
               "location", options.location().c_str(), "overlay", FALSE, "post-messages", TRUE,
               "overwrite", TRUE, nullptr);
  if (!options.fix.empty()) g_object_set(calibrate, "fix", options.fix.c_str(), nullptr);
  if (!options.initial.empty())
    g_object_set(calibrate, "initial", options.initial.c_str(), nullptr);
  if (!options.exports.empty()) g_object_set(calibrate, "export", options.exports.c_str(), nullptr);
  // Pictures wait for the detector, and every board counts.
  gst_util_set_object_arg(G_OBJECT(calibrate), "mode", "sync");
  gst_util_set_object_arg(G_OBJECT(calibrate), "capture-mode", "all");
  gst_bin_add_many(GST_BIN(pipeline), feed, queue, calibrate, sink, nullptr);
  gst_element_link_many(feed, queue, calibrate, sink, nullptr);
  return pipeline;
}

// Why a picture without a board is none, and what to do.
inline std::string words_for(const GstStructure* detection, const std::string& board) {
  const char* reason = gst_structure_get_string(detection, "reason");
  const char* seen = gst_structure_get_string(detection, "seen");
  const char* hint = gst_structure_get_string(detection, "hint");
  if (seen != nullptr && board.starts_with("checkerboard")) {
    return fmt::format("it shows a board of {} inner corners, and {} is looked for: see --board.",
                       seen, board);
  }
  if (reason != nullptr && g_str_equal(reason, "wrong-board")) {
    if (hint != nullptr) return fmt::format("{}: see --board.", hint);
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
  outcome.seen.insert(picture);
  int points = 0;
  gst_structure_get_int(s, "points", &points);
  if (points > 0) outcome.corners[picture] += points;
  if (points == 0 && index == 0) outcome.reasons[picture] = words_for(s, board);
  fmt::print("{}/{} {}: {} corners ({})\n", picture + 1, pictures.size(), pictures[picture].name(),
             points, gst_structure_get_string(s, "reason"));
  std::fflush(stdout);
}

// Of a picture whose corners are no outliers, and not those of a view.
inline constexpr const char* kNothingNew =
    "it tells nothing that the others do not: it is a copy of one of them, or one of very many.";

// A view that was found and is not taken. The element posts this for the first of several in a row
// alone.
inline void refuse(const GstStructure* s, Outcome& outcome) {
  gboolean accepted = TRUE;
  guint64 time = 0;
  gst_structure_get_boolean(s, "accepted", &accepted);
  const char* reason = gst_structure_get_string(s, "reason");
  if (accepted || reason == nullptr || !gst_structure_get_uint64(s, "timestamp", &time)) return;
  std::string& why = outcome.reasons[picture_at(time)];
  if (g_str_equal(reason, "outlier")) {
    why =
        "its corners contradict those of the others: look for a bent board, blur, or another "
        "camera.";
  } else if (g_str_equal(reason, "too-similar")) {
    why = kNothingNew;
  } else if (why.empty()) {  // else look_at() knows why
    why = fmt::format("its board is {}.", reason);
  }
}

// A picture that has changed or gone since it was looked at first.
inline void lose(const GstStructure* s, Outcome& outcome) {
  guint64 index = 0;
  gst_structure_get_uint64(s, "index", &index);
  outcome.reasons[static_cast<std::size_t>(index)] = gst_structure_get_string(s, "why");
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
  std::string said;  // an ERROR at the end may be what a WARNING was before
  for (bool done = false; !done;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop(bus, GST_CLOCK_TIME_NONE);
    const GstStructure* s = gst_message_get_structure(message);
    g_autoptr(GError) error = nullptr;
    switch (GST_MESSAGE_TYPE(message)) {
      case GST_MESSAGE_ELEMENT:
        if (gst_structure_has_name(s, "calib-detection")) look_at(s, pictures, board, outcome);
        if (gst_structure_has_name(s, "calib-view")) refuse(s, outcome);
        if (gst_structure_has_name(s, "calib-result")) take_result(s, outcome);
        if (gst_structure_has_name(s, kLost)) lose(s, outcome);
        break;
      case GST_MESSAGE_WARNING:
        gst_message_parse_warning(message, &error, nullptr);
        said = error->message;
        fmt::print(stderr, "{}\n", said);
        break;
      case GST_MESSAGE_ERROR:
        gst_message_parse_error(message, &error, nullptr);
        if (said != error->message) fmt::print(stderr, "{}\n", error->message);
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
