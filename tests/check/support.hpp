// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the element tests share: a bus that remembers, rendered frames, a temporary folder.
// Include it before gstcheck.h, which defines the macro `fail`.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/board.hpp"
#include "common/metas.hpp"

namespace calvin::check {

// The messages of one element, in the order of their posting. Keeps none alive beyond the test.
class Bus {
 public:
  explicit Bus(GstElement* element) : element_(element), bus_(gst_bus_new()) {
    gst_element_set_bus(element, bus_);
  }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus() {
    for (GstMessage* message : messages_) gst_message_unref(message);
    gst_bus_set_flushing(bus_, TRUE);
    gst_object_unref(bus_);
  }
  // Before the element goes.
  void detach() { gst_element_set_bus(element_, nullptr); }

  const std::vector<GstMessage*>& messages() {
    while (GstMessage* message = gst_bus_pop(bus_)) messages_.push_back(message);
    return messages_;
  }
  // The structures of the element messages of that name.
  std::vector<const GstStructure*> named(const char* name) {
    std::vector<const GstStructure*> found;
    for (GstMessage* message : messages()) {
      const GstStructure* s = gst_message_get_structure(message);
      if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT && gst_structure_has_name(s, name)) {
        found.push_back(s);
      }
    }
    return found;
  }
  // The texts of all errors, warnings or infos.
  std::vector<std::string> texts(GstMessageType type) {
    std::vector<std::string> found;
    for (GstMessage* message : messages()) {
      if (GST_MESSAGE_TYPE(message) != type) continue;
      g_autoptr(GError) error = nullptr;
      if (type == GST_MESSAGE_ERROR) gst_message_parse_error(message, &error, nullptr);
      if (type == GST_MESSAGE_WARNING) gst_message_parse_warning(message, &error, nullptr);
      if (type == GST_MESSAGE_INFO) gst_message_parse_info(message, &error, nullptr);
      if (error != nullptr) found.emplace_back(error->message);
    }
    return found;
  }
  bool says(GstMessageType type, const char* part) {
    for (const std::string& text : texts(type)) {
      if (text.find(part) != std::string::npos) return true;
    }
    return false;
  }

 private:
  GstElement* element_;
  GstBus* bus_;
  std::vector<GstMessage*> messages_;
};

// An element from "NAME PROPERTY=VALUE ...", without the bin that gst_parse_launch() would put
// around it; floating.
inline GstElement* make_element(const std::string& text) {
  const auto words = split(text, ' ');
  GstElement* element = gst_element_factory_make(std::string(words.front()).c_str(), nullptr);
  g_assert_nonnull(element);
  for (const std::string_view word : std::span(words).subspan(1)) {
    if (word.empty()) continue;
    const auto equals = word.find('=');
    gst_util_set_object_arg(G_OBJECT(element), std::string(word.substr(0, equals)).c_str(),
                            std::string(word.substr(equals + 1)).c_str());
  }
  return element;
}

// A harness around an element of make_element(), which goes with it.
inline GstHarness* harness_of(GstElement* element) {
  GstHarness* harness = gst_harness_new_with_element(element, "sink", "src");
  gst_object_unref(element);
  return harness;
}

// The texts of the errors that an element posts when it cannot start; empty where it can. The
// element goes.
inline std::vector<std::string> errors_at_start(GstElement* element) {
  gst_object_ref_sink(element);
  std::vector<std::string> texts;
  {
    Bus bus(element);
    const bool failed =
        gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE;
    if (failed) texts = bus.texts(GST_MESSAGE_ERROR);
    bus.detach();
  }
  gst_element_set_state(element, GST_STATE_NULL);
  gst_object_unref(element);
  return texts;
}
inline std::vector<std::string> errors_at_start(const char* factory, const char* property,
                                                const char* value) {
  GstElement* element = gst_element_factory_make(factory, nullptr);
  gst_util_set_object_arg(G_OBJECT(element), property, value);
  return errors_at_start(element);
}

// The n-th pose of one synthetic session.
struct Scene {
  ImageSize size = {640, 480};
  Camera camera = default_camera(size);
  Board board = *parse_board(kDefaultBoard);
  Motion motion{MotionKind::kRandom, camera, board, 1};

  [[nodiscard]] SE3 pose(int n) const { return motion.camera_from_board(n); }
  [[nodiscard]] Observation truth(int n) const { return true_observation(camera, board, pose(n)); }
  [[nodiscard]] GrayImage picture(int n, double noise = 1) const {
    RenderOptions options;
    options.noise = noise;
    options.blur = 0.7;
    options.seed = static_cast<std::uint64_t>(n);
    return render_board(camera, board, pose(n), options);
  }
};

// Copies what fits of one picture into another, its top left pixel to (x, y).
inline void paste(const GrayImage& from, GrayImage& to, int x, int y) {
  const int columns = std::min(from.width, to.width - x);
  for (int row = 0; row < std::min(from.height, to.height - y); ++row) {
    std::copy_n(from.pixels.data() + static_cast<std::ptrdiff_t>(row) * from.width, columns,
                to.row(y + row) + x);
  }
}

inline GstCaps* caps_of(const char* format, ImageSize size) {
  return gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, format, "width", G_TYPE_INT,
                             size.width, "height", G_TYPE_INT, size.height, "framerate",
                             GST_TYPE_FRACTION, 30, 1, nullptr);
}

// A grey picture as a frame of any format, converted by GStreamer itself; the n-th of 30 a second.
inline GstBuffer* frame_of(const GrayImage& image, const char* format, int n) {
  GstVideoInfo gray;
  GstVideoInfo wanted;
  const auto width = static_cast<guint>(image.width);
  const auto height = static_cast<guint>(image.height);
  gst_video_info_set_format(&gray, GST_VIDEO_FORMAT_GRAY8, width, height);
  gst_video_info_set_format(&wanted, gst_video_format_from_string(format), width, height);
  g_autoptr(GstBuffer) from = gst_buffer_new_allocate(nullptr, gray.size, nullptr);
  GstBuffer* to = gst_buffer_new_allocate(nullptr, wanted.size, nullptr);
  GstVideoFrame in;
  GstVideoFrame out;
  gst_video_frame_map(&in, &gray, from, GST_MAP_WRITE);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&in, 0)) +
                    static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&in, 0),
                image.pixels.data() + static_cast<std::ptrdiff_t>(y) * image.width, width);
  }
  gst_video_frame_map(&out, &wanted, to, GST_MAP_WRITE);
  GstVideoConverter* converter = gst_video_converter_new(&gray, &wanted, nullptr);
  gst_video_converter_frame(converter, &in, &out);
  gst_video_converter_free(converter);
  gst_video_frame_unmap(&in);
  gst_video_frame_unmap(&out);
  GST_BUFFER_PTS(to) = gst_util_uint64_scale(static_cast<guint64>(n), GST_SECOND, 30);
  GST_BUFFER_DURATION(to) = GST_SECOND / 30;
  return to;
}

// Every raw format whose pixels are in memory, unlike DMA_DRM and its like.
inline std::vector<std::string> raw_formats() {
  guint count = 0;
  const GstVideoFormat* formats = gst_video_formats_raw(&count);
  std::vector<std::string> names;
  for (guint i = 0; i < count; ++i) {
    const GstVideoFormatInfo* info = gst_video_format_get_info(formats[i]);
    if (info->unpack_func != nullptr) names.emplace_back(GST_VIDEO_FORMAT_INFO_NAME(info));
  }
  return names;
}

// Those of them whose values have others between them, without two that GStreamer 1.24 packs
// wrongly (see CALVIN_PLANE_FORMATS_1_24).
inline std::vector<std::string> formats_without_palette() {
  std::vector<std::string> names = raw_formats();
  std::erase_if(names, [](const std::string& name) {
    if (name == "MT2110T" || name == "MT2110R") return true;
    const auto format = gst_video_format_from_string(name.c_str());
    return GST_VIDEO_FORMAT_INFO_HAS_PALETTE(gst_video_format_get_info(format)) != 0;
  });
  return names;
}

// A folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    g_autofree char* path = g_dir_make_tmp("calvin-XXXXXX", nullptr);
    path_ = path;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::string operator/(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

}  // namespace calvin::check
