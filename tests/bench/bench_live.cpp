// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A whole session on a camera of 1080p60 in raw NV12, detection, solving, overlay and undistortion
// in one pipeline: frames lost, latency, CPU time and memory, minute by minute, beside those of the
// camera alone. The camera is the emulated one, which is to be preloaded.
//   bench_live [SECONDS]    30, or what CALVIN_SECONDS says

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <mutex>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include "support.hpp"

namespace {

using namespace calvin;

constexpr double kRate = 60;  // frames per s
constexpr const char* kCamera =
    "v4l2src name=camera ! video/x-raw,format=NV12,width=1920,height=1080,framerate=60/1 ! ";

// What the kernel's scheduler says of the thread that calls, in frames.
struct ThreadTime {
  double ran = 0;
  double waited = 0;  // ready to run, while other threads had the cores

  static ThreadTime now() {
    ThreadTime time;
    std::ifstream("/proc/thread-self/schedstat") >> time.ran >> time.waited;  // ns
    time.ran *= kRate / 1e9;
    time.waited *= kRate / 1e9;
    return time;
  }
};

// Where the time of one frame went, in frames.
struct Latency {
  double all = 0;     // from the capture to the sink
  double before = 0;  // of it, until the frame left the camera's element
  double ran = 0;     // the streaming thread, from there on
  double waited = 0;  // the streaming thread for a core, from there on

  [[nodiscard]] double asleep() const { return all - before - ran - waited; }
};

// What passed a pipeline since it was asked the last time. Written by the streaming thread.
class Frames {
 public:
  struct Count {
    std::uint64_t left = 0;          // the camera
    std::uint64_t lost = 0;          // numbers that are missing in the camera's sequence
    std::vector<Latency> latencies;  // of the frames that arrived
  };

  void leave(GstElement* camera, const GstBuffer* buffer) {
    const std::lock_guard guard(lock_);
    const std::uint64_t number = GST_BUFFER_OFFSET(buffer);
    // v4l2src of GStreamer 1.22 numbers the second frame of a stream 2.
    if (seen_++ > 1) count_.lost += number - last_ - 1;
    last_ = number;
    ++count_.left;
    before_ = age(camera, buffer);
    begin_ = ThreadTime::now();
  }
  void arrive(GstElement* sink, const GstBuffer* buffer) {
    const std::lock_guard guard(lock_);
    const ThreadTime end = ThreadTime::now();
    count_.latencies.push_back(
        {age(sink, buffer), before_, end.ran - begin_.ran, end.waited - begin_.waited});
  }
  Count take() {
    const std::lock_guard guard(lock_);
    return std::exchange(count_, {});
  }

 private:
  // Frames since the capture.
  static double age(GstElement* element, const GstBuffer* buffer) {
    g_autoptr(GstClock) clock = gst_element_get_clock(element);
    const GstClockTime now = gst_clock_get_time(clock) - gst_element_get_base_time(element);
    return static_cast<double>(GST_CLOCK_DIFF(GST_BUFFER_PTS(buffer), now)) * kRate / GST_SECOND;
  }

  std::mutex lock_;
  std::uint64_t seen_ = 0;
  std::uint64_t last_ = 0;
  double before_ = 0;
  ThreadTime begin_;
  Count count_;
};

// CPU time in s: of this process, and of the whole machine by its kernel.
struct Spent {
  double own = 0;
  double busy = 0;   // all processes, this one included
  double steal = 0;  // what the machine's host gave to others
  double all = 0;    // of every core, idle or not

  static Spent now() {
    Spent s;
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    for (const timeval& t : {usage.ru_utime, usage.ru_stime}) {
      s.own += static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
    }
    // user nice system idle iowait irq softirq steal
    std::array<double, 8> jiffies{};
    std::ifstream stat("/proc/stat");
    std::string name;
    stat >> name;
    for (double& j : jiffies) stat >> j;
    const auto per_second = static_cast<double>(::sysconf(_SC_CLK_TCK));
    for (const double j : jiffies) s.all += j / per_second;
    s.steal = jiffies[7] / per_second;
    s.busy = s.all - (jiffies[3] + jiffies[4] + jiffies[7]) / per_second;
    return s;
  }
};

double resident_mb() {
  long pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return static_cast<double>(pages * ::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

Latency quantile(std::vector<Latency>& values, double part, double Latency::*of = &Latency::all) {
  if (values.empty()) return {};
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at, {}, of);
  return values[static_cast<std::size_t>(at)];
}

void print_row(const char* name, Frames::Count& frames, double cores, double others, double steal) {
  std::vector<Latency>& latencies = frames.latencies;
  std::printf("| %s | %llu | %llu | %.2f, %.2f, %.2f | %.2f | %.2f | %.2f | %.1f %% | %.1f MB |\n",
              name, static_cast<unsigned long long>(frames.left),
              static_cast<unsigned long long>(frames.lost), quantile(latencies, 0.5).all,
              quantile(latencies, 0.99).all, quantile(latencies, 1).all,
              quantile(latencies, 1, &Latency::ran).ran, cores, others, steal, resident_mb());
  std::fflush(stdout);
}

// A pipeline that plays, and what it said.
class Live {
 public:
  explicit Live(const std::string& line) {
    g_autoptr(GError) error = nullptr;
    pipeline_ = gst_parse_launch((kCamera + line).c_str(), &error);
    if (error != nullptr) give_up(error->message);
    bus_ = gst_element_get_bus(pipeline_);
    probe("camera", "src", [](GstPad* pad, GstPadProbeInfo* info, gpointer data) {
      g_autoptr(GstElement) camera = gst_pad_get_parent_element(pad);
      static_cast<Live*>(data)->frames_.leave(camera, GST_PAD_PROBE_INFO_BUFFER(info));
      return GST_PAD_PROBE_OK;
    });
    probe("sink", "sink", [](GstPad* pad, GstPadProbeInfo* info, gpointer data) {
      g_autoptr(GstElement) sink = gst_pad_get_parent_element(pad);
      static_cast<Live*>(data)->frames_.arrive(sink, GST_PAD_PROBE_INFO_BUFFER(info));
      return GST_PAD_PROBE_OK;
    });
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;
  ~Live() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(bus_);
    gst_object_unref(pipeline_);
  }

  // A row for each `interval` (s), and one of all, when so many s have passed since the first
  // frame.
  void run(double seconds, double interval) {
    while (frames_.take().left == 0) listen(0.1);
    const Spent begin = Spent::now();
    Spent last = begin;
    Frames::Count all;
    for (double passed = 0; passed + interval / 2 < seconds; passed += interval) {
      listen(interval);
      Frames::Count now = frames_.take();
      all.left += now.left;
      all.lost += now.lost;
      all.latencies.insert(all.latencies.end(), now.latencies.begin(), now.latencies.end());
      const Spent spent = Spent::now();
      print(std::to_string(std::lround(passed + interval)) + " s", now, last, spent);
      last = spent;
    }
    print("all", all, begin, last);
    print_latest(all);
  }
  [[nodiscard]] int views() const { return views_; }
  [[nodiscard]] int results() const { return results_; }
  [[nodiscard]] double expected_error() const { return expected_error_; }

 private:
  [[noreturn]] static void give_up(const char* why) {
    std::fprintf(stderr, "bench_live: %s (tests/bench/run.sh live preloads the camera)\n", why);
    std::exit(1);
  }
  void probe(const char* name, const char* pad_name, GstPadProbeCallback callback) {
    g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline_), name);
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, pad_name);
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, callback, this, nullptr);
  }
  static void print(const std::string& name, Frames::Count& frames, const Spent& from,
                    const Spent& to) {
    const double cores = static_cast<double>(::sysconf(_SC_NPROCESSORS_ONLN));
    const double seconds = std::max(1e-9, (to.all - from.all) / cores);
    const double own = to.own - from.own;
    print_row(name.c_str(), frames, own / seconds,
              std::max(0.0, to.busy - from.busy - own) / seconds,
              100 * (to.steal - from.steal) / (seconds * cores));
  }
  // Where the time of the frames went that took the longest.
  static void print_latest(Frames::Count& frames) {
    constexpr std::ptrdiff_t kLatest = 5;
    auto& latencies = frames.latencies;
    std::ranges::sort(latencies, std::ranges::greater(), &Latency::all);
    const auto late = std::ranges::count_if(
        latencies, [](double all) { return all > 1; }, &Latency::all);
    std::printf("  later than one frame: %td of %zu\n", late, latencies.size());
    for (const Latency& l : latencies | std::views::take(kLatest)) {
      std::printf(
          "  %.2f frames: %.2f before the camera's element gave it, %.2f of work, %.2f "
          "waiting for a core, %.2f asleep or taken by the host\n",
          l.all, l.before, l.ran, l.waited, l.asleep());
    }
  }
  // Takes messages off the bus for so many s.
  void listen(double seconds) {
    const auto until = g_get_monotonic_time() + static_cast<gint64>(seconds * G_USEC_PER_SEC);
    for (gint64 left = 1; left > 0; left = until - g_get_monotonic_time()) {
      g_autoptr(GstMessage) message =
          gst_bus_timed_pop(bus_, static_cast<GstClockTime>(left) * GST_USECOND);
      if (message != nullptr) hear(message);
    }
  }
  void hear(GstMessage* message) {
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
      g_autoptr(GError) error = nullptr;
      gst_message_parse_error(message, &error, nullptr);
      give_up(error->message);
    }
    const GstStructure* s = gst_message_get_structure(message);
    if (s == nullptr) return;
    if (gst_structure_has_name(s, "calib-progress")) gst_structure_get_int(s, "views", &views_);
    if (!gst_structure_has_name(s, "calib-result")) return;
    ++results_;
    gst_structure_get_double(s, "expected-error", &expected_error_);
  }

  GstElement* pipeline_ = nullptr;
  GstBus* bus_ = nullptr;
  Frames frames_;
  int views_ = 0;
  int results_ = 0;
  double expected_error_ = 0;
};

void print_head(const char* what) {
  std::printf(
      "\n%s\n| | frames | lost | latency in frames: median, 99 %%, longest | of it work: most | "
      "cores | others' cores | steal | resident |\n|---|---|---|---|---|---|---|---|---|\n",
      what);
}

// What is not set yet: the camera, and what it counts.
void describe_camera(const std::string& counters) {
  for (const auto& [name, value] : {std::pair{"CALVIN_V4L2_FORMATS", "NV12"},
                                    {"CALVIN_V4L2_SIZES", "1920x1080"},
                                    {"CALVIN_V4L2_FPS", "60"},
                                    {"CALVIN_V4L2_RING", "128"},
                                    {"CALVIN_V4L2_COUNTERS", counters.c_str()}}) {
    g_setenv(name, value, FALSE);
  }
}

double wanted_seconds(const char* text) {
  return std::max(1.0, parse_double(text == nullptr ? "" : text).value_or(30));
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const double seconds = wanted_seconds(argc > 1 ? argv[1] : std::getenv("CALVIN_SECONDS"));
  const double interval = seconds >= 120 ? 60 : std::max(1.0, seconds / 3);
  const check::TemporaryFolder folder;
  const std::string counters = folder / "counters";
  describe_camera(counters);
  print_head("The camera alone: v4l2src ! fakesink");
  {
    Live alone("fakesink name=sink sync=false");
    alone.run(std::min(seconds, 10.0), std::min(seconds, 10.0));
  }
  print_head("v4l2src ! calibrate ! calibundistort ! fakesink");
  {
    Live session("calibrate location=" + folder / "camera.json" + " journal=" +
                 folder / "views.jsonl" + " ! calibundistort ! fakesink name=sink sync=false");
    session.run(seconds, interval);
    std::printf("\n%d views, %d results, expected error %.3f px\n", session.views(),
                session.results(), session.expected_error());
  }
  std::printf("The camera's own count of each stream (cpu in s):\n");
  std::ifstream file(counters);
  for (std::string line; std::getline(file, line);) std::printf("  %s\n", line.c_str());
  return 0;
}
