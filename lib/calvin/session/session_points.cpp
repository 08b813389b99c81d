// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The manual points of a session: one view that changes with each of them.

#include <algorithm>
#include <utility>

#include "calvin/session/calibration_session.hpp"
#include "calvin/session/points/point_fit.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "calvin/solve/parameters/parameterization.hpp"
#include "calvin/solve/pose.hpp"

namespace calvin {

namespace {

// How many parameters of the camera are to be estimated.
int unknowns_of(SolveOptions options, const std::optional<Calibration>& initial) {
  if (holds_camera(options)) return 0;
  if (std::ranges::find(model_names(), options.model) == model_names().end()) {
    options.model = "brown5";  // auto
  }
  options.initial = initial;
  const auto parameterization = make_parameterization(options, {});
  return parameterization ? static_cast<int>(parameterization->basis.cols()) : 0;
}

}  // namespace

bool CalibrationSession::clicks_choose() const {
  return plan_.points && (plan_.points->is_file || !board_in_view_);
}

void CalibrationSession::weigh_points() {
  points_.set_unknowns(unknowns_of(plan_.options, plan_.initial));
  points_suffice_ = manual_view_ && points_.suffice();
}

void CalibrationSession::forget_points() {
  drop_manual_view();
  taken_out_.clear();
  looked_for_.clear();
  expects_points_ = false;
  point_words_.clear();
  points_report_.reset();
  points_.begin(size_, plan_.points ? std::optional(plan_.points->board) : std::nullopt);
  weigh_points();
}

void CalibrationSession::begin_points() {
  forget_points();
  if (size_.width < 1 || !plan_.points || plan_.points->seen.empty()) return;
  PointAnswer report = points_.add_all(plan_.points->seen);
  look_for_points();
  if (points_.count() > 0) renew_manual_view(times_);
  points_report_ = told(std::move(report));
}

bool CalibrationSession::drop_manual_view() {
  const auto dropped = std::exchange(manual_view_, nullptr);
  const auto& all = views_.views();
  const auto found = std::ranges::find(all, dropped);
  if (!dropped || found == all.end()) return false;
  const auto index = static_cast<std::size_t>(found - all.begin());
  taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(index));
  return views_.remove_view(index);
}

void CalibrationSession::renew_manual_view(const FrameTimes& times) {
  std::optional<View> view = points_.view();
  const bool had_one = drop_manual_view();
  if (view) {
    view->observation.camera = camera_;
    view->observation.timestamp = times.timestamp;
    manual_view_ = std::make_shared<const View>(*std::move(view));
    if (views_.add(manual_view_) == Reason::kAccepted) {
      note_taken(times);
      times_ = times;
    } else {
      manual_view_.reset();
    }
  }
  weigh_points();
  if (had_one || manual_view_) views_changed();
}

PointAnswer CalibrationSession::told(PointAnswer answer) {
  // Of a camera that is to be estimated the solve tells more.
  const auto known = manual_view_ && holds_camera(plan_.options) ? camera() : std::nullopt;
  const auto fit = known ? fit_points(*known, *manual_view_) : std::nullopt;
  if (fit) answer.hint.append(" ").append(to_text(*fit));
  point_words_ = answer.hint;
  return answer;
}

PointAnswer CalibrationSession::add_point(const PointChoice& choice,
                                          const std::optional<FoundPoint>& found,
                                          const FrameTimes& times) {
  PointAnswer answer = points_.add(choice, found);
  if (answer.accepted()) {
    taken_out_.erase(*answer.id);
    look_for_points();
    renew_manual_view(times);
  }
  return told(std::move(answer));
}

void CalibrationSession::look_for_points() {
  looked_for_ = taken_out_;
  expects_points_ = plan_.points.has_value();
}

std::vector<ExpectedPoint> CalibrationSession::take_expected_points(std::size_t most) {
  const auto& known = calibration_ ? calibration_ : initial_;
  if (!expects_points_ || !manual_view_ || !known) return {};
  const auto camera = Camera::make(*known);
  if (!camera) return {};
  auto expected = expected_points(*camera, *manual_view_, looked_for_, most, snap_reach(size_));
  expects_points_ = !expected.empty();
  for (const ExpectedPoint& point : expected) looked_for_.insert(point.id);
  return expected;
}

PointAnswer CalibrationSession::add_found_points(
    const std::vector<std::pair<PointChoice, FoundPoint>>& points, const FrameTimes& times) {
  PointAnswer answer = points_.add_found(points);
  renew_manual_view(times);
  return told(std::move(answer));
}

PointAnswer CalibrationSession::remove_point(std::optional<std::size_t> index) {
  PointAnswer answer = points_.remove(index);
  if (answer.accepted()) {
    if (answer.id) taken_out_.insert(*answer.id);
    looked_for_.insert(taken_out_.begin(), taken_out_.end());
    renew_manual_view(times_);
  }
  return told(std::move(answer));
}

std::optional<PointAnswer> CalibrationSession::take_points_report() {
  return std::exchange(points_report_, std::nullopt);
}

bool CalibrationSession::is_of_points_alone() const {
  return takes_one_view(plan_.settings.method);
}

}  // namespace calvin
