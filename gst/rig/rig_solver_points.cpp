// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points of calibrig: they wait for a frame of their camera, are told to the session and
// announced.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "common/points/point_values.hpp"
#include "rig/rig_messages.hpp"
#include "rig/rig_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibrig_debug);
#define GST_CAT_DEFAULT calibrig_debug

namespace calvin::gst {

std::optional<std::size_t> RigSolver::find(const std::string& camera) {
  std::optional<std::size_t> found;
  {
    const std::lock_guard guard(lock_);
    found = session_.find(camera);
  }
  if (!found) {
    post_warning(element_, {ErrorCode::kInvalidArgument,
                            fmt::format("No camera '{}' is linked whose points could be chosen: "
                                        "name one as its pad does.",
                                        camera)});
  }
  return found;
}

void RigSolver::add_point(std::size_t camera, const PointChoice& choice) {
  constexpr std::size_t kMostWaiting = 2000;  // where no frame comes
  GST_INFO_OBJECT(element_, "a point at %.2f, %.2f waits for a frame of camera %" G_GSIZE_FORMAT,
                  choice.at.u, choice.at.v, camera);
  const std::lock_guard guard(lock_);
  if (waiting_points_.size() < kMostWaiting) waiting_points_.emplace_back(camera, choice);
}

bool RigSolver::add_point(const std::string& camera, const PointChoice& choice) {
  const auto found = find(camera);
  if (found) add_point(*found, choice);
  return found.has_value();
}

bool RigSolver::clicks_choose(std::size_t camera) {
  const std::lock_guard guard(lock_);
  return session_.clicks_choose(camera);
}

bool RigSolver::has_points(std::size_t camera) {
  if (has_waiting_points(camera)) return true;
  const std::lock_guard guard(lock_);
  return session_.has_points(camera);
}

bool RigSolver::has_waiting_points(std::size_t camera) {
  const std::lock_guard guard(lock_);
  return std::ranges::any_of(waiting_points_,
                             [camera](const auto& waiting) { return waiting.first == camera; });
}

void RigSolver::set_size(std::size_t camera, ImageSize size) {
  {
    const std::lock_guard guard(lock_);
    session_.set_size(camera, size);
  }
  post_points_report(camera);
}

void RigSolver::take_waiting_points(std::size_t camera, const FrameTimes& times,
                                    GstClockTime timestamp, const PointAt& point_at) {
  std::vector<PointChoice> own;
  double reach = 0;
  {
    const std::lock_guard guard(lock_);
    reach = session_.point_reach(camera);
    const bool is_there = !session_.name(camera).empty();
    for (const auto& [of, choice] : waiting_points_) {
      if (of == camera && is_there) own.push_back(choice);
    }
    std::erase_if(waiting_points_,
                  [camera](const auto& waiting) { return waiting.first == camera; });
  }
  for (const PointChoice& choice : own) {
    const auto found = choice.sigma ? std::nullopt : point_at(choice.at, reach);
    PointAnswer answer;
    {
      const std::lock_guard guard(lock_);
      answer = session_.add_point(camera, choice, found, timestamp);
      times_ = times;
    }
    post_point(camera, times, answer);
  }
}

bool RigSolver::remove_point(std::size_t camera, std::optional<unsigned> index) {
  PointAnswer answer;
  {
    const std::lock_guard guard(lock_);
    // One that waits for a frame is the newest.
    const auto waiting = std::find_if(waiting_points_.rbegin(), waiting_points_.rend(),
                                      [camera](const auto& w) { return w.first == camera; });
    if (!index && waiting != waiting_points_.rend()) {
      waiting_points_.erase(std::next(waiting).base());
      return true;
    }
    answer = session_.remove_point(camera, index);
  }
  post_point(camera, {}, answer);
  return answer.accepted();
}

bool RigSolver::remove_point(const std::string& camera, std::optional<unsigned> index) {
  const auto found = find(camera);
  return found && remove_point(*found, index);
}

void RigSolver::post_point(std::size_t camera, const FrameTimes& times, const PointAnswer& answer) {
  std::string name;
  RigProgress progress;
  {
    const std::lock_guard guard(lock_);
    name = session_.name(camera);
    progress = session_.progress();
  }
  post_message(element_, point_message(times, name, answer));
  if (!answer.accepted()) return;
  post_message(element_, rig_progress_message(times, progress));
  solve_if_due(false);
}

void RigSolver::post_points_report(std::size_t camera) {
  std::optional<PointAnswer> report;
  {
    const std::lock_guard guard(lock_);
    report = session_.take_points_report(camera);
  }
  if (!report) return;
  post_point(camera, {}, *report);
  if (!report->accepted()) {
    post_warning(element_, {ErrorCode::kInvalidArgument, report->hint});
  }
}

}  // namespace calvin::gst
