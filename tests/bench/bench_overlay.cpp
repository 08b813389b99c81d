// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a frame costs that caliboverlay draws on, beside gst_video_overlay_composition_blend() of
// the same drawing made beforehand. Needs GST_PLUGIN_PATH_1_0.

// Before GStreamer's headers.
#include "overlay/video_blend.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "calvin/draw/overlay.hpp"
#include "common/metas.hpp"
#include "overlay/caption.hpp"
#include "overlay/labels.hpp"
#include "ratio_reporter.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>
#include <gst/video/video-overlay-composition.h>

namespace {

using namespace calvin;

constexpr int kFrames = 16;

struct Size {
  const char* name;
  ImageSize size;
};
constexpr Size kSizes[] = {{"720p", {1280, 720}}, {"1080p", {1920, 1080}}, {"4K", {3840, 2160}}};

// A session under way: everything that the overlay can show at once, and a board that moves.
class Scenes {
 public:
  Scenes(ImageSize size, const char* board) : size_(size) {
    check::Scene scene{.size = size};
    scene.board = parse_board(board).value();
    scene.motion = Motion(MotionKind::kHand, scene.camera, scene.board, 1);
    for (int n = 0; n < kFrames; ++n) boards_.push_back({scene.truth(n)});
    progress_.views = 12;
    progress_.coverage = 0.6;
    progress_.x = 0.8;
    progress_.y = 0.5;
    progress_.size = 0.4;
    progress_.tilt = 0.7;
    progress_.expected_error = 0.18;
    progress_.expected_error_anywhere = 2.4;
    progress_.hint = "Hold the board where the outline is, and tilt its left side away.";
    progress_.ghost = {{0.55, 0.3}, {0.85, 0.35}, {0.82, 0.75}, {0.52, 0.7}};
    progress_.ghost_share = 0.2;
    progress_.coverage_map.columns = 32;
    for (int i = 0; i < 32 * 24; ++i) progress_.coverage_map.covered.push_back(i % 7 < 4);
    progress_.parameters = {{"focal length", 0.8}, {"principal point", 0.5}, {"distortion", 1}};
  }

  [[nodiscard]] ImageSize size() const { return size_; }
  void attach(GstBuffer* buffer, int n) const {
    gst::attach_observations(buffer, boards_[static_cast<std::size_t>(n % kFrames)]);
    gst::attach_guidance(buffer, progress_);
  }

  // The drawing of a frame as another program would hand it to libgstvideo.
  [[nodiscard]] GstVideoOverlayComposition* composition(int n) const {
    const OverlayParts parts{.words = gst::Labels::can_draw()};
    auto tiles =
        draw_overlay(size_, boards_[static_cast<std::size_t>(n)], progress_, parts).value();
    gst::Labels panel_words{gst::Labels::Tiles::kOne};
    gst::Caption caption;
    for (const OverlayTile& tile :
         panel_words.draw(overlay_panel_words(size_, progress_, parts.panel), size_)) {
      tiles.push_back(tile);
    }
    if (const OverlayTile* words = caption.draw(
            {overlay_caption(progress_), size_, {0, size_.width}}, gst::Caption::Place::kBottom)) {
      tiles.push_back(*words);
    }
    GstVideoOverlayComposition* composition = gst_video_overlay_composition_new(nullptr);
    for (const OverlayTile& tile : tiles) add(composition, tile);
    return composition;
  }

 private:
  static void add(GstVideoOverlayComposition* composition, const OverlayTile& tile) {
    GstBuffer* pixels = gst_buffer_new_memdup(tile.pixels.data(), tile.pixels.size());
    const auto width = static_cast<guint>(tile.width);
    const auto height = static_cast<guint>(tile.height);
    gst_buffer_add_video_meta(pixels, GST_VIDEO_FRAME_FLAG_NONE,
                              GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB, width, height);
    GstVideoOverlayRectangle* rectangle = gst_video_overlay_rectangle_new_raw(
        pixels, tile.x, tile.y, width, height, GST_VIDEO_OVERLAY_FORMAT_FLAG_PREMULTIPLIED_ALPHA);
    gst_video_overlay_composition_add_rectangle(composition, rectangle);
    gst_video_overlay_rectangle_unref(rectangle);
    gst_buffer_unref(pixels);
  }

  ImageSize size_;
  std::vector<std::vector<Observation>> boards_;
  Progress progress_;
};

GstBuffer* grey_frame(const GstVideoInfo& info) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  gst_buffer_memset(buffer, 0, 100, info.size);
  return buffer;
}

GstVideoInfo info_of(const char* format, ImageSize size) {
  GstVideoInfo info;
  g_autoptr(GstCaps) caps = check::caps_of(format, size);
  gst_video_info_from_caps(&info, caps);
  return info;
}

// One buffer goes round, whose memory is ours alone: nothing is copied. Frames before the first one
// that counts draw what does not change, as libgstvideo has it beforehand.
void element(benchmark::State& state, const Scenes& scenes, const char* format, bool moving) {
  GstHarness* h = gst_harness_new("caliboverlay");
  gst_harness_set_src_caps(h, check::caps_of(format, scenes.size()));
  GstBuffer* buffer = grey_frame(info_of(format, scenes.size()));
  int n = 0;
  const auto prepare = [&] {
    scenes.attach(buffer, moving ? n : 0);
    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(static_cast<guint64>(n++), GST_SECOND, 30);
  };
  while (n < kFrames) {
    prepare();
    buffer = gst_harness_push_and_pull(h, buffer);
  }
  for (auto _ : state) {
    state.PauseTiming();
    prepare();
    state.ResumeTiming();
    buffer = gst_harness_push_and_pull(h, buffer);
  }
  gst_buffer_unref(buffer);
  gst_harness_teardown(h);
}

void peer(benchmark::State& state, const Scenes& scenes, const char* format) {
  std::vector<GstVideoOverlayComposition*> drawings;
  for (int n = 0; n < kFrames; ++n) drawings.push_back(scenes.composition(n));
  const GstVideoInfo info = info_of(format, scenes.size());
  GstBuffer* buffer = grey_frame(info);
  std::size_t n = 0;
  for (auto _ : state) {
    GstVideoFrame frame;
    gst_video_frame_map(&frame, &info, buffer, GST_MAP_READWRITE);
    gst_video_overlay_composition_blend(drawings[n++ % drawings.size()], &frame);
    gst_video_frame_unmap(&frame);
  }
  gst_buffer_unref(buffer);
  for (GstVideoOverlayComposition* drawing : drawings) {
    gst_video_overlay_composition_unref(drawing);
  }
}

template <typename Run>
void add(const std::string& name, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  gst::register_metas();
  bench::initialize_interleaved(argc, argv);
  for (const Size& size : kSizes) {
    const auto scenes = std::make_shared<Scenes>(size.size, "checkerboard:9x6:25mm");
    const auto many = std::make_shared<Scenes>(size.size, "checkerboard:14x10:20mm");
    for (const char* format : {"NV12", "I420", "BGRx", "RGB"}) {
      const std::string name = std::string(format) + " " + size.name + "|";
      add(name + "calvin", [=](benchmark::State& s) { element(s, *scenes, format, true); });
      add(name + "calvin, 140 corners",
          [=](benchmark::State& s) { element(s, *many, format, true); });
      add(name + "calvin, a board at rest",
          [=](benchmark::State& s) { element(s, *scenes, format, false); });
      add(name + "libgstvideo, blending alone",
          [=](benchmark::State& s) { peer(s, *scenes, format); });
    }
  }
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
