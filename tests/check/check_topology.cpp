// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The elements among others: two of a kind, behind and before a tee, taken out while they work, and
// asked what belongs to others.

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <set>

#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "pipeline.hpp"
#include "undistort_fixture.hpp"

#include <gst/check/gstcheck.h>

using namespace calvin;
using check::Pipeline;

static bool same_bytes(GstBuffer* a, GstBuffer* b) {
  GstMapInfo map;
  fail_unless(gst_buffer_map(b, &map, GST_MAP_READ));
  const bool same =
      gst_buffer_get_size(a) == map.size && gst_buffer_memcmp(a, 0, map.data, map.size) == 0;
  gst_buffer_unmap(b, &map);
  return same;
}
static bool same_memory(GstBuffer* a, GstBuffer* b) {
  return gst_buffer_n_memory(a) == gst_buffer_n_memory(b) &&
         gst_buffer_peek_memory(a, 0) == gst_buffer_peek_memory(b, 0);
}

// ---- Two of a kind ------------------------------------------------------------------------------

GST_START_TEST(test_two_cameras_in_one_pipeline_are_solved_apart) {
  Pipeline p(
      "calibtestsrc num-buffers=20 seed=1 calibration=fx=500,fy=500,cx=320,cy=240,width=640,"
      "height=480 ! calibrate camera=left overlay=false ! fakesink "
      "calibtestsrc num-buffers=20 seed=2 calibration=fx=600,fy=600,cx=310,cy=250,width=640,"
      "height=480 ! calibrate camera=right overlay=false ! fakesink");
  std::map<std::string, double> fx;
  for (GstStructure* s : p.play("calib-result")) {
    gst_structure_get_double(s, "fx", &fx[gst_structure_get_string(s, "camera")]);
    gst_structure_free(s);
  }
  fail_unless_equals_int(fx.size(), 2);
  fail_unless(std::abs(fx["left"] - 500) < 3 && std::abs(fx["right"] - 600) < 3, "%f %f",
              fx["left"], fx["right"]);
}
GST_END_TEST;

// Each finds its own board, and the meta is the last one's; each solves what reaches it.
GST_START_TEST(test_two_of_each_in_a_row) {
  Pipeline p(
      "calibtestsrc num-buffers=12 ! calibdetect camera=one board=checkerboard:4x4:1m ! calibsolve "
      "! "
      "calibdetect camera=two name=second ! calibsolve name=last ! caliboverlay ! caliboverlay ! "
      "calibundistort enabled=false ! calibundistort enabled=false name=end ! fakesink");
  p.keep("last");
  std::set<std::string> cameras;
  for (GstStructure* s : p.play("calib-result")) {
    cameras.insert(gst_structure_get_string(s, "camera"));
    gst_structure_free(s);
  }
  fail_unless(cameras == std::set<std::string>{"two"});
  const auto seen = gst::read_observations(p.kept("last").back());
  fail_unless_equals_int(seen.size(), 1);
  fail_unless(seen[0].found() && seen[0].camera == "two");
  fail_unless_equals_int(gst::read_guidance(p.kept("last").back())->views, 12);
}
GST_END_TEST;

// ---- Tees ---------------------------------------------------------------------------------------

// What two branches share, neither may change: the one with the overlay draws on a copy of its own.
GST_START_TEST(test_behind_a_tee_nothing_upstream_is_changed_or_copied_without_need) {
  const std::string barrel = std::string("calibration=") + check::kBarrel;
  Pipeline p(
      "calibtestsrc num-buffers=6 name=source ! tee name=t "
      "t. ! queue ! calibdetect mode=sync name=detect ! calibsolve name=solve ! "
      "caliboverlay name=overlay ! fakesink "
      "t. ! queue ! calibundistort name=idle ! fakesink "
      "t. ! queue ! calibundistort name=busy " +
      barrel +
      " ! fakesink "
      "t. ! queue ! identity name=other ! fakesink");
  for (const char* name : {"source", "detect", "solve", "overlay", "idle", "busy", "other"}) {
    p.keep(name);
  }
  for (GstStructure* s : p.play("none")) gst_structure_free(s);
  Pipeline alone("calibtestsrc num-buffers=6 name=source ! fakesink");
  alone.keep("source");
  for (GstStructure* s : alone.play("none")) gst_structure_free(s);
  for (std::size_t n = 0; n < 6; ++n) {
    GstBuffer* truth = alone.kept("source").at(n);
    GstBuffer* source = p.kept("source").at(n);
    fail_unless(same_bytes(source, truth), "frame %d is changed", static_cast<int>(n));
    for (const char* name : {"detect", "solve", "idle", "other"}) {
      fail_unless(same_memory(p.kept(name).at(n), source), "%s copies", name);
    }
    for (const char* name : {"overlay", "busy"}) {
      GstBuffer* kept = p.kept(name).at(n);
      const bool works = g_str_equal(name, "busy") || CALVIN_HAVE_CAIRO;
      fail_unless(same_memory(kept, source) != works, "%s: whose memory?", name);
      fail_unless(same_bytes(kept, truth) != works, "%s: what was done?", name);
    }
    // A meta is the branch's own affair.
    fail_unless(gst::read_observations(p.kept("other").at(n)).empty());
    fail_unless_equals_int(gst::read_observations(p.kept("solve").at(n)).size(), 1);
  }
}
GST_END_TEST;

GST_START_TEST(test_before_a_tee_every_branch_gets_the_same_memory) {
  const std::string barrel = std::string("calibration=") + check::kBarrel;
  Pipeline p("calibtestsrc num-buffers=6 ! calibdetect mode=sync ! calibundistort " + barrel +
             " name=end ! tee name=t t. ! queue ! identity name=a ! fakesink "
             "t. ! queue ! calibsolve ! identity name=b ! fakesink");
  for (const char* name : {"end", "a", "b"}) p.keep(name);
  for (GstStructure* s : p.play("none")) gst_structure_free(s);
  for (std::size_t n = 0; n < 6; ++n) {
    for (const char* name : {"a", "b"}) {
      fail_unless(same_memory(p.kept(name).at(n), p.kept("end").at(n)), "%s", name);
      fail_unless_equals_int(gst::read_observations(p.kept(name).at(n)).size(), 1);
    }
  }
}
GST_END_TEST;

// Alone, the overlay draws into the very memory that came.
GST_START_TEST(test_the_overlay_draws_in_place) {
  std::vector<const GstMemory*> in;
  std::vector<const GstMemory*> out;
  Pipeline p(
      "calibtestsrc num-buffers=3 ! calibdetect mode=sync name=in ! caliboverlay name=out ! "
      "fakesink");
  const auto note = [&](const char* name, std::vector<const GstMemory*>* list) {
    g_autoptr(GstPad) pad = gst_element_get_static_pad(p.get(name), "src");
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer to) {
          static_cast<std::vector<const GstMemory*>*>(to)->push_back(
              gst_buffer_peek_memory(GST_PAD_PROBE_INFO_BUFFER(info), 0));
          return GST_PAD_PROBE_OK;
        },
        list, nullptr);
  };
  note("in", &in);
  note("out", &out);
  for (GstStructure* s : p.play("none")) gst_structure_free(s);
  fail_unless(in.size() == 3 && in == out);
}
GST_END_TEST;

// ---- Taken out while it works -------------------------------------------------------------------

// Unlinks an element between two frames, takes it to NULL and closes the gap.
static GstPadProbeReturn take_out(GstPad* pad, GstPadProbeInfo* /*info*/, gpointer data) {
  auto* done = static_cast<std::atomic<bool>*>(data);
  g_autoptr(GstPad) sink = gst_pad_get_peer(pad);
  g_autoptr(GstElement) element = gst_pad_get_parent_element(sink);
  g_autoptr(GstPad) src = gst_element_get_static_pad(element, "src");
  g_autoptr(GstPad) after = gst_pad_get_peer(src);
  g_autoptr(GstObject) bin = gst_object_get_parent(GST_OBJECT(element));
  gst_pad_unlink(pad, sink);
  gst_pad_unlink(src, after);
  const auto begin = std::chrono::steady_clock::now();
  gst_element_set_state(element, GST_STATE_NULL);
  const auto taken = std::chrono::steady_clock::now() - begin;
  gst_bin_remove(GST_BIN(bin), element);
  gst_pad_link(pad, after);
  // What is promised is 50 ms; an element that waits for a solve of many views takes seconds.
  *done = taken < std::chrono::milliseconds(500);
  return GST_PAD_PROBE_REMOVE;
}

static const char* const kWorking[] = {
    "calibdetect mode=async name=x",
    "calibdetect mode=sync name=x",
    "calibdetect ! calibsolve capture-mode=all name=x",
    "calibdetect ! calibsolve ! caliboverlay name=x",
    "calibundistort name=x calibration=fx=480,fy=478,cx=325,cy=236,k1=-0.2,width=640,height=480",
    "calibrate name=x capture-mode=all"};

GST_START_TEST(test_an_element_can_be_taken_out_while_frames_flow) {
  Pipeline p(
      "calibtestsrc is-live=true motion=hand ! video/x-raw,width=320,height=240 ! identity "
      "name=before ! " +
      std::string(kWorking[__i__]) + " ! identity name=after ! fakesink sync=false");
  p.keep("after");
  p.preroll(GST_STATE_PLAYING);
  for (int i = 0; i < 2000 && p.kept("after").size() < 10; ++i) g_usleep(10000);
  fail_unless(p.kept("after").size() >= 10);
  std::atomic<bool> done = false;
  g_autoptr(GstPad) sink = gst_element_get_static_pad(p.get("x"), "sink");
  g_autoptr(GstPad) before = gst_pad_get_peer(sink);
  gst_pad_add_probe(before, GST_PAD_PROBE_TYPE_IDLE, take_out, &done, nullptr);
  for (int i = 0; i < 500 && !done; ++i) g_usleep(10000);
  fail_unless(done, "it is not out, or not in time");
  const std::size_t then = p.kept("after").size();
  for (int i = 0; i < 1000 && p.kept("after").size() < then + 5; ++i) g_usleep(10000);
  fail_unless(p.kept("after").size() >= then + 5, "the frames stop");
}
GST_END_TEST;

// ---- Queries and events -------------------------------------------------------------------------

static const char* const kTransparent[] = {
    "calibdetect mode=async",
    "calibdetect mode=sync",
    "calibsolve",
    "caliboverlay",
    "calibundistort",
    "calibundistort calibration=fx=480,fy=478,cx=325,cy=236,k1=-0.2,width=640,height=480",
    "calibrate"};

// Whether a query has the same answer behind the element as at the source.
static void assert_passes(const Pipeline& p, const std::function<GstQuery*()>& make,
                          const std::function<std::string(GstQuery*)>& answer, const char* what) {
  g_autoptr(GstPad) source = gst_element_get_static_pad(p.get("source"), "src");
  g_autoptr(GstPad) sink = gst_element_get_static_pad(p.get("sink"), "sink");
  g_autoptr(GstQuery) at_source = make();
  g_autoptr(GstQuery) behind = make();
  fail_unless(gst_pad_query(source, at_source), "%s at the source", what);
  fail_unless(gst_pad_peer_query(sink, behind), "%s behind", what);
  const std::string expected = answer(at_source);
  const std::string found = answer(behind);
  fail_unless(found == expected, "%s: %s instead of %s", what, found.c_str(), expected.c_str());
}

GST_START_TEST(test_queries_pass_and_no_latency_is_added) {
  Pipeline p("calibtestsrc name=source is-live=true num-buffers=1000 ! " +
             std::string(kTransparent[__i__]) + " name=x ! fakesink name=sink");
  p.preroll(GST_STATE_PLAYING);
  g_autoptr(GstPad) in = gst_element_get_static_pad(p.get("x"), "sink");
  for (int i = 0; i < 1000 && !gst_pad_has_current_caps(in); ++i) g_usleep(10000);
  assert_passes(
      p, gst_query_new_latency,
      [](GstQuery* query) {
        gboolean live = FALSE;
        GstClockTime least = 0;
        GstClockTime most = 0;
        gst_query_parse_latency(query, &live, &least, &most);
        fail_unless(live && least == gst_util_uint64_scale(GST_SECOND, 1, 30));
        return std::to_string(least) + " " + std::to_string(most);
      },
      "LATENCY");
  assert_passes(
      p, [] { return gst_query_new_convert(GST_FORMAT_BYTES, 460800, GST_FORMAT_TIME); },
      [](GstQuery* query) {
        gint64 value = 0;
        gst_query_parse_convert(query, nullptr, nullptr, nullptr, &value);
        fail_unless(value > 0);
        return std::to_string(value);
      },
      "CONVERT");
  assert_passes(
      p, [] { return gst_query_new_seeking(GST_FORMAT_TIME); },
      [](GstQuery* query) {
        gboolean seekable = FALSE;
        gst_query_parse_seeking(query, nullptr, &seekable, nullptr, nullptr);
        return std::to_string(seekable);
      },
      "SEEKING");
  g_autoptr(GstPad) sink = gst_element_get_static_pad(p.get("sink"), "sink");
  gint64 position = -1;
  fail_unless(gst_pad_peer_query_position(sink, GST_FORMAT_TIME, &position) && position >= 0);
}
GST_END_TEST;

GST_START_TEST(test_seeks_pass_to_the_source) {
  Pipeline p("calibtestsrc name=source ! " + std::string(kTransparent[__i__]) +
             " name=x ! fakesink name=sink");
  p.keep("x");
  p.preroll();
  const auto seek = [&](GstFormat format, double rate, gint64 start, gint64 stop) {
    return gst_element_seek(GST_ELEMENT(p.bin()), rate, format,
                            static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE),
                            GST_SEEK_TYPE_SET, start, GST_SEEK_TYPE_SET, stop) != FALSE;
  };
  constexpr gint64 kFrame = 640 * 480 * 3 / 2;
  fail_unless(seek(GST_FORMAT_BYTES, 1, 30 * kFrame, -1));  // the source knows what that is
  p.preroll();
  fail_unless(GST_BUFFER_PTS(p.kept("x").back()) == GST_SECOND);
  fail_unless(seek(GST_FORMAT_TIME, 1, 2 * GST_SECOND, -1));
  p.preroll();
  fail_unless(GST_BUFFER_PTS(p.kept("x").back()) == 2 * GST_SECOND);
  fail_unless(seek(GST_FORMAT_TIME, -1, 0, GST_SECOND));
  p.preroll();
  fail_unless(GST_BUFFER_PTS(p.kept("x").back()) < GST_SECOND);
}
GST_END_TEST;

static Suite* topology_suite() {
  Suite* suite = suite_create("topology");
  TCase* tc = tcase_create("general");
  suite_add_tcase(suite, tc);
  tcase_add_checked_fixture(tc, gst::register_metas, nullptr);
  tcase_add_test(tc, test_two_cameras_in_one_pipeline_are_solved_apart);
  tcase_add_test(tc, test_two_of_each_in_a_row);
  tcase_add_test(tc, test_behind_a_tee_nothing_upstream_is_changed_or_copied_without_need);
  tcase_add_test(tc, test_before_a_tee_every_branch_gets_the_same_memory);
  tcase_add_test(tc, test_the_overlay_draws_in_place);
  tcase_add_loop_test(tc, test_an_element_can_be_taken_out_while_frames_flow, 0,
                      G_N_ELEMENTS(kWorking));
  tcase_add_loop_test(tc, test_queries_pass_and_no_latency_is_added, 0, G_N_ELEMENTS(kTransparent));
  tcase_add_loop_test(tc, test_seeks_pass_to_the_source, 0, G_N_ELEMENTS(kTransparent));
  return suite;
}

GST_CHECK_MAIN(topology)
