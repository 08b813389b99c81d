// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every kind of bad input of the table: the message that says what is wrong and what to do, and the
// state that the element is in afterwards.

#include "bad_streams.hpp"
#include "calvin_config.h"

using namespace calvin;
using check::BadInput;
using check::InputFixture;
using check::Needs;

static constexpr char kDrawsNothing[] = "This build draws nothing on the video";

static const std::vector<BadInput>& bad_input() {
  static const auto kAll = [] {
    std::vector<BadInput> all = check::bad_settings();
    all.insert(all.end(), check::bad_streams().begin(), check::bad_streams().end());
    return all;
  }();
  return kAll;
}

static std::string all_texts(InputFixture& fixture, GstMessageType type) {
  std::string all;
  for (const std::string& text : fixture.bus.texts(type)) all += text + "\n";
  return all;
}

// A build that lacks what the input is for says that instead, and goes on or stops all the same.
static BadInput answered_by_this_build(BadInput bad) {
  if (bad.needs == Needs::kFormats && !CALVIN_HAVE_FORMATS) {
    bad.says = "it was made without yaml-cpp and pugixml";
    bad.advice = "-Dformats=enabled";
  } else if (bad.needs == Needs::kToml && !CALVIN_HAVE_FORMATS) {
    bad.says = "it was made without toml++";
    bad.advice = "-Dformats=enabled";
  } else if (bad.needs == Needs::kDrawing && !CALVIN_HAVE_CAIRO) {
    bad.says = kDrawsNothing;
    bad.advice = "-Ddraw=enabled";
  }
  return bad;
}

GST_START_TEST(test_bad_input_is_answered) {
  const BadInput bad = answered_by_this_build(bad_input().at(static_cast<std::size_t>(__i__)));
  InputFixture fixture(bad);
  bad.give(fixture, bad.input);
  const GstMessageType type = fixture.goes_on() ? GST_MESSAGE_WARNING : GST_MESSAGE_ERROR;
  const std::string said = all_texts(fixture, type);
  fail_unless(said.find(bad.says) != std::string::npos, "%s: '%s' is not in: %s", bad.what,
              bad.says, said.c_str());
  fail_unless(said.find(bad.advice) != std::string::npos, "%s: '%s' is not in: %s", bad.what,
              bad.advice, said.c_str());
  if (fixture.goes_on()) {
    const std::string errors = all_texts(fixture, GST_MESSAGE_ERROR);
    fail_unless(errors.empty(), "%s: %s", bad.what, errors.c_str());
  }
}
GST_END_TEST;

GST_START_TEST(test_there_are_a_hundred_kinds) {
  std::vector<std::string> kinds;
  for (const BadInput& bad : bad_input()) kinds.push_back(bad.what);
  std::sort(kinds.begin(), kinds.end());
  fail_unless(std::adjacent_find(kinds.begin(), kinds.end()) == kinds.end());
  fail_unless(kinds.size() >= 100, "%d", static_cast<int>(kinds.size()));
}
GST_END_TEST;

// Odd but allowed: the frames go on, and nobody complains.
struct Harmless {
  const char* caps;
  GstFormat segment;
  GstClockTimeDiff step;  // ns from frame to frame; 0: no timestamps
};
static const Harmless kHarmless[] = {
    {"video/x-raw,format=NV12,width=64,height=48", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=640,height=480,framerate=0/1", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=640,height=480,framerate=30/1", GST_FORMAT_TIME, 0},
    {"video/x-raw,format=GRAY8,width=640,height=480,framerate=30/1", GST_FORMAT_TIME, -GST_SECOND},
    {"video/x-raw,format=GRAY8,width=640,height=480,framerate=30/1", GST_FORMAT_BYTES, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=640,height=480,framerate=30/1", GST_FORMAT_DEFAULT,
     GST_MSECOND},
    {"video/x-raw,format=YUY2,width=641,height=479,framerate=30/1", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=2,height=2,framerate=30/1", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=I420,width=3,height=2,framerate=30/1", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=1,height=2,framerate=30/1", GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw(meta:GstVideoOverlayComposition),format=I420,width=64,height=48,framerate=30/1",
     GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw(memory:SystemMemory,meta:GstVideoOverlayComposition),format=I420,width=64,"
     "height=48,framerate=30/1",
     GST_FORMAT_TIME, GST_MSECOND},
    {"video/x-raw,format=GRAY8,width=65000,height=2,framerate=30/1", GST_FORMAT_TIME, GST_MSECOND}};
static const char* const kElements[] = {
    "calibdetect mode=sync max-rate=5 post-messages=true",
    "calibdetect mode=async",
    "calibsolve",
    "caliboverlay",
    "calibrate",
    "calibundistort",
    "calibundistort calibration=fx=48000,fy=47800,cx=0,cy=0,k1=-0.28"};

static void assert_passes(const char* text, const Harmless& odd) {
  GstElement* element = check::make_element(text);
  check::Bus bus(element);
  GstHarness* h = check::harness_of(element);
  g_autoptr(GstCaps) caps = gst_caps_from_string(odd.caps);
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps));
  gst_pad_push_event(h->srcpad, gst_event_new_stream_start("odd"));
  gst_pad_push_event(h->srcpad, gst_event_new_caps(caps));
  GstSegment segment;
  gst_segment_init(&segment, odd.segment);
  gst_pad_push_event(h->srcpad, gst_event_new_segment(&segment));
  for (int n = 0; n < 4; ++n) {
    GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
    gst_buffer_memset(buffer, 0, 100, info.size);
    if (odd.step != 0) {
      GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(10 * GST_SECOND + n * odd.step);
    }
    fail_unless_equals_int(gst_pad_push(h->srcpad, buffer), GST_FLOW_OK);
  }
  gst_harness_push_event(h, gst_event_new_eos());
  fail_unless_equals_int(gst_harness_buffers_in_queue(h), 4);
  fail_unless(bus.texts(GST_MESSAGE_ERROR).empty(), "%s at %s", text, odd.caps);
  for (const std::string& warning : bus.texts(GST_MESSAGE_WARNING)) {
    // Nothing is calibrated, frames of one column are no pictures, and Cairo may be missing.
    fail_unless(warning.find("No calibration") == 0 || warning.find("Frames of 1x2 px") == 0 ||
                    (!CALVIN_HAVE_CAIRO && warning.find(kDrawsNothing) == 0),
                "%s: %s", text, warning.c_str());
  }
  bus.detach();
  gst_harness_teardown(h);
}

GST_START_TEST(test_what_is_odd_but_harmless_passes) {
  for (const char* text : kElements) assert_passes(text, kHarmless[__i__]);
}
GST_END_TEST;

static Suite* bad_input_suite() {
  Suite* suite = suite_create("bad_input");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_loop_test(tc, test_bad_input_is_answered, 0, static_cast<int>(bad_input().size()));
  tcase_add_loop_test(tc, test_what_is_odd_but_harmless_passes, 0, G_N_ELEMENTS(kHarmless));
  tcase_add_test(tc, test_there_are_a_hundred_kinds);
  return suite;
}

GST_CHECK_MAIN(bad_input)
