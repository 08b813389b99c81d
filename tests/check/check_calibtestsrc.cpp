// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibtestsrc: a source like videotestsrc, whose pictures and metas are what the library renders.

#include <cmath>
#include <cstring>

#include "calvin/io/calibration_io.hpp"
#include "support.hpp"

#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

using namespace calvin;

struct Fixture {
  explicit Fixture(const std::string& properties = "", const char* caps = nullptr)
      : h(gst_harness_new_parse(("calibtestsrc " + properties).c_str())),
        source(gst_harness_find_element(h, "calibtestsrc")),
        bus(source) {
    if (caps != nullptr) gst_harness_set_sink_caps_str(h, caps);
  }
  Fixture(const Fixture&) = delete;
  Fixture& operator=(const Fixture&) = delete;
  ~Fixture() {
    bus.detach();
    gst_object_unref(source);
    gst_harness_teardown(h);
  }
  GstBuffer* pull() {
    if (!playing) gst_harness_play(h);
    playing = true;
    return gst_harness_pull(h);
  }
  GstHarness* h;
  GstElement* source;
  check::Bus bus;
  bool playing = false;
};

// The luma of a buffer, by GStreamer's own description of the format.
static GrayImage luma_of(GstBuffer* buffer, GstHarness* h) {
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(h->sinkpad);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  GrayImage image(info.width, info.height);
  const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0));
  const ImageView view = {data, info.width, info.height, GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0),
                          GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0)};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.row(y)[x] = view.at(x, y);
  }
  gst_video_frame_unmap(&frame);
  return image;
}

static GrayImage expected(const check::Scene& scene, int n, RenderOptions options) {
  options.seed = noise_seed(1, static_cast<std::uint64_t>(n));
  return render_board(scene.camera, scene.board, scene.pose(n), options);
}

GST_START_TEST(test_defaults_are_a_vga_camera) {
  Fixture f("seed=1");
  g_autoptr(GstBuffer) buffer = f.pull();
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(f.h->sinkpad);
  g_autoptr(GstCaps) wanted = gst_caps_from_string(
      "video/x-raw,format=I420,width=640,height=480,framerate=30/1,pixel-aspect-ratio=1/1");
  fail_unless(gst_caps_is_subset(caps, wanted), "%" GST_PTR_FORMAT, static_cast<void*>(caps));
  fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), 0);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(buffer), GST_SECOND / 30);
}
GST_END_TEST;

static const char* const kFormats[] = {"GRAY8", "I420", "NV12", "YUY2", "BGRx"};
static const ImageSize kSizes[] = {{640, 480}, {161, 121}, {16, 17}, {1280, 720}};

GST_START_TEST(test_pictures_are_what_the_library_renders) {
  for (const ImageSize size : kSizes) {
    g_autofree char* text = g_strdup_printf("video/x-raw,format=%s,width=%d,height=%d",
                                            kFormats[__i__], size.width, size.height);
    Fixture f("seed=1 noise=2 blur=1", text);
    const Camera camera = default_camera(size);
    const Board board = *parse_board(kDefaultBoard);
    const check::Scene scene = {size, camera, board, Motion(MotionKind::kRandom, camera, board, 1)};
    for (int n = 0; n < 2; ++n) {
      g_autoptr(GstBuffer) buffer = f.pull();
      const GrayImage found = luma_of(buffer, f.h);
      fail_unless(found.pixels == expected(scene, n, {.noise = 2, .blur = 1}).pixels);
      const auto truth = gst::read_ground_truth(buffer);
      fail_unless(truth.has_value());
      fail_unless_equals_int(truth->boards.size(), 1);
      const Observation& seen = truth->boards[0].observation;
      const Observation exact = scene.truth(n);
      fail_unless(seen.ids == exact.ids);
      for (std::size_t i = 0; i < exact.uv.size(); ++i) {
        fail_unless(std::hypot(seen.uv[i].u - exact.uv[i].u, seen.uv[i].v - exact.uv[i].v) < 1e-9);
      }
      const Pose pose = to_pose(scene.pose(n));
      fail_unless(pose.translation == truth->boards[0].camera_from_board.translation);
      const auto calibration = parse_calibration(truth->calibration);
      fail_unless(calibration.has_value());
      fail_unless(Camera::make(*calibration)->parameters() == camera.parameters());
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_a_rolling_shutter_shows_the_motion) {
  Fixture f("motion=orbit noise=0 blur=0 readout-time=40000000", "video/x-raw,format=GRAY8");
  const Camera camera = default_camera({640, 480});
  const Board board = *parse_board(kDefaultBoard);
  const Motion motion(MotionKind::kOrbit, camera, board, 0);
  gst_buffer_unref(f.pull());
  g_autoptr(GstBuffer) buffer = f.pull();
  const double start = static_cast<double>(GST_BUFFER_PTS(buffer)) * 1e-9;
  const auto pose = [&](double v) { return motion.camera_from_board(start + 0.04 * v / 479); };
  fail_unless(luma_of(buffer, f.h).pixels == BoardRenderer(camera).render(board, pose).pixels);
  const auto truth = gst::read_ground_truth(buffer);
  fail_unless(truth.has_value() && truth->boards.size() == 1);
  const Observation exact = true_observation(camera, board, pose);
  const Observation& seen = truth->boards[0].observation;
  fail_unless(seen.ids == exact.ids && seen.found());
  for (std::size_t i = 0; i < exact.uv.size(); ++i) {
    fail_unless(std::hypot(seen.uv[i].u - exact.uv[i].u, seen.uv[i].v - exact.uv[i].v) < 1e-6);
  }
  const Pose first = to_pose(pose(0));
  fail_unless(first.translation == truth->boards[0].camera_from_board.translation);
}
GST_END_TEST;

GST_START_TEST(test_a_light_is_one_point_before_lamps) {
  Fixture f("board=dot lamps=3 noise=0 blur=0.7 motion=orbit", "video/x-raw,format=GRAY8");
  const Camera camera = default_camera({640, 480});
  const Board light = *parse_board("dot");
  const SE3 pose = Motion(MotionKind::kOrbit, camera, light, 0).camera_from_board(0);
  g_autoptr(GstBuffer) buffer = f.pull();
  const RenderOptions options = {.blur = 0.7, .lamps = 3};
  fail_unless(luma_of(buffer, f.h).pixels == render_board(camera, light, pose, options).pixels);
  const auto truth = gst::read_ground_truth(buffer);
  fail_unless(truth->boards[0].observation.ids == std::vector<int>{0});
}
GST_END_TEST;

GST_START_TEST(test_chroma_is_neutral) {
  Fixture f("", "video/x-raw,format=I420,width=65,height=33");
  g_autoptr(GstBuffer) buffer = f.pull();
  g_autoptr(GstCaps) caps = gst_pad_get_current_caps(f.h->sinkpad);
  GstVideoInfo info;
  GstVideoFrame frame;
  fail_unless(gst_video_info_from_caps(&info, caps));
  fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  for (guint c = 1; c < 3; ++c) {
    const auto* data = static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, c));
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 33; ++x) {
        fail_unless_equals_int(data[y * GST_VIDEO_FRAME_COMP_STRIDE(&frame, c) + x], 128);
      }
    }
  }
  gst_video_frame_unmap(&frame);
}
GST_END_TEST;

GST_START_TEST(test_a_conversion_keeps_the_grey_levels) {
  Fixture f("seed=1 noise=0 motion=static ! video/x-raw,format=I420 ! videoconvert",
            "video/x-raw,format=GRAY8,width=640,height=480");
  g_autoptr(GstBuffer) buffer = f.pull();
  check::Scene scene;
  const GrayImage found = luma_of(buffer, f.h);
  const GrayImage exact = expected(scene, 0, {.noise = 0, .blur = 0.7});
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) {
    fail_unless(std::abs(found.pixels[i] - exact.pixels[i]) <= 1);
  }
}
GST_END_TEST;

GST_START_TEST(test_times_come_from_the_frame_number) {
  Fixture f("motion=static", "video/x-raw,format=GRAY8,width=32,height=32,framerate=30000/1001");
  for (guint64 n = 0; n < 100; ++n) {
    g_autoptr(GstBuffer) buffer = f.pull();
    const guint64 time = gst_util_uint64_scale(n, 1001 * GST_SECOND, 30000);
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), time);
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer),
                              gst_util_uint64_scale(n + 1, 1001 * GST_SECOND, 30000));
    fail_unless_equals_uint64(GST_BUFFER_OFFSET(buffer), n);
  }
}
GST_END_TEST;

// Frames go on where they were; those of the new rate are as far apart as it says.
GST_START_TEST(test_times_go_on_at_another_frame_rate) {
  Fixture f("motion=static", "video/x-raw,format=GRAY8,width=32,height=32,framerate=30/1");
  GstClockTime next = 0;
  const auto pull = [&] {
    g_autoptr(GstBuffer) buffer = f.pull();
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), next);
    next = GST_BUFFER_PTS(buffer) + GST_BUFFER_DURATION(buffer);
    return GST_BUFFER_DURATION(buffer);
  };
  for (int n = 0; n < 9; ++n) pull();
  gst_harness_set_sink_caps_str(f.h, "video/x-raw,format=GRAY8,width=32,height=32,framerate=10/1");
  int slower = 0;
  for (int n = 0; n < 60 && slower < 9; ++n) slower += pull() == GST_SECOND / 10 ? 1 : 0;
  fail_unless_equals_int(slower, 9);
}
GST_END_TEST;

GST_START_TEST(test_the_seed_chooses_poses_and_noise_not_the_camera) {
  const char* caps = "video/x-raw,format=GRAY8,width=320,height=240";
  Fixture a("seed=3", caps);
  Fixture same("seed=3", caps);
  Fixture other("seed=4", caps);
  g_autoptr(GstBuffer) x = a.pull();
  g_autoptr(GstBuffer) y = same.pull();
  g_autoptr(GstBuffer) z = other.pull();
  fail_unless(luma_of(x, a.h).pixels == luma_of(y, same.h).pixels);
  fail_if(luma_of(x, a.h).pixels == luma_of(z, other.h).pixels);
  fail_unless(gst::read_ground_truth(x)->calibration == gst::read_ground_truth(z)->calibration);
}
GST_END_TEST;

GST_START_TEST(test_a_seek_gives_the_same_frames) {
  const char* caps = "video/x-raw,format=GRAY8,width=320,height=240,framerate=30/1";
  Fixture straight("seed=5", caps);
  GrayImage frame20;
  for (int n = 0; n <= 20; ++n) {
    g_autoptr(GstBuffer) buffer = straight.pull();
    if (n == 20) frame20 = luma_of(buffer, straight.h);
  }
  Fixture jump("seed=5", caps);
  gst_buffer_unref(jump.pull());
  const GstClockTime at = gst_util_uint64_scale(20, GST_SECOND, 30);
  fail_unless(gst_element_seek(jump.source, 1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                               GST_SEEK_TYPE_SET, static_cast<gint64>(at), GST_SEEK_TYPE_NONE, -1));
  // The harness keeps what was rendered before the seek.
  g_autoptr(GstBuffer) buffer = nullptr;
  do {
    gst_clear_buffer(&buffer);
    buffer = jump.pull();
  } while (!GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT));
  fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), at);
  fail_unless(luma_of(buffer, jump.h).pixels == frame20.pixels);
}
GST_END_TEST;

// The source keeps a seek in READY for its start, when no caps tell the frame rate yet.
GST_START_TEST(test_a_seek_before_the_start_is_kept) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "calibtestsrc name=src ! video/x-raw,format=GRAY8,width=32,height=32,framerate=30/1 ! "
      "fakesink",
      nullptr);
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "src");
  gst_element_set_state(pipeline, GST_STATE_READY);
  gst_element_send_event(
      source, gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_SET,
                                 2 * GST_SECOND, GST_SEEK_TYPE_NONE, -1));
  std::vector<GstClockTime> times;
  g_autoptr(GstPad) pad = gst_element_get_static_pad(source, "src");
  gst_pad_add_probe(
      pad, GST_PAD_PROBE_TYPE_BUFFER,
      [](GstPad*, GstPadProbeInfo* info, gpointer data) {
        static_cast<std::vector<GstClockTime>*>(data)->push_back(
            GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info)));
        return GST_PAD_PROBE_OK;
      },
      &times, nullptr);
  gst_element_set_state(pipeline, GST_STATE_PAUSED);
  gst_element_get_state(pipeline, nullptr, nullptr, 20 * GST_SECOND);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  fail_if(times.empty());
  fail_unless_equals_uint64(times.front(), 2 * GST_SECOND);
}
GST_END_TEST;

GST_START_TEST(test_plays_backwards_to_the_start) {
  Fixture f("motion=static num-buffers=100", "video/x-raw,format=GRAY8,width=32,height=32");
  gst_buffer_unref(f.pull());
  fail_unless(gst_element_seek(f.source, -1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                               GST_SEEK_TYPE_SET, 0, GST_SEEK_TYPE_SET, GST_SECOND / 2));
  GstClockTime before = GST_CLOCK_TIME_NONE;
  int count = 0;
  while (before != 0) {
    g_autoptr(GstBuffer) buffer = f.pull();
    // The harness keeps what was rendered before the seek.
    if (count == 0 && !GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT)) continue;
    fail_unless(GST_BUFFER_PTS(buffer) < GST_SECOND / 2);
    if (count > 0) fail_unless(GST_BUFFER_PTS(buffer) < before);
    before = GST_BUFFER_PTS(buffer);
    fail_unless(++count < 40);
  }
  fail_unless(count >= 15);
}
GST_END_TEST;

GST_START_TEST(test_live_waits_holds_poses_and_tells_its_latency) {
  Fixture f("is-live=true seed=2", "video/x-raw,format=GRAY8,width=160,height=120,framerate=10/1");
  gst_harness_use_testclock(f.h);
  gst_harness_play(f.h);
  std::vector<Pose> poses;
  for (guint64 n = 0; n < 12; ++n) {
    fail_unless(gst_harness_wait_for_clock_id_waits(f.h, 1, 30));
    fail_unless_equals_int(gst_harness_buffers_in_queue(f.h), 0);
    fail_unless(gst_harness_crank_single_clock_wait(f.h));
    g_autoptr(GstBuffer) buffer = gst_harness_pull(f.h);
    fail_unless_equals_uint64(GST_BUFFER_PTS(buffer), n * GST_SECOND / 10);
    poses.push_back(gst::read_ground_truth(buffer)->boards[0].camera_from_board);
  }
  for (std::size_t n = 1; n < poses.size(); ++n) {
    const bool held = poses[n].translation == poses[n - 1].translation;
    fail_unless(held == (n % 5 != 0), "frame %d", static_cast<int>(n));
  }
  fail_unless_equals_uint64(gst_harness_query_latency(f.h), GST_SECOND / 10);
}
GST_END_TEST;

GST_START_TEST(test_a_given_camera_is_used_and_scaled) {
  const char* keys =
      "calibration=fx=500,fy=501,cx=320,cy=239,k1=-0.2,k2=0.05,p1=0,p2=0,k3=0,width=640,height=480";
  Fixture same(keys);
  g_autoptr(GstBuffer) buffer = same.pull();
  const auto truth = parse_calibration(gst::read_ground_truth(buffer)->calibration);
  fail_unless(truth->image_size == (ImageSize{640, 480}));
  fail_unless(truth->find("fx")->value == 500);
  fail_unless(truth->find("k1")->value == -0.2);

  Fixture half(keys, "video/x-raw,width=320,height=240");
  g_autoptr(GstBuffer) small = half.pull();
  const auto scaled = parse_calibration(gst::read_ground_truth(small)->calibration);
  fail_unless(scaled->find("fx")->value == 250);
  fail_unless(scaled->find("cx")->value == 0.5 * 320.5 - 0.5);
}
GST_END_TEST;

GST_START_TEST(test_the_camera_is_written) {
  const check::TemporaryFolder folder;
  const std::string file = folder / "truth.json";
  Fixture f("ground-truth=" + file);
  gst_buffer_unref(f.pull());
  const auto written = read_calibration(file);
  fail_unless(written.has_value());
  fail_unless(Camera::make(*written)->parameters() == default_camera({640, 480}).parameters());
  fail_unless_equals_string(written->board.c_str(), "checkerboard:9x6:25mm");
}
GST_END_TEST;

struct Mistake {
  const char* properties;
  const char* caps;
  const char* said;
};
static const Mistake kMistakes[] = {
    {"board=chessboard:9x6:25mm", nullptr, "checkerboard:9x6:25mm"},
    {"board=checkerboard:9x6:25mm;checkerboard:5x4:10mm", nullptr, "one board"},
    {"calibration=/nowhere/cam.json", nullptr, "/nowhere/cam.json"},
    {"calibration=fx=-500,fy=500,cx=320,cy=240,width=640,height=480", nullptr, "focal"},
    {"calibration=fx=500,fy=500,cx=320,cy=240,width=640,height=480",
     "video/x-raw,width=640,height=360", "aspect"},
    {"ground-truth=/nowhere/truth.json", nullptr, "/nowhere/truth.json"},
};

GST_START_TEST(test_mistakes_are_errors_that_say_what_to_do) {
  const Mistake& mistake = kMistakes[__i__];
  Fixture f(mistake.properties, mistake.caps);
  gst_element_set_state(f.h->element, GST_STATE_PLAYING);
  for (int i = 0; i < 200 && f.bus.texts(GST_MESSAGE_ERROR).empty(); ++i) g_usleep(10000);
  const auto texts = f.bus.texts(GST_MESSAGE_ERROR);
  fail_if(texts.empty(), "no error for %s", mistake.properties);
  fail_unless(f.bus.says(GST_MESSAGE_ERROR, mistake.said), "%s", texts[0].c_str());
}
GST_END_TEST;

static Suite* calibtestsrc_suite() {
  Suite* suite = suite_create("calibtestsrc");
  TCase* tests = tcase_create("general");
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, test_defaults_are_a_vga_camera);
  tcase_add_loop_test(tests, test_pictures_are_what_the_library_renders, 0, G_N_ELEMENTS(kFormats));
  tcase_add_test(tests, test_a_rolling_shutter_shows_the_motion);
  tcase_add_test(tests, test_a_light_is_one_point_before_lamps);
  tcase_add_test(tests, test_chroma_is_neutral);
  tcase_add_test(tests, test_a_conversion_keeps_the_grey_levels);
  tcase_add_test(tests, test_times_come_from_the_frame_number);
  tcase_add_test(tests, test_times_go_on_at_another_frame_rate);
  tcase_add_test(tests, test_the_seed_chooses_poses_and_noise_not_the_camera);
  tcase_add_test(tests, test_a_seek_gives_the_same_frames);
  tcase_add_test(tests, test_a_seek_before_the_start_is_kept);
  tcase_add_test(tests, test_plays_backwards_to_the_start);
  tcase_add_test(tests, test_live_waits_holds_poses_and_tells_its_latency);
  tcase_add_test(tests, test_a_given_camera_is_used_and_scaled);
  tcase_add_test(tests, test_the_camera_is_written);
  tcase_add_loop_test(tests, test_mistakes_are_errors_that_say_what_to_do, 0,
                      G_N_ELEMENTS(kMistakes));
  return suite;
}

GST_CHECK_MAIN(calibtestsrc)
