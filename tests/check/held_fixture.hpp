// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calibsolve with a worker that is held at a place of the test's choice. For one file of a program:
// functions of the libraries are replaced.
#pragma once

#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "calvin/io/calibration_io.hpp"
#include "common/calibration_event.hpp"
#include "gate.hpp"
#include "solve_fixture.hpp"

#include <gst/check/gstcheck.h>

// ---- Where the worker is held -------------------------------------------------------------------

namespace calvin::check::held {

inline Gate solved;     // a solution is there, and nobody knows of it yet
inline Gate written;    // a file has its bytes, but not its name; then it has the name too
inline Gate unsolved;   // there is no solution, and nobody knows of it yet
inline Gate progress;   // the bus has a message calib-progress of the worker
inline Gate announced;  // the property `calibration` is notified
inline std::thread::id tester;

}  // namespace calvin::check::held

// These stand before the libraries' own.
extern "C" {
GST_EXPORT GDateTime* g_date_time_new_now_utc() {
  if (std::this_thread::get_id() != calvin::check::held::tester) calvin::check::held::solved.pass();
  return g_date_time_new_from_unix_utc(g_get_real_time() / G_USEC_PER_SEC);
}
GST_EXPORT int fsync(int fd) {
  calvin::check::held::written.pass();
  return static_cast<int>(syscall(SYS_fsync, fd));
}
}

namespace calvin::check::held {

inline void hold_where_unsolved(GstDebugCategory* category, GstDebugLevel, const char*, const char*,
                                int, GObject*, GstDebugMessage* message, gpointer) {
  const bool ours = g_strcmp0(gst_debug_category_get_name(category), "calibsolve") == 0;
  if (ours && std::strstr(gst_debug_message_get(message), "no solution") != nullptr) {
    unsolved.pass();
  }
}

inline GstBusSyncReply hold_at_progress(GstBus*, GstMessage* message, gpointer) {
  const GstStructure* s = gst_message_get_structure(message);
  if (s != nullptr && gst_structure_has_name(s, "calib-progress") &&
      std::this_thread::get_id() != tester) {
    progress.pass();
  }
  return GST_BUS_PASS;
}

inline void set_up() {
  tester = std::this_thread::get_id();
  gst::register_metas();
  for (Gate* gate : {&solved, &written, &unsolved, &progress, &announced}) gate->open();
}

// Elements that are not gone yet: what a handler holds may be the last reference.
inline std::atomic<int> living;

inline void tear_down() {
  for (int i = 0; i < 1000 && living > 0; ++i) g_usleep(10000);
  fail_unless_equals_int(living, 0);
  for (Gate* gate : {&solved, &written, &unsolved, &progress, &announced}) {
    fail_if(gate->forced(), "the test waited for what waited for it");
  }
}

}  // namespace calvin::check::held

namespace calvin::check {

// A fixture whose worker may be held at what it tells.
struct HeldFixture : SolveFixture {
  explicit HeldFixture(const std::string& properties = "") : SolveFixture(properties) {
    ++held::living;
    g_object_weak_ref(
        G_OBJECT(element), [](gpointer, GObject*) { --held::living; }, nullptr);
    g_autoptr(GstBus) posts = gst_element_get_bus(element);
    gst_bus_set_sync_handler(posts, held::hold_at_progress, nullptr, nullptr);
    g_signal_connect(element, "notify::calibration",
                     G_CALLBACK(+[](GObject*, GParamSpec*, gpointer) { held::announced.pass(); }),
                     nullptr);
  }
  void segment() {
    GstSegment s;
    gst_segment_init(&s, GST_FORMAT_TIME);
    gst_harness_push_event(h, gst_event_new_segment(&s));
  }
  void flush_stop() {
    gst_harness_push_event(h, gst_event_new_flush_stop(TRUE));
    segment();
  }
  // From here on frames and boards have half the size.
  void halve() {
    scene = check::Scene{{320, 240}};
    gst_harness_set_src_caps(h, check::caps_of("GRAY8", scene.size));
  }
  std::string calibration() {
    g_autofree char* json = nullptr;
    g_object_get(element, "calibration", &json, nullptr);
    return json != nullptr ? json : "";
  }
  // The views of the calibration that downstream knows, or -1.
  int views_announced() {
    g_autoptr(GstPad) src = gst_element_get_static_pad(element, "src");
    g_autoptr(GstEvent) event =
        gst_pad_get_sticky_event(src, GST_EVENT_CUSTOM_DOWNSTREAM_STICKY, 0);
    if (event == nullptr) return -1;
    return static_cast<int>(
        parse_calibration(gst::parse_calibration_event(event)->json)->views.size());
  }
  std::vector<int> views_of_results() {
    std::vector<int> all;
    for (const GstStructure* s : bus.named("calib-result")) {
      all.push_back(0);
      gst_structure_get_int(s, "views", &all.back());
    }
    return all;
  }
};

}  // namespace calvin::check
