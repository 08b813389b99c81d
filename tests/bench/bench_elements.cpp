// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the elements cost the streaming thread, beside `identity`, which does nothing, and the
// elements of GStreamer that do the same work. Needs GST_PLUGIN_PATH_1_0.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "ratio_reporter.hpp"
#include "support.hpp"

#include <gst/check/gstharness.h>

namespace {

using namespace calvin;

constexpr int kFrames = 8;
constexpr ImageSize kFullHd = {1920, 1080};
constexpr ImageSize kUhd = {3840, 2160};
constexpr const char* kCamera =
    "calibration=fx=2304,fy=2304,cx=1926.8,cy=1075.4,k1=-0.3,k2=0.1,width=3840,height=2160";

// A board that a hand moves before the camera, rendered beforehand.
class Frames {
 public:
  Frames(const char* format, ImageSize size) : format_(format), size_(size) {
    const check::Scene scene{.size = size};
    for (int n = 0; n < kFrames; ++n) {
      buffers_.push_back(check::frame_of(scene.picture(n), format, n));
    }
  }
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;
  ~Frames() {
    for (GstBuffer* buffer : buffers_) gst_buffer_unref(buffer);
  }

  [[nodiscard]] GstCaps* caps() const { return check::caps_of(format_, size_); }
  // The n-th of an endless stream.
  [[nodiscard]] GstBuffer* frame(int n) const {
    GstBuffer* buffer = gst_buffer_copy(buffers_[static_cast<std::size_t>(n % kFrames)]);
    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(static_cast<guint64>(n), GST_SECOND, 30);
    return buffer;
  }

 private:
  const char* format_;
  ImageSize size_;
  std::vector<GstBuffer*> buffers_;
};

using Change = void (*)(GstHarness* h, int n);

// Before a frame: a camera sends it when the worker has long been ready again.
void wait_for_a_camera(GstHarness* /*h*/, int /*n*/) { g_usleep(15000); }

void turn(GstHarness* h, int n) {
  GstElement* element = gst_harness_find_element(h, "calibundistort");
  g_object_set(element, "pan", 0.01 * (n % 500), nullptr);
  gst_object_unref(element);
}

// CPU time of the thread that pushes, per frame.
void stream(benchmark::State& state, const Frames& frames, const std::string& launch,
            Change before) {
  GstHarness* h = gst_harness_new_parse(launch.c_str());
  gst_harness_set_src_caps(h, frames.caps());
  int n = 0;
  for (auto _ : state) {
    state.PauseTiming();
    GstBuffer* in = frames.frame(n);
    if (before != nullptr) before(h, n);
    ++n;
    state.ResumeTiming();
    GstBuffer* out = gst_harness_push_and_pull(h, in);
    if (out == nullptr) {
      state.SkipWithError("no frame came out");
      break;
    }
    gst_buffer_unref(out);
  }
  gst_harness_teardown(h);
}

struct Subject {
  const char* name;
  std::string launch;
  Change before = nullptr;
  bool all_threads = false;
};

void register_case(const std::string& name, const char* format, ImageSize size,
                   const std::vector<Subject>& subjects) {
  const auto frames = std::make_shared<Frames>(format, size);
  for (const Subject& subject : subjects) {
    auto* benchmark =
        benchmark::RegisterBenchmark((name + "|" + subject.name).c_str(),
                                     [frames, subject](benchmark::State& state) {
                                       stream(state, *frames, subject.launch, subject.before);
                                     })
            ->Unit(benchmark::kMillisecond);
    if (subject.all_threads) benchmark->MeasureProcessCPUTime();
    // The time counts that passes between frames, too, where a camera is waited for.
    if (subject.before == wait_for_a_camera) benchmark->Iterations(200);
  }
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  bench::initialize_interleaved(argc, argv);
  const std::string convert = "videoconvert n-threads=1";
  for (const char* format : {"GRAY8", "NV12", "RGB"}) {
    register_case(std::string("board, async, 1080p ") + format, format, kFullHd,
                  {{"calvin", "calibdetect mode=async", wait_for_a_camera},
                   {"identity", "identity", wait_for_a_camera}});
    register_case(
        std::string("board, sync, 1080p ") + format, format, kFullHd,
        {{"calvin", "calibdetect mode=sync", nullptr, true},
         {"identity", "identity", nullptr, true},
         {"cameracalibrate",
          convert + " ! video/x-raw,format=RGB ! cameracalibrate delay=0 frame-count=100000 ! " +
              convert,
          nullptr, true}});
  }
  const std::string undistort = std::string("calibundistort ") + kCamera;
  register_case("undistort, 4K NV12", "NV12", kUhd,
                {{"calvin", undistort},
                 {"calvin, pan at every frame", undistort, turn},
                 {"identity", "identity"}});
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
