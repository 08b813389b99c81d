// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points of calibsolve: they wait for a frame, are told to the session and announced.

#include <utility>

#include "common/points/point_values.hpp"
#include "solve/calib_solver.hpp"
#include "solve/solve_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

void CalibSolver::add_point(const PointChoice& choice) {
  constexpr std::size_t kMostWaiting = 2000;  // where no frame comes
  GST_INFO_OBJECT(element_, "a point at %.2f, %.2f waits for a frame", choice.at.u, choice.at.v);
  const std::lock_guard guard(lock_);
  if (waiting_points_.size() < kMostWaiting) waiting_points_.push_back(choice);
}

bool CalibSolver::wants_points() {
  const std::lock_guard guard(lock_);
  return !waiting_points_.empty() || session_.expects_points();
}

void CalibSolver::take_points(const FrameTimes& times, const PointAt& point_at) {
  std::vector<PointChoice> waiting;
  double reach = 0;
  {
    const std::lock_guard guard(lock_);
    waiting = std::exchange(waiting_points_, {});
    reach = session_.point_reach();
  }
  for (const PointChoice& choice : waiting) {
    const auto found = choice.sigma ? std::nullopt : point_at(choice.at, reach);
    PointAnswer answer;
    {
      const std::lock_guard guard(lock_);
      answer = session_.add_point(choice, found, times);
      obey();
    }
    post_point(times, answer);
  }
  take_expected_points(times, point_at);
}

// A few with each frame: a live stream has a few milliseconds to spare.
void CalibSolver::take_expected_points(const FrameTimes& times, const PointAt& point_at) {
  constexpr std::size_t kMost = 8;
  std::vector<ExpectedPoint> expected;
  {
    const std::lock_guard guard(lock_);
    expected = session_.take_expected_points(kMost);
  }
  std::vector<std::pair<PointChoice, FoundPoint>> found;
  for (const ExpectedPoint& point : expected) {
    if (const auto near = point_at(point.choice.at, point.reach)) {
      found.emplace_back(point.choice, *near);
    }
  }
  if (found.empty()) return;
  PointAnswer answer;
  {
    const std::lock_guard guard(lock_);
    answer = session_.add_found_points(found, times);
    obey();
  }
  post_point(times, answer);
}

bool CalibSolver::remove_point(std::optional<unsigned> index) {
  PointAnswer answer;
  {
    const std::lock_guard guard(lock_);
    // One that waits for a frame is the newest.
    if (!index && !waiting_points_.empty()) {
      waiting_points_.pop_back();
      return true;
    }
    answer = session_.remove_point(index);
    obey();
  }
  post_point({}, answer);
  return answer.accepted();
}

void CalibSolver::post_point(const FrameTimes& times, const PointAnswer& answer) {
  std::string camera;
  Progress now;
  {
    const std::lock_guard guard(lock_);
    camera = session_.camera_name();
    now = session_.progress();
  }
  post_message(element_, point_message(times, camera, answer));
  if (answer.accepted()) post_message(element_, progress_message(times, camera, now));
}

void CalibSolver::post_points_report() {
  std::optional<PointAnswer> report;
  {
    const std::lock_guard guard(lock_);
    report = session_.take_points_report();
  }
  if (!report) return;
  post_point({}, *report);
  if (!report->accepted()) {
    post_warning(element_, {ErrorCode::kInvalidArgument, report->hint});
  }
}

}  // namespace calvin::gst
