// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How calibsolve watches its camera, once a second and on no streaming thread: has the lens read,
// on a further thread, for a driver may never answer, and tells its session whether frames come.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <utility>

#include "calvin/device/lens.hpp"
#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

namespace {

// Whether no frame is on its way through the element: one that whoever is downstream holds up keeps
// the camera's from coming, and so does the end of the stream that waits for a solve.
bool is_between_frames(GstElement* element) {
  g_autoptr(GstPad) sink = gst_element_get_static_pad(element, "sink");
  if (sink == nullptr || g_rec_mutex_trylock(GST_PAD_GET_STREAM_LOCK(sink)) == FALSE) return false;
  g_rec_mutex_unlock(GST_PAD_GET_STREAM_LOCK(sink));
  return true;
}

// False where it was asked to stop.
bool wait_a_second(const std::stop_token& stop) {
  std::mutex lock;
  std::condition_variable_any woken;
  std::unique_lock guard(lock);
  woken.wait_for(guard, stop, std::chrono::seconds(1), [] { return false; });
  return !stop.stop_requested();
}

}  // namespace

Status CalibSolver::begin_watch() {
  {
    const std::lock_guard guard(lock_);
    if (std::exchange(watching_, true)) return {};
  }
  if (Status started = watcher_.start(); !started) return started;
  watch_on();
  return {};
}

// A job for each second: one without an end would not be known at the end of the program.
void CalibSolver::watch_on() {
  watcher_.offer([this](const std::stop_token& /*stop*/) { begin_second(); });
}

void CalibSolver::begin_second() {
  look_at_lens();
  watcher_.offer([this](const std::stop_token& stop) {
    if (!wait_a_second(stop)) return;
    end_second(stop);
    begin_second();
  });
}

void CalibSolver::watch_stream(bool live) {
  {
    const std::lock_guard guard(lock_);
    is_live_ = live;
    stream_runs_ = true;
  }
  if (!live) return;
  worker_.give_way();
  updater_.give_way();
  // A session goes on unwatched.
  if (const Status begun = begin_watch(); !begun) post_warning(element_, begun.error());
}

void CalibSolver::set_frame_duration(GstClockTime duration) {
  const std::lock_guard guard(lock_);
  session_.set_frame_duration(duration);
}

void CalibSolver::frame_came() {
  const std::lock_guard guard(lock_);
  session_.frame_came();
  stream_runs_ = true;
}

void CalibSolver::expect_no_frame() {
  const std::lock_guard guard(lock_);
  stream_runs_ = false;
}

void CalibSolver::end_second(const std::stop_token& stop) {
  const bool free = GST_STATE(element_) == GST_STATE_PLAYING && is_between_frames(element_);
  {
    const std::lock_guard guard(lock_);
    if (stop.stop_requested()) return;
    session_.second_passed(free && is_live_ && stream_runs_);
  }
  post_notices(watcher_, stop);
}

void CalibSolver::look_at_lens() {
  const bool idle = lens_reader_.idle();
  std::string node;
  {
    const std::lock_guard guard(lock_);
    node = session_.lens_node();
    if (!node.empty() && !idle) session_.wait_for_lens();
  }
  if (node.empty() || !idle) return;
  lens_reader_.offer([this, node](const std::stop_token& stop) { read_lens(node, stop); });
}

void CalibSolver::read_lens(const std::string& node, const std::stop_token& stop) {
  const auto read = calvin::read_lens(node);
  GST_LOG_OBJECT(element_, "the lens of %s: %s", node.c_str(),
                 read ? "read" : read.error().message.c_str());
  {
    const std::lock_guard guard(lock_);
    // Of another run, or of before a flush.
    if (stop.stop_requested()) return;
    session_.see_lens(read);
  }
  post_notices(lens_reader_, stop);
}

}  // namespace calvin::gst
