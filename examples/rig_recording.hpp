// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig: a file that a camera has recorded, and the boards in its frames, one after the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gst/app/gstappsink.h>
#include <gst/gst.h>
#include <gst/video/video.h>

#include "calvin/core/result.hpp"
#include "calvin/detect/detector.hpp"

#include "decoding.hpp"

namespace rig_recording {

// Whether a file is one of pictures, of whatever kind, and no text, as observations are.
inline bool is_video(const std::string& path) {
  constexpr std::string_view kRaw = "YUV4MPEG2";  // its frames come behind a line of text
  std::string start(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return start.starts_with(kRaw) || start.find('\0') != std::string::npos;
}

// Why a file will not do, and what to do.
inline std::string words_for(const std::string& path, std::string_view why) {
  const bool is_text = why == decoding::kText;
  return fmt::format(
      "'{}' is no video that can be decoded ({}): give one that gst-play-1.0 shows (H.264 and "
      "H.265 "
      "need the package gstreamer1.0-libav), a folder of pictures or a file of observations.",
      path, is_text ? "it is a text" : why);
}

// The frames of a file, decoded as they are asked for.
class Video {
 public:
  // An error where the file has no frame.
  static calvin::Result<std::unique_ptr<Video>> open(const std::string& path,
                                                     std::span<const calvin::Board> boards) {
    auto detector = calvin::make_detector(boards);
    if (!detector) return tl::unexpected(detector.error());
    std::unique_ptr<Video> video(new Video(path, *std::move(detector)));
    std::string why = decoding::preroll(video->pipeline_, video->type_);
    if (why.empty()) {
      gst_element_set_state(video->pipeline_, GST_STATE_PLAYING);
      video->next_ = video->pull();
      why = video->broken_.empty() ? "it has no frames" : video->broken_;
    }
    if (video->next_) {
      const GstClockTime first = GST_BUFFER_PTS(gst_sample_get_buffer(video->next_.get()));
      video->first_ = GST_CLOCK_TIME_IS_VALID(first) ? first : 0;
      return video;
    }
    return calvin::make_error(calvin::ErrorCode::kMalformed, words_for(path, why));
  }
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;
  ~Video() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(sink_);
    gst_object_unref(pipeline_);
  }

  // The boards in the frames before a time, ns, that were not asked for yet.
  std::vector<calvin::Observation> until(std::uint64_t end) {
    std::vector<calvin::Observation> seen;
    for (; next_; next_ = pull()) {
      const std::uint64_t time = time_of(next_.get());
      if (time != calvin::kNoTimestamp && time >= end) break;
      look_at(next_.get(), time, seen);
    }
    return seen;
  }
  [[nodiscard]] bool is_over() const { return next_ == nullptr; }
  [[nodiscard]] bool has_seen_boards() const { return with_board_ > 0; }

  // ns: what the file says of the time of its first frame. Of no meaning by itself.
  [[nodiscard]] std::uint64_t first_time() const { return first_; }

  // "1800 frames of 60.0 s, boards in 1500 of them", and what was wrong with the file.
  [[nodiscard]] std::string summary() const {
    std::string text = fmt::format("{} frames of {:.1f} s, boards in {} of them", frames_,
                                   1e-9 * static_cast<double>(last_.value_or(0)), with_board_);
    if (untimed_ > 0)
      text += fmt::format(", {} have no time that goes on, and do not count", untimed_);
    if (!broken_.empty()) text += fmt::format("; it cannot be decoded any further ({})", broken_);
    return text;
  }

 private:
  Video(const std::string& path, std::unique_ptr<calvin::Detector> detector)
      : detector_(std::move(detector)), pipeline_(decoding::make_decoder(path, type_)) {
    sink_ = gst_bin_get_by_name(GST_BIN(pipeline_), "picture");
    g_object_set(sink_, "max-buffers", 4, nullptr);  // some are decoded beside the search
  }

  // Nothing at the end of the file, and where it cannot be decoded any further.
  decoding::Sample pull() {
    constexpr GstClockTime kStep = GST_SECOND / 5;
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
    for (GstClockTime waited = 0; waited < decoding::kPatience; waited += kStep) {
      decoding::Sample sample(gst_app_sink_try_pull_sample(GST_APP_SINK(sink_), kStep));
      g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
      if (message != nullptr) {
        g_autoptr(GError) error = nullptr;
        gst_message_parse_error(message, &error, nullptr);
        broken_ = error->message;
      }
      if (sample || !broken_.empty() || gst_app_sink_is_eos(GST_APP_SINK(sink_)) != FALSE) {
        return sample;
      }
    }
    broken_ = "no frame has come for 10 s";
    return nullptr;
  }

  // ns after the beginning of the file.
  static std::uint64_t time_of(GstSample* sample) {
    static_assert(calvin::kNoTimestamp == GST_CLOCK_TIME_NONE);
    const std::uint64_t time =
        gst_segment_to_running_time(gst_sample_get_segment(sample), GST_FORMAT_TIME,
                                    GST_BUFFER_PTS(gst_sample_get_buffer(sample)));
    GstVideoInfo info;
    const bool is_known = time != calvin::kNoTimestamp &&
                          gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) != FALSE;
    return is_known ? unrounded(time, info.fps_n, info.fps_d) : time;
  }

  // Matroska rounds times to milliseconds, in which a board moves by a tenth of a pixel and more:
  // where they are those of an even rate, rounded, that rate tells them exactly.
  static std::uint64_t unrounded(std::uint64_t time, int fps_n, int fps_d) {
    constexpr std::uint64_t kMillisecond = 1'000'000;  // ns
    if (fps_n <= 0 || fps_d <= 0 || time % kMillisecond != 0) return time;
    const auto rate = static_cast<std::uint64_t>(fps_n);
    const std::uint64_t second = GST_SECOND * static_cast<std::uint64_t>(fps_d);
    const std::uint64_t even =
        gst_util_uint64_scale(gst_util_uint64_scale_round(time, rate, second), second, rate);
    const std::uint64_t off = even > time ? even - time : time - even;
    return off <= kMillisecond ? even : time;
  }

  void look_at(GstSample* sample, std::uint64_t time, std::vector<calvin::Observation>& seen) {
    ++frames_;
    if (time == calvin::kNoTimestamp || (last_ && time <= *last_)) {
      ++untimed_;
      return;
    }
    last_ = time;
    GstVideoInfo info;
    GstVideoFrame frame;
    if (gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) == FALSE) return;
    if (gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ) == FALSE) {
      return;
    }
    const calvin::ImageView image = {
        static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&frame, 0)),
        GST_VIDEO_FRAME_WIDTH(&frame), GST_VIDEO_FRAME_HEIGHT(&frame),
        GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0), 1};
    bool any = false;
    for (calvin::Detection& found : detector_->follow_all(image, time)) {
      if (found.reason != calvin::Reason::kAccepted) continue;
      found.observation.image_size = {image.width, image.height};
      found.observation.timestamp = time;
      seen.push_back(std::move(found.observation));
      any = true;
    }
    with_board_ += any ? 1 : 0;
    gst_video_frame_unmap(&frame);
  }

  std::unique_ptr<calvin::Detector> detector_;
  std::string type_;
  GstElement* pipeline_;
  GstElement* sink_ = nullptr;
  decoding::Sample next_;  // that is not looked at yet
  std::string broken_;
  std::uint64_t first_ = 0;            // ns
  std::optional<std::uint64_t> last_;  // ns
  std::size_t frames_ = 0;
  std::size_t untimed_ = 0;
  std::size_t with_board_ = 0;
};

}  // namespace rig_recording
