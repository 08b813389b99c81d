// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// One picture out of one file, by a pipeline that is gone when the picture is there: a folder takes
// the memory, the threads and the file descriptors of a single picture, however many are in it.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include <gst/app/gstappsink.h>
#include <gst/gst.h>

#include "calvin/core/result.hpp"

#include "decoding.hpp"

namespace calibrate_images {

using decoding::kPatience;
using decoding::Sample;

// Whether a second picture follows the first in a stream that is at its first.
inline bool is_movie(GstElement* pipeline, GstAppSink* sink) {
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  const Sample first(gst_app_sink_try_pull_sample(sink, kPatience));
  const Sample second(first ? gst_app_sink_try_pull_sample(sink, kPatience) : nullptr);
  return second != nullptr;
}

// The picture in a file as GRAY8, the first where the file is a still picture with others behind it
// (those of phones have maps of brightness or depth there). An error says why there is none and
// what to do: kUnsupported where it is none at all. A movie is an error, too: which of its frames
// would be meant is not known.
inline calvin::Result<Sample> decode(const std::filesystem::path& file) {
  std::string type;
  GstElement* pipeline = decoding::make_decoder(file, type);
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "picture");
  std::string error = decoding::preroll(pipeline, type);
  Sample sample;
  bool movie = false;
  if (error.empty()) {
    sample.reset(gst_app_sink_try_pull_preroll(GST_APP_SINK(sink), 0));
    const bool still = type.empty() || type.starts_with("image/");
    movie = sample && !still && is_movie(pipeline, GST_APP_SINK(sink));
    error = "there is no picture in it";
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(pipeline);
  if (movie) {
    return calvin::make_error(calvin::ErrorCode::kMalformed,
                              "it is a movie: save those of its frames that show the board sharply "
                              "as PNG or JPEG, or take it away.");
  }
  if (!sample &&
      (error == decoding::kText || type.starts_with("text/") || type.starts_with("application/"))) {
    return calvin::make_error(calvin::ErrorCode::kUnsupported, "it is no picture.");
  }
  if (!sample) {
    return calvin::make_error(
        calvin::ErrorCode::kMalformed,
        "it cannot be decoded (" + error + "): save it again as PNG or JPEG, or take it away.");
  }
  return sample;
}

}  // namespace calibrate_images
