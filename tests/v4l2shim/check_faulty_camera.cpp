// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the emulated camera does beside sending frames, through the real v4l2src: it repeats a ring
// of pictures, loses frames, is unplugged and plugged in again, and is two.

#include <fstream>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "live_pipeline.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::LivePipeline;

// The pictures that passed the source of that name, by their offset. That is the place in the
// camera's sequence, or one more behind the first frame: v4l2src of GStreamer 1.22 takes a sequence
// that begins with 0 for one that begins anew. The first frame is therefore left out.
class Frames {
 public:
  Frames(const LivePipeline& pipeline, const char* name) {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(pipeline.get(name), "src");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer data) {
          static_cast<Frames*>(data)->add(GST_PAD_PROBE_INFO_BUFFER(info));
          return GST_PAD_PROBE_OK;
        },
        this, nullptr);
  }
  [[nodiscard]] std::map<std::uint64_t, std::string> all() {
    const std::lock_guard guard(lock_);
    return checksums_;
  }

 private:
  void add(GstBuffer* buffer) {
    if (!std::exchange(began_, true)) return;
    GstMapInfo map;
    gst_buffer_map(buffer, &map, GST_MAP_READ);
    g_autofree char* sum = g_compute_checksum_for_data(G_CHECKSUM_MD5, map.data, map.size);
    gst_buffer_unmap(buffer, &map);
    const std::lock_guard guard(lock_);
    checksums_.emplace(GST_BUFFER_OFFSET(buffer), sum);
  }

  bool began_ = false;  // of the streaming thread
  std::mutex lock_;
  std::map<std::uint64_t, std::string> checksums_;
};

static const char kLine[] =
    "v4l2src name=camera num-buffers=%d ! video/x-raw,format=YUY2,width=640,height=480 ! "
    "fakesink sync=false";

static std::string line(int frames) {
  g_autofree char* text = g_strdup_printf(kLine, frames);
  return text;
}

// What the camera counted in its streams, one line for each.
static std::vector<nlohmann::json> counted(const std::string& path) {
  std::vector<nlohmann::json> lines;
  std::ifstream file(path);
  for (std::string text; std::getline(file, text);) {
    lines.push_back(nlohmann::json::parse(text, nullptr, false));
    fail_if(lines.back().is_discarded(), "%s", text.c_str());
  }
  return lines;
}

// 4 MB hold 6 pictures, each of which is shown for 15 frames.
GST_START_TEST(test_a_ring_is_repeated) {
  g_setenv("CALVIN_V4L2_RING", "4", TRUE);
  LivePipeline pipeline(line(6 * 15 + 10));
  Frames frames(pipeline, "camera");
  pipeline.play();
  pipeline.wait(GST_MESSAGE_EOS);
  const auto seen = frames.all();
  int repeated = 0;
  for (const auto& [offset, picture] : seen) {
    const auto other = seen.find(offset + std::uint64_t{6 * 15});
    if (other == seen.end()) continue;
    fail_unless_equals_string(picture.c_str(), other->second.c_str());
    ++repeated;
  }
  fail_unless(repeated > 0);
  std::map<std::string, int> pictures;
  for (const auto& [offset, picture] : seen) ++pictures[picture];
  fail_unless_equals_int(pictures.size(), 6);
}
GST_END_TEST;

GST_START_TEST(test_frames_are_lost_and_counted) {
  check::TemporaryFolder folder;
  const std::string counters = folder / "counters";
  g_setenv("CALVIN_V4L2_LOSE", "5", TRUE);
  g_setenv("CALVIN_V4L2_COUNTERS", counters.c_str(), TRUE);
  LivePipeline pipeline(line(20));
  Frames frames(pipeline, "camera");
  pipeline.play();
  pipeline.wait(GST_MESSAGE_EOS);
  pipeline.stop();
  std::set<std::uint64_t> remainders;
  for (const auto& [offset, picture] : frames.all()) remainders.insert(offset % 5);
  fail_unless_equals_int(remainders.size(), 4);
  // The source tells of frames that are missing.
  fail_unless(std::any_of(
      pipeline.messages().begin(), pipeline.messages().end(),
      [](GstMessage* message) { return GST_MESSAGE_TYPE(message) == GST_MESSAGE_QOS; }));
  const auto lines = counted(counters);
  fail_unless_equals_int(lines.size(), 1);
  fail_unless(lines[0].at("device") == "/dev/video0");
  fail_unless(lines[0].at("filled") >= 20);
  fail_unless(lines[0].at("lost_on_request") >= 4);
  fail_unless(lines[0].at("cpu") > 0.0);
}
GST_END_TEST;

// Nobody takes a buffer back: the sequence goes on, and the frames are lost.
GST_START_TEST(test_frames_without_a_buffer_are_lost_and_counted) {
  check::TemporaryFolder folder;
  const std::string counters = folder / "counters";
  g_setenv("CALVIN_V4L2_COUNTERS", counters.c_str(), TRUE);
  LivePipeline pipeline(line(30));
  Frames frames(pipeline, "camera");
  g_autoptr(GstPad) pad = gst_element_get_static_pad(pipeline.get("camera"), "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer) {
        if (GST_BUFFER_OFFSET(GST_PAD_PROBE_INFO_BUFFER(info)) == 3) g_usleep(G_USEC_PER_SEC);
        return GST_PAD_PROBE_OK;
      },
      nullptr, nullptr);
  pipeline.play();
  pipeline.wait(GST_MESSAGE_EOS);
  pipeline.stop();
  const std::uint64_t last = frames.all().rbegin()->first;
  fail_unless(last > 30, "%d", static_cast<int>(last));
  const auto lines = counted(counters);
  fail_unless_equals_int(lines.size(), 1);
  fail_unless(lines[0].at("lost") >= last - 30);
}
GST_END_TEST;

static std::string error_of(LivePipeline& pipeline) {
  return LivePipeline::text_of(pipeline.wait(GST_MESSAGE_ERROR));
}

// It is gone for whoever has it open and for whoever opens it, until it is plugged in again.
GST_START_TEST(test_unplugged_and_plugged_in_again) {
  check::TemporaryFolder folder;
  const std::string plug = folder / "plug";
  std::ofstream(plug).put('\n');
  g_setenv("CALVIN_V4L2_PLUG", plug.c_str(), TRUE);
  if (__i__ == 0) g_setenv("CALVIN_V4L2_UNPLUG", "10", TRUE);
  {
    LivePipeline pipeline(line(-1));
    Frames frames(pipeline, "camera");
    pipeline.play();
    if (__i__ == 1) {
      while (frames.all().size() < 5) g_usleep(10'000);
      std::filesystem::remove(plug);
    }
    const std::string error = error_of(pipeline);
    fail_if(error.empty());
    pipeline.stop();
    fail_if(std::filesystem::exists(plug));
    if (__i__ == 0) fail_unless(frames.all().size() < 10);
  }
  {
    LivePipeline pipeline(line(2));
    fail_unless_equals_int(pipeline.play(), GST_STATE_CHANGE_FAILURE);
    error_of(pipeline);
  }
  std::ofstream(plug).put('\n');
  LivePipeline pipeline(line(5));
  pipeline.play();
  pipeline.wait(GST_MESSAGE_EOS);
}
GST_END_TEST;

// Without a file that stands for the cable it is gone for good.
GST_START_TEST(test_unplugged_for_good) {
  g_setenv("CALVIN_V4L2_UNPLUG", "5", TRUE);
  for (int turn = 0; turn < 2; ++turn) {
    LivePipeline pipeline(line(-1));
    fail_unless((pipeline.play() == GST_STATE_CHANGE_FAILURE) == (turn == 1));
    error_of(pipeline);
  }
}
GST_END_TEST;

// Each with poses of its own, and one is unplugged alone.
GST_START_TEST(test_two_cameras) {
  g_setenv("CALVIN_V4L2_DEVICE", "/dev/video0,/dev/video1", TRUE);
  g_setenv("CALVIN_V4L2_UNPLUG", "0,20", TRUE);
  LivePipeline pipeline(
      "v4l2src name=left ! video/x-raw,width=320 ! fakesink sync=false "
      "v4l2src name=right device=/dev/video1 ! video/x-raw,width=320 ! fakesink sync=false");
  Frames left(pipeline, "left");
  Frames right(pipeline, "right");
  pipeline.play();
  GstMessage* error = pipeline.wait(GST_MESSAGE_ERROR);
  fail_unless_equals_string(GST_MESSAGE_SRC_NAME(error), "right");
  while (left.all().size() < 50) g_usleep(10'000);
  pipeline.stop();
  const auto seen = right.all();
  fail_if(seen.empty());
  fail_unless(seen.size() < 20);
  const std::string& of_left = left.all().begin()->second;
  for (const auto& [offset, picture] : seen) fail_if(picture == of_left);
}
GST_END_TEST;

static Suite* faulty_camera_suite() {
  Suite* suite = suite_create("faulty_camera");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_a_ring_is_repeated);
  tcase_add_test(tc, test_frames_are_lost_and_counted);
  tcase_add_test(tc, test_frames_without_a_buffer_are_lost_and_counted);
  tcase_add_loop_test(tc, test_unplugged_and_plugged_in_again, 0, 2);
  tcase_add_test(tc, test_unplugged_for_good);
  tcase_add_test(tc, test_two_cameras);
  return suite;
}

GST_CHECK_MAIN(faulty_camera)
