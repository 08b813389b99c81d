// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistortion on one thread: the element's kernels beside cv::remap on the same planes,
// GStreamer's `cameraundistort` with the converters that it needs, and memcpy; and the making of
// the map.
//   CALVIN_PICTURE: another picture than OpenCV's aloeL.jpg.

#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>

#include <gst/check/gstharness.h>
#include <gst/video/video.h>
#include <hwy/highway.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "calvin/remap/undistorter.hpp"
#include "common/frames/frame_planes.hpp"
#include "ratio_reporter.hpp"

namespace {

using namespace calvin;

constexpr int kFrames = 4;  // so that the next one is not in the nearest cache
// So that it is in no cache, as what a camera wrote: more than the last cache of most machines.
constexpr int kManyFrames = 64;
constexpr ImageSize kFullHd = {1920, 1080};
constexpr ImageSize kUhd = {3840, 2160};

std::vector<double> parameters_of(ImageSize size) {
  const double f = 0.6 * size.width;
  return {f,       1.002 * f, size.width / 2.0 + 6.8, size.height / 2.0 - 4.6, -0.3, 0.1, 0.0005,
          -0.0003, -0.01};
}

Camera camera_of(ImageSize size) {
  return Camera::make("brown5", size, parameters_of(size)).value();
}

// The same lens and view for the peers.
struct PeerCamera {
  cv::Mat k;
  cv::Mat d;
  cv::Mat view;

  explicit PeerCamera(ImageSize size) {
    const auto p = parameters_of(size);
    k = (cv::Mat_<double>(3, 3) << p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1);
    d = (cv::Mat_<double>(1, 5) << p[4], p[5], p[6], p[7], p[8]);
    const Camera out = output_camera(camera_of(size), {}).value();
    view = (cv::Mat_<double>(3, 3) << out.fx(), 0, out.cx(), 0, out.fy(), out.cy(), 0, 0, 1);
  }
  // For a plane that is `shift` times halved each way.
  [[nodiscard]] PeerCamera halved(int x_shift, int y_shift) const {
    PeerCamera half = *this;
    const double sx = 1.0 / (1 << x_shift);
    const double sy = 1.0 / (1 << y_shift);
    const cv::Mat scale =
        (cv::Mat_<double>(3, 3) << sx, 0, (sx - 1) / 2, 0, sy, (sy - 1) / 2, 0, 0, 1);
    half.k = scale * k;
    half.view = scale * view;
    return half;
  }
  [[nodiscard]] std::pair<cv::Mat, cv::Mat> maps(int width, int height) const {
    cv::Mat a;
    cv::Mat b;
    cv::initUndistortRectifyMap(k, d, cv::Mat(), view, {width, height}, CV_16SC2, a, b);
    return {a, b};
  }
};

// A photograph, continued by reflection: nothing is upscaled.
cv::Mat natural(int width, int height) {
  const char* path = std::getenv("CALVIN_PICTURE");
  const cv::Mat picture =
      cv::imread(path != nullptr ? path : "/usr/share/doc/opencv-doc/examples/data/aloeL.jpg",
                 cv::IMREAD_GRAYSCALE);
  if (picture.empty()) {
    std::fprintf(stderr, "There is no picture: install opencv-doc or set CALVIN_PICTURE.\n");
    std::exit(1);
  }
  cv::Mat result;
  cv::copyMakeBorder(picture, result, 0, std::max(0, height - picture.rows), 0,
                     std::max(0, width - picture.cols), cv::BORDER_REFLECT);
  return result(cv::Rect(0, 0, width, height)).clone();
}

// Frames of a format in memory, with what every subject needs of them.
struct Frames {
  Frames(const char* name, ImageSize frame_size, int count)
      : format(name),
        size(frame_size),
        caps(gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, name, "width", G_TYPE_INT,
                                 frame_size.width, "height", G_TYPE_INT, frame_size.height,
                                 "framerate", GST_TYPE_FRACTION, 30, 1, nullptr)) {
    gst_video_info_from_caps(&info, caps);
    const cv::Mat gray = natural(size.width, size.height);
    for (int i = 0; i < count; ++i) {
      inputs.push_back(make(&gray));
      outputs.push_back(make(nullptr));
    }
    const gst::FrameFormat described(info, caps);
    planes = gst::planes_of(described, described);
  }
  ~Frames() {
    for (GstBuffer* buffer : inputs) gst_buffer_unref(buffer);
    for (GstBuffer* buffer : outputs) gst_buffer_unref(buffer);
    gst_caps_unref(caps);
  }
  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  // Every byte is one of the picture's: what they mean does not matter to anybody's time.
  GstBuffer* make(const cv::Mat* gray) const {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_WRITE);
    std::memset(map.data, 1, map.size);
    if (gray != nullptr) {
      for (gsize i = 0; i < map.size; ++i) map.data[i] = gray->data[i % gray->total()];
    }
    gst_buffer_unmap(buffer, &map);
    GST_BUFFER_PTS(buffer) = 0;
    return buffer;
  }

  const char* format;
  ImageSize size;
  GstCaps* caps;
  GstVideoInfo info{};
  std::vector<gst::FramePlane> planes;
  std::vector<GstBuffer*> inputs;
  std::vector<GstBuffer*> outputs;
};

// Calls f(input, output) for one pair of frames after the other.
template <typename F>
void over_frames(benchmark::State& state, const Frames& frames, F f) {
  const std::size_t count = frames.inputs.size();
  std::vector<GstVideoFrame> in(count);
  std::vector<GstVideoFrame> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    gst_video_frame_map(&in[i], &frames.info, frames.inputs[i], GST_MAP_READ);
    gst_video_frame_map(&out[i], &frames.info, frames.outputs[i], GST_MAP_WRITE);
  }
  std::size_t n = 0;
  for (auto _ : state) {
    f(in[n % count], out[n % count]);
    ++n;
  }
  for (std::size_t i = 0; i < count; ++i) {
    gst_video_frame_unmap(&in[i]);
    gst_video_frame_unmap(&out[i]);
  }
}

void ours(benchmark::State& state, const Frames& frames, std::int64_t disabled) {
  hwy::DisableTargets(disabled);
  std::vector<PlaneLayout> layouts;
  for (const gst::FramePlane& plane : frames.planes) layouts.push_back(plane.layout);
  const auto undistorter = Undistorter::make(camera_of(frames.size), {}, layouts).value();
  std::vector<PlaneMemory<const std::uint8_t>> sources(layouts.size());
  std::vector<PlaneMemory<std::uint8_t>> outputs(layouts.size());
  over_frames(state, frames, [&](const GstVideoFrame& in, const GstVideoFrame& out) {
    for (std::size_t i = 0; i < layouts.size(); ++i) {
      const auto memory = gst::memory_of(in, frames.planes[i]);
      sources[i] = {memory.data, memory.stride};
      outputs[i] = gst::memory_of(out, frames.planes[i]);
    }
    undistorter.apply(sources, outputs);
  });
  state.counters["map_bytes"] = static_cast<double>(undistorter.map_bytes());
  hwy::DisableTargets(0);
}

void copy(benchmark::State& state, const Frames& frames) {
  over_frames(state, frames, [&](const GstVideoFrame& in, const GstVideoFrame& out) {
    std::memcpy(out.data[0], in.data[0], frames.info.size);
  });
}

// One call per plane, with maps for its size.
void opencv(benchmark::State& state, const Frames& frames) {
  const PeerCamera camera(frames.size);
  std::vector<std::pair<cv::Mat, cv::Mat>> maps;
  const auto size_of = [&](const gst::FramePlane& plane) {
    const Subsampling& s = plane.layout.subsampling;
    return cv::Size(frames.size.width >> s.x_shift, frames.size.height >> s.y_shift);
  };
  for (const gst::FramePlane& plane : frames.planes) {
    const Subsampling& s = plane.layout.subsampling;
    const cv::Size size = size_of(plane);
    maps.push_back(camera.halved(s.x_shift, s.y_shift).maps(size.width, size.height));
  }
  over_frames(state, frames, [&](const GstVideoFrame& in, const GstVideoFrame& out) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto from = gst::memory_of(in, frames.planes[i]);
      const auto to = gst::memory_of(out, frames.planes[i]);
      const PlaneLayout& layout = frames.planes[i].layout;
      const int depth = layout.sample == SampleType::kU8 ? CV_8U : CV_16U;
      const int type = CV_MAKETYPE(depth, layout.components);
      const cv::Size size = size_of(frames.planes[i]);
      const cv::Mat source(size, type, from.data, static_cast<std::size_t>(from.stride));
      cv::Mat output(size, type, to.data, static_cast<std::size_t>(to.stride));
      cv::remap(source, output, maps[i].first, maps[i].second, cv::INTER_LINEAR);
    }
  });
}

// The peer's own text for its property.
std::string settings_of(ImageSize size) {
  const PeerCamera camera(size);
  cv::FileStorage storage(".xml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "cameraMatrix" << camera.k << "distCoeffs" << camera.d;
  return storage.releaseAndGetString();
}

// The chain that a user writes, in a harness: every element runs on this thread.
void pipeline(benchmark::State& state, const Frames& frames) {
  GstHarness* h = gst_harness_new_parse(
      "videoconvert n-threads=1 ! cameraundistort name=peer ! videoconvert n-threads=1");
  GstElement* peer = gst_harness_find_element(h, "cameraundistort");
  g_object_set(peer, "settings", settings_of(frames.size).c_str(), nullptr);
  gst_object_unref(peer);
  gst_harness_set_sink_caps(h, gst_caps_ref(frames.caps));
  gst_harness_set_src_caps(h, gst_caps_ref(frames.caps));
  std::size_t n = 0;
  for (auto _ : state) {
    GstBuffer* out =
        gst_harness_push_and_pull(h, gst_buffer_ref(frames.inputs[n++ % frames.inputs.size()]));
    if (out == nullptr) {
      state.SkipWithError("no frame came out");
      break;
    }
    gst_buffer_unref(out);
  }
  gst_harness_teardown(h);
}

void our_map(benchmark::State& state, ImageSize size) {
  const Camera camera = camera_of(size);
  const Camera view = output_camera(camera, {}).value();
  const PixelFunction place_of = [&](Pixel pixel) { return transfer(view, camera, pixel); };
  for (auto _ : state) {
    auto map = RemapMap::build(size, size, place_of).value();
    auto shared = std::make_shared<const RemapMap>(std::move(map));
    benchmark::DoNotOptimize(PlaneMap::build(shared, place_of, {}, 8).value());
  }
}

void our_undistorter(benchmark::State& state, ImageSize size) {
  const Camera camera = camera_of(size);
  for (auto _ : state) {
    benchmark::DoNotOptimize(Undistorter::make(camera, {}, {PlaneLayout{}}).value());
  }
}

void opencv_map(benchmark::State& state, ImageSize size) {
  const PeerCamera camera(size);
  for (auto _ : state) benchmark::DoNotOptimize(camera.maps(size.width, size.height));
}

std::string name_of(ImageSize size) { return size == kFullHd ? "1080p" : "4K"; }

void register_frames(const char* format, ImageSize size, bool planes, bool chain,
                     int count = kFrames) {
  // Made by the first who asks for them: a filter may leave them out.
  const auto made = std::make_shared<std::unique_ptr<Frames>>();
  const auto frames = [=]() -> const Frames& {
    if (!*made) *made = std::make_unique<Frames>(format, size, count);
    return **made;
  };
  const std::string name =
      std::string(format) + " " + name_of(size) + (count > kFrames ? ", from memory|" : "|");
  const auto add = [&](const char* subject, auto run) {
    benchmark::RegisterBenchmark((name + subject).c_str(), [frames, run](benchmark::State& state) {
      run(state, frames());
    })->Unit(benchmark::kMillisecond);
  };
  add("calvin", [](auto& state, const Frames& f) { ours(state, f, 0); });
#if HWY_ARCH_X86
  // Bits below that of AVX2 are of later instructions.
  add("calvin, AVX2", [](auto& state, const Frames& f) { ours(state, f, HWY_AVX2 - 1); });
  add("calvin, 128 bit", [](auto& state, const Frames& f) { ours(state, f, HWY_SSE4 - 1); });
#endif
  if (planes) add("cv::remap, 16SC2", opencv);
  if (chain) add("cameraundistort", pipeline);
  add("memcpy", copy);
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  bench::initialize_interleaved(argc, argv);
  cv::setNumThreads(1);
  for (const ImageSize size : {kFullHd, kUhd}) {
    const bool chain = size == kFullHd;
    register_frames("GRAY8", size, true, chain);
    register_frames("I420", size, true, chain);
    register_frames("NV12", size, true, chain);
    register_frames("YUY2", size, false, chain);
    register_frames("BGRx", size, true, chain);
    register_frames("RGB", size, true, chain);
    register_frames("GRAY16_LE", size, true, false);
    register_frames("P010_10LE", size, true, false);
    if (chain) register_frames("GRAY8", size, true, false, kManyFrames);
    const auto add = [size](const char* subject, auto run) {
      benchmark::RegisterBenchmark(("map " + name_of(size) + "|" + subject).c_str(),
                                   [run, size](benchmark::State& state) { run(state, size); })
          ->Unit(benchmark::kMillisecond);
    };
    add("calvin", our_map);
    add("calvin, with its view", our_undistorter);
    add("initUndistortRectifyMap", opencv_map);
  }
  bench::RatioReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
