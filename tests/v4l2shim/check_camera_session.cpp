// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sessions with a camera that is unplugged or changes its size, in the dark, and before boards that
// are not the one: a sentence for each, nothing is lost, and the session goes on when the cause is
// gone.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/observations.hpp"
#include "live_pipeline.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::LivePipeline;

static constexpr const char* kRaw = "video/x-raw,format=YUY2,width=640,height=480";

static int views_of(const GstStructure* s) {
  int views = -1;
  fail_unless(gst_structure_get_int(s, "views", &views));
  return views;
}
static std::string hint_of(const GstStructure* s) {
  const char* hint = gst_structure_get_string(s, "hint");
  return hint == nullptr ? "" : hint;
}
static bool is_accepted(const GstStructure* s) {
  gboolean accepted = FALSE;
  return gst_structure_get_boolean(s, "accepted", &accepted) && accepted;
}

// Until so many views are held.
static void wait_for_views(LivePipeline& pipeline, int least) {
  pipeline.wait("calib-view",
                [least](const GstStructure* s) { return is_accepted(s) && views_of(s) >= least; });
}
// Until a rejection has that reason and these words.
static void wait_for_words(LivePipeline& pipeline, const char* reason, const std::string& words) {
  pipeline.wait("calib-view", [&](const GstStructure* s) {
    return std::string(gst_structure_get_string(s, "reason")) == reason && hint_of(s) == words;
  });
}
static void wait_for_info(LivePipeline& pipeline, const char* part) {
  pipeline.wait(part, [part](GstMessage* message) {
    return GST_MESSAGE_TYPE(message) == GST_MESSAGE_INFO &&
           LivePipeline::text_of(message).find(part) != std::string::npos;
  });
}

// The views that all of its messages announce as accepted.
static std::size_t announced(const LivePipeline& pipeline) {
  const auto& all = pipeline.messages();
  return static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [](GstMessage* message) {
    const GstStructure* s = gst_message_get_structure(message);
    return s != nullptr && gst_structure_has_name(s, "calib-view") && is_accepted(s);
  }));
}

// A session that keeps its files in a folder.
struct Files {
  check::TemporaryFolder folder;
  std::string location = folder / "camera.json";
  std::string journal = folder / "views.jsonl";

  [[nodiscard]] std::string calibrate(const std::string& more = "") const {
    return "calibrate name=calibrate overlay=false location=" + location + " journal=" + journal +
           " " + more;
  }
  [[nodiscard]] std::size_t held() const {
    const auto file = read_observations(journal);
    fail_unless(file.has_value());
    return file->observations.size();
  }
  // Those whose first corner is not left of that place.
  [[nodiscard]] std::ptrdiff_t held_beside(double left) const {
    const auto file = read_observations(journal);
    fail_unless(file.has_value());
    const auto& all = file->observations;
    return std::count_if(all.begin(), all.end(),
                         [left](const Observation& o) { return o.uv.front().u >= left; });
  }
};

// What was announced is in the files, and the next run goes on from there.
GST_START_TEST(test_a_camera_is_unplugged) {
  const Files files;
  const std::string plug = files.folder / "plug";
  std::ofstream(plug).put('\n');
  g_setenv("CALVIN_V4L2_PLUG", plug.c_str(), TRUE);
  const std::string line =
      std::string("v4l2src ! ") + kRaw + " ! " + files.calibrate() + " ! calibundistort ! fakesink";
  std::size_t views = 0;
  {
    LivePipeline pipeline(line);
    pipeline.play();
    wait_for_views(pipeline, 4);
    pipeline.wait("calib-result", [](const GstStructure*) { return true; });
    std::filesystem::remove(plug);
    pipeline.wait(GST_MESSAGE_ERROR);
    pipeline.stop();
    views = announced(pipeline);
  }
  fail_unless_equals_int(files.held(), views);
  fail_unless(read_calibration(files.location).has_value());
  fail_if(std::filesystem::exists(files.location + "~"));

  std::ofstream(plug).put('\n');
  LivePipeline pipeline(line);
  pipeline.play();
  const GstStructure* begun =
      pipeline.wait("calib-progress", [](const GstStructure*) { return true; });
  fail_unless_equals_int(views_of(begun), views);
  wait_for_views(pipeline, static_cast<int>(views) + 1);
  pipeline.end();
  pipeline.wait(GST_MESSAGE_EOS);
  pipeline.stop();
  fail_unless_equals_int(files.held(), views + announced(pipeline));
  fail_unless(read_calibration(files.location).has_value());
}
GST_END_TEST;

GST_START_TEST(test_a_camera_changes_its_size_and_back) {
  const Files files;
  LivePipeline pipeline(std::string("v4l2src ! capsfilter name=size caps=") + kRaw + " ! " +
                        files.calibrate() + " ! calibundistort ! fakesink");
  const auto set_width = [&pipeline](const char* text) {
    gst_util_set_object_arg(G_OBJECT(pipeline.get("size")), "caps", text);
  };
  pipeline.play();
  wait_for_views(pipeline, 4);
  set_width("video/x-raw,format=YUY2,width=320,height=240");
  wait_for_info(pipeline, "of frames of another size wait until such frames come again");
  const std::size_t large = announced(pipeline);
  wait_for_views(pipeline, 2);
  set_width(kRaw);
  const GstMessage* back = pipeline.wait("the views of before", [](GstMessage* message) {
    return GST_MESSAGE_TYPE(message) == GST_MESSAGE_INFO &&
           LivePipeline::text_of(message).find("go on") != std::string::npos;
  });
  const std::string words = LivePipeline::text_of(const_cast<GstMessage*>(back));
  fail_unless(words.find(std::to_string(large) + " views") == 0, "%s", words.c_str());
  wait_for_views(pipeline, static_cast<int>(large) + 1);
  pipeline.end();
  pipeline.wait(GST_MESSAGE_EOS);
  pipeline.stop();
  fail_unless_equals_int(files.held(), announced(pipeline));
  const auto found = read_calibration(files.location);
  fail_unless(found.has_value());
  fail_unless_equals_int(found->image_size.width, 640);
}
GST_END_TEST;

GST_START_TEST(test_the_dark_comes_and_goes) {
  const Files files;
  LivePipeline pipeline(std::string("v4l2src ! ") + kRaw + " ! videobalance name=light ! " +
                        files.calibrate() + " ! fakesink");
  pipeline.play();
  wait_for_views(pipeline, 3);
  g_object_set(pipeline.get("light"), "brightness", -1.0, nullptr);
  wait_for_words(pipeline, "not-found",
                 "The picture is too dark: more light, or a longer exposure");
  const std::size_t before = announced(pipeline);
  g_object_set(pipeline.get("light"), "brightness", 0.0, nullptr);
  wait_for_views(pipeline, static_cast<int>(before) + 1);
  const GstStructure* light =
      pipeline.wait("calib-progress", [](const GstStructure*) { return true; });
  fail_unless(hint_of(light).find("dark") == std::string::npos);
  fail_unless_equals_int(files.held(), announced(pipeline));
}
GST_END_TEST;

static const char kTwoCameras[] = "/dev/video0,/dev/video1";
static const char kTwoBoards[] = "checkerboard:9x6:25mm;checkerboard:7x5:25mm";
static const char kWrongBoard[] = "This is a 7x5 board, I look for 9x6";

// Somebody takes up the other board, which another camera stands for here, and puts it down again.
GST_START_TEST(test_a_board_of_the_wrong_size_comes_and_goes) {
  const Files files;
  g_setenv("CALVIN_V4L2_DEVICE", kTwoCameras, TRUE);
  g_setenv("CALVIN_V4L2_BOARD", kTwoBoards, TRUE);
  LivePipeline pipeline(std::string("input-selector name=hand ! ") + files.calibrate() +
                        " ! fakesink sync=false v4l2src ! " + kRaw +
                        " ! hand.sink_0 v4l2src device=/dev/video1 ! " + kRaw + " ! hand.sink_1");
  const auto take_up = [&pipeline](const char* pad_name) {
    GstElement* hand = pipeline.get("hand");
    g_autoptr(GstPad) pad = gst_element_get_static_pad(hand, pad_name);
    g_object_set(hand, "active-pad", pad, nullptr);
  };
  take_up(__i__ == 0 ? "sink_0" : "sink_1");
  pipeline.play();
  if (__i__ == 0) {
    wait_for_views(pipeline, 3);
    take_up("sink_1");
  }
  wait_for_words(pipeline, "wrong-board", kWrongBoard);
  const std::size_t before = announced(pipeline);
  take_up("sink_0");
  wait_for_views(pipeline, static_cast<int>(before) + 3);
  fail_unless_equals_int(files.held(), announced(pipeline));
}
GST_END_TEST;

// Beside the board lies another one: of another size it is in nobody's way, and one like it gives
// views too.
GST_START_TEST(test_a_second_board_is_in_the_picture) {
  const Files files;
  g_setenv("CALVIN_V4L2_DEVICE", kTwoCameras, TRUE);
  if (__i__ == 0) g_setenv("CALVIN_V4L2_BOARD", kTwoBoards, TRUE);
  LivePipeline pipeline(std::string("compositor name=table background=black sink_1::xpos=640 ! "
                                    "video/x-raw,width=1280,height=480 ! ") +
                        files.calibrate("capture-mode=all") + " ! fakesink sync=false v4l2src ! " +
                        kRaw + " ! table.sink_0 v4l2src device=/dev/video1 ! " + kRaw +
                        " ! table.sink_1");
  pipeline.play();
  wait_for_views(pipeline, 8);
  // The second camera may have begun later than the first one.
  for (int more = 9; __i__ == 1 && files.held_beside(640) == 0; more++)
    wait_for_views(pipeline, more);
  pipeline.stop();
  fail_unless_equals_int(files.held(), announced(pipeline));
  const auto file = read_observations(files.journal);
  for (const Observation& o : file->observations)
    fail_unless(o.board == kDefaultBoard, "%s", o.board.c_str());
  fail_unless((files.held_beside(640) > 0) == (__i__ == 1));
}
GST_END_TEST;

static Suite* camera_session_suite() {
  Suite* suite = suite_create("camera_session");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_test(tc, test_a_camera_is_unplugged);
  tcase_add_test(tc, test_a_camera_changes_its_size_and_back);
  tcase_add_test(tc, test_the_dark_comes_and_goes);
  tcase_add_loop_test(tc, test_a_board_of_the_wrong_size_comes_and_goes, 0, 2);
  tcase_add_loop_test(tc, test_a_second_board_is_in_the_picture, 0, 2);
  return suite;
}

GST_CHECK_MAIN(camera_session)
