// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// before.png and after.png: the first picture of the result as it is and undistorted.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <gst/gst.h>

#include "calibrate_images_feed.hpp"
#include "calibrate_images_own.hpp"
#include "calibrate_images_run.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/result.hpp"

namespace calibrate_images {

inline constexpr const char* kBefore = "before.png";
inline constexpr const char* kAfter = "after.png";

// Before the work: whether the pair can be written to the folder, and replaces nothing but a pair
// of an earlier run.
inline calvin::Status check_pair(const std::filesystem::path& output) {
  for (const char* name : {kBefore, kAfter}) {
    const std::filesystem::path file = output / name;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(file, ignored) && !is_own(file)) {
      return calvin::make_error(
          calvin::ErrorCode::kInvalidArgument,
          fmt::format("There is a {} in the folder {} that this program did not make, and its own "
                      "would replace it: rename it, or give --output another folder.",
                      name, output.string()));
    }
    if (calvin::Status writable = calvin::check_writable(file.string()); !writable) {
      return writable;
    }
  }
  return {};
}

inline void append(GstElement* /*sink*/, GstBuffer* buffer, GstPad* /*pad*/, gpointer bytes) {
  GstMapInfo map;
  if (gst_buffer_map(buffer, &map, GST_MAP_READ) == FALSE) return;
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(map.data), map.size);
  gst_buffer_unmap(buffer, &map);
}

// A picture as PNG, undistorted where a calibration is given; empty where it failed, which is said.
inline std::string draw(const std::filesystem::path& picture, const std::string& calibration) {
  g_autoptr(GstElement) pipeline = gst_pipeline_new(nullptr);
  GstElement* feed = make_feed({picture});
  GstElement* change =
      gst_element_factory_make(calibration.empty() ? "identity" : "calibundistort", nullptr);
  GstElement* convert = gst_element_factory_make("videoconvert", nullptr);
  GstElement* encode = gst_element_factory_make("pngenc", nullptr);
  GstElement* sink = gst_element_factory_make("fakesink", nullptr);
  std::string png;
  if (!calibration.empty()) {
    g_object_set(change, "calibration", calibration.c_str(), nullptr);
  }
  g_object_set(sink, "signal-handoffs", TRUE, nullptr);
  g_signal_connect(sink, "handoff", G_CALLBACK(append), &png);
  gst_bin_add_many(GST_BIN(pipeline), feed, change, convert, encode, sink, nullptr);
  gst_element_link_many(feed, change, convert, encode, sink, nullptr);
  const Outcome outcome = run(pipeline, {}, "");
  for (const auto& [index, why] : outcome.reasons) leave_out(picture, why);
  return outcome.good ? png : "";
}

inline bool draw_pair(const Options& options, const std::filesystem::path& picture) {
  for (const bool undistort : {false, true}) {
    const char* name = undistort ? kAfter : kBefore;
    std::string png = draw(picture, undistort ? options.location() : "");
    if (png.empty()) return false;
    mark_as_own(png);
    const calvin::Status written = calvin::write_file((options.output / name).string(), png);
    if (!written) {
      fmt::print(stderr, "{}\n", written.error().message);
      return false;
    }
  }
  return true;
}

}  // namespace calibrate_images
