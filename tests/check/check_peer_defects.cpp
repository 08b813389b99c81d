// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What was measured to go wrong in GStreamer's cameracalibrate 1.22, numbered P1 to P19, does not
// go wrong here. In this file: what is solved, what is taken and where the results go. P7 to P9 are
// in check_peer_defects_live.cpp, P13 to P18 in check_peer_defects_undistort.cpp.

#include <atomic>
#include <cmath>
#include <set>

#include "calvin/io/calibration_io.hpp"
#include "common/calibration_event.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::get;
using Fixture = check::SolveFixture;

static check::Scene scene_of(const char* model, const std::vector<double>& parameters) {
  const ImageSize size = {640, 480};
  return {.size = size, .camera = Camera::make(model, size, parameters).value()};
}
// fx and fy differ as those of real cameras do.
static check::Scene barrel() {
  return scene_of("brown5", {520, 518, 325, 236, -0.28, 0.09, 0.0005, -0.0007, 0});
}

static GstStructure* sigmas_of(const GstStructure* result) {
  GstStructure* sigma = nullptr;
  gst_structure_get(result, "sigma", GST_TYPE_STRUCTURE, &sigma, nullptr);
  fail_unless(sigma != nullptr);
  return sigma;
}

// Every parameter lies within five of its own sigmas of the truth.
static void assert_true(const GstStructure* result, const Camera& truth) {
  g_autoptr(GstStructure) sigma = sigmas_of(result);
  const auto names = parameter_names(truth.model());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string name(names[i]);
    const double error = get(result, name.c_str()) - truth.parameters()[i];
    fail_unless(std::abs(error) < 5 * get(sigma, name.c_str()), "%s is off by %f", name.c_str(),
                error);
  }
}

// The final result of a whole pipeline; the caller frees it.
static GstStructure* run(const std::string& line) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(line.c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  GstStructure* last = nullptr;
  for (bool running = true; running;) {
    g_autoptr(GstMessage) message = gst_bus_timed_pop(bus, 60 * GST_SECOND);
    fail_unless(message != nullptr, "%s does not end", line.c_str());
    fail_if(GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR, "%s fails", line.c_str());
    running = GST_MESSAGE_TYPE(message) != GST_MESSAGE_EOS;
    const GstStructure* s = gst_message_get_structure(message);
    if (s == nullptr || !gst_structure_has_name(s, "calib-result")) continue;
    g_clear_pointer(&last, gst_structure_free);
    last = gst_structure_copy(s);
  }
  gst_bus_set_flushing(bus, TRUE);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  fail_unless(last != nullptr, "%s gives no result", line.c_str());
  fail_unless_equals_string(gst_structure_get_string(last, "state"), "final");
  return last;
}

// P1: use-fisheye aborts.
GST_START_TEST(test_p01_a_fisheye_is_solved) {
  const check::Scene fisheye = scene_of("fisheye", {260, 259, 318, 242, 0.02, -0.005, 0, 0});
  Fixture f("model=fisheye", fisheye);
  f.push_views(45);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr);
  assert_true(r, fisheye.camera);
  fail_unless(std::abs(get(r, "fx") - 260) < 0.5 && get(r, "rms") < 0.2);
}
GST_END_TEST;

GST_START_TEST(test_p01_a_fisheye_is_solved_from_its_pictures) {
  g_autoptr(GstStructure) r =
      run("calibtestsrc num-buffers=40 calibration=fx=260,fy=259,cx=318,cy=242,k1=0.02,k2=-0.005,"
          "k3=0,k4=0,width=640,height=480,model=fisheye ! calibdetect ! calibsolve model=fisheye ! "
          "fakesink");
  fail_unless_equals_string(gst_structure_get_string(r, "model"), "fisheye");
  fail_unless(std::abs(get(r, "fx") - 260) < 1 && std::abs(get(r, "cx") - 318) < 1, "%f %f",
              get(r, "fx"), get(r, "cx"));
}
GST_END_TEST;

// P2: the options that hold parameters have no effect.
GST_START_TEST(test_p02_what_is_fixed_stays_fixed) {
  for (const bool tangential : {true, false}) {
    Fixture f(tangential ? "fix=p1,p2" : "fix=center", barrel());
    f.push_views(25);
    f.eos();
    const GstStructure* r = f.result("final");
    fail_unless(r != nullptr);
    fail_unless((get(r, "p1") == 0) == tangential && (get(r, "p2") == 0) == tangential);
    fail_unless((get(r, "cx") == 319.5) == !tangential && (get(r, "cy") == 239.5) == !tangential);
    g_autoptr(GstStructure) sigma = sigmas_of(r);
    fail_unless(gst_structure_has_field(sigma, tangential ? "cx" : "p1"));
    fail_if(gst_structure_has_field(sigma, tangential ? "p1" : "cx"));
  }
}
GST_END_TEST;

// P3: the ratio of the focal lengths is always held, and freeing it aborts.
GST_START_TEST(test_p03_the_aspect_ratio_is_free_unless_it_is_fixed) {
  for (const bool fixed : {false, true}) {
    Fixture f(fixed ? "fix=aspect" : "", barrel());
    f.push_views(25);
    f.eos();
    const GstStructure* r = f.result("final");
    fail_unless(r != nullptr);
    if (fixed) {
      fail_unless_equals_float(get(r, "fx"), get(r, "fy"));
    } else {
      assert_true(r, f.scene.camera);
      const double difference = get(r, "fx") - get(r, "fy");
      fail_unless(std::abs(difference - 2) < 0.3, "fx and fy differ by %f", difference);
    }
  }
}
GST_END_TEST;

// P4: grey video, which the caps allow, aborts at the first board.
GST_START_TEST(test_p04_grey_video_is_calibrated) {
  g_autoptr(GstStructure) r =
      run("calibtestsrc num-buffers=25 ! video/x-raw,format=GRAY8 ! calibrate ! fakesink");
  const Camera truth = default_camera({640, 480});
  fail_unless(std::abs(get(r, "fx") - truth.fx()) < 2, "%f", get(r, "fx"));
}
GST_END_TEST;

// P5: the delay between two samples is measured in the processor's time.
GST_START_TEST(test_p05_rates_are_of_stream_time) {
  GstElement* element = check::make_element("calibdetect mode=sync max-rate=2.5");
  GstHarness* h = check::harness_of(element);
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", {64, 48}));
  for (int n = 0; n < 150; ++n) {  // 5 s of video, in next to no time
    gst_harness_push(h, check::frame_of(GrayImage(64, 48, 90), "GRAY8", n));
  }
  g_autoptr(GstStructure) stats = nullptr;
  g_object_get(element, "stats", &stats, nullptr);
  guint64 detections = 0;
  gst_structure_get_uint64(stats, "detections", &detections);
  fail_unless(detections >= 12 && detections <= 13, "%" G_GUINT64_FORMAT, detections);
  gst_harness_teardown(h);
}
GST_END_TEST;

// P6: identical frames in succession are taken.
GST_START_TEST(test_p06_a_view_that_was_taken_is_not_taken_again) {
  Fixture f("", barrel(), "");  // a harness is live, and a live camera's views are chosen
  for (int i = 0; i < 30; ++i) gst_buffer_unref(f.push_observation(f.seen(3), i));
  g_autoptr(GstBuffer) out = f.push_observation(f.seen(3), 30);
  fail_unless_equals_int(gst::read_guidance(out)->views, 1);
}
GST_END_TEST;

// P10: no message, no notify, nothing in a file; an event that only a neighbour sees.
GST_START_TEST(test_p10_the_result_is_on_the_bus_in_a_file_in_a_notify_and_in_an_event) {
  check::TemporaryFolder folder;
  Fixture f("location=" + folder / "cam.json");
  std::atomic<int> notified = 0;
  g_signal_connect_swapped(f.element, "notify::calibration",
                           G_CALLBACK(+[](std::atomic<int>* count) { ++*count; }), &notified);
  f.push_views(12);
  f.eos();
  const GstStructure* r = f.result("final");
  fail_unless(r != nullptr && notified > 0);
  const double fx = get(r, "fx");
  g_autofree char* json = nullptr;
  g_object_get(f.element, "calibration", &json, nullptr);
  g_autoptr(GstEvent) sticky =
      gst_pad_get_sticky_event(f.h->sinkpad, GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, 0);
  fail_unless(sticky != nullptr);
  const auto event = gst::parse_calibration_event(sticky);
  for (const auto& read : {read_calibration(folder / "cam.json"), parse_calibration(json),
                           parse_calibration(event.value().json)}) {
    fail_unless(read.has_value());
    fail_unless_equals_float(read->find("fx")->value, fx);
    fail_unless(read->image_size == f.scene.size && read->rms && read->expected_error);
  }
}
GST_END_TEST;

// P12: after success or failure nothing more is captured until the element goes through READY.
GST_START_TEST(test_p12_it_solves_again_after_a_success) {
  Fixture f("max-views=12", barrel());
  f.push_views(12);
  for (int i = 0; i < 1000 && f.result("final") == nullptr; ++i) g_usleep(10000);
  const GstStructure* first = f.result("final");
  fail_unless(first != nullptr);
  g_signal_emit_by_name(f.element, "reset");
  for (int n = 12; n < 24; ++n) gst_buffer_unref(f.push(n));
  f.eos();
  const GstStructure* second = f.result("final");
  fail_unless(second != nullptr && second != first);
  assert_true(second, f.scene.camera);
  fail_if(get(first, "fx") == get(second, "fx"));
}
GST_END_TEST;

GST_START_TEST(test_p12_it_solves_after_a_failure) {
  Fixture f("", barrel());
  for (int i = 0; i < 10; ++i) gst_buffer_unref(f.push_observation(f.seen(3), i));
  g_signal_emit_by_name(f.element, "solve");
  g_usleep(200000);
  fail_unless(f.result("final") == nullptr);
  for (int n = 10; n < 35; ++n) gst_buffer_unref(f.push(n));
  f.eos();
  fail_unless(f.result("final") != nullptr);
  fail_unless(std::abs(get(f.result("final"), "fx") - 520) < 2);
  fail_unless(f.bus.texts(GST_MESSAGE_ERROR).empty());
}
GST_END_TEST;

// P19: one kind of board at a time, no observations for others to use. Boards that are partly out
// of the picture are not used yet, but neither is anything wrong said of them.
static GrayImage side_by_side(const GrayImage& left, const GrayImage& right) {
  GrayImage both(left.width + right.width, left.height);
  check::paste(left, both, 0, 0);
  check::paste(right, both, left.width, 0);
  return both;
}

static std::vector<Observation> detect(const GrayImage& picture, const char* board) {
  GstElement* element = check::make_element(std::string("calibdetect mode=sync board=") + board);
  GstHarness* h = check::harness_of(element);
  gst_harness_set_src_caps(h, check::caps_of("GRAY8", {picture.width, picture.height}));
  g_autoptr(GstBuffer) out = gst_harness_push_and_pull(h, check::frame_of(picture, "GRAY8", 0));
  auto found = gst::read_observations(out);
  gst_harness_teardown(h);
  return found;
}

GST_START_TEST(test_p19_several_boards_at_once_and_their_observations) {
  const check::Scene nine;
  const check::Scene seven{.board = parse_board("checkerboard:7x4:30mm").value()};
  const auto found = detect(side_by_side(nine.picture(0), seven.picture(2)),
                            "checkerboard:9x6:25mm;checkerboard:7x4:30mm");
  fail_unless_equals_int(found.size(), 2);
  const Observation truths[] = {nine.truth(0), seven.truth(2)};
  for (std::size_t b = 0; b < 2; ++b) {
    fail_unless_equals_int(found[b].ids.size(), truths[b].ids.size());
    for (std::size_t i = 0; i < found[b].ids.size(); ++i) {
      const Pixel want = truths[b].uv[static_cast<std::size_t>(found[b].ids[i])];
      fail_unless(std::hypot(found[b].uv[i].u - want.u - (b == 1 ? 640 : 0),
                             found[b].uv[i].v - want.v) < 0.3);
    }
  }
}
GST_END_TEST;

GST_START_TEST(test_p19_half_a_board_is_not_taken_for_another) {
  const check::Scene scene;
  for (int n = 0; n < 5; ++n) {
    const GrayImage whole = scene.picture(n);
    fail_unless(detect(whole, kDefaultBoard.data()).at(0).found());
    double middle = 0;
    for (const Pixel& p : scene.truth(n).uv) middle += p.u / 54;
    GrayImage half(static_cast<int>(middle), whole.height);
    check::paste(whole, half, 0, 0);
    const Observation part = detect(half, kDefaultBoard.data()).at(0);
    fail_unless(part.uv.size() < 54);
    // What is found of it are corners of the board, each once, and none is taken for another one
    // unless the labelling is said to be open.
    const auto truth = scene.truth(n).uv;
    std::set<std::size_t> known;
    for (std::size_t i = 0; i < part.uv.size(); ++i) {
      for (std::size_t k = 0; k < truth.size(); ++k) {
        if (std::hypot(part.uv[i].u - truth[k].u, part.uv[i].v - truth[k].v) > 0.3) continue;
        known.insert(k);
        fail_unless(!part.ambiguous.empty() || part.ids[i] == static_cast<int>(k));
      }
    }
    fail_unless_equals_int(known.size(), part.uv.size());
  }
}
GST_END_TEST;

static Suite* peer_defects_suite() {
  Suite* suite = suite_create("peer_defects");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_p01_a_fisheye_is_solved);
  tcase_add_test(tc, test_p01_a_fisheye_is_solved_from_its_pictures);
  tcase_add_test(tc, test_p02_what_is_fixed_stays_fixed);
  tcase_add_test(tc, test_p03_the_aspect_ratio_is_free_unless_it_is_fixed);
  tcase_add_test(tc, test_p04_grey_video_is_calibrated);
  tcase_add_test(tc, test_p05_rates_are_of_stream_time);
  tcase_add_test(tc, test_p06_a_view_that_was_taken_is_not_taken_again);
  tcase_add_test(tc, test_p10_the_result_is_on_the_bus_in_a_file_in_a_notify_and_in_an_event);
  tcase_add_test(tc, test_p12_it_solves_again_after_a_success);
  tcase_add_test(tc, test_p12_it_solves_after_a_failure);
  tcase_add_test(tc, test_p19_several_boards_at_once_and_their_observations);
  tcase_add_test(tc, test_p19_half_a_board_is_not_taken_for_another);
  return suite;
}

GST_CHECK_MAIN(peer_defects)
