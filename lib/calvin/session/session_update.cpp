// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the settings of a session come into force.

#include <utility>

#include "calvin/session/calibration_session.hpp"

namespace calvin {

void CalibrationSession::start(SessionPlan plan, bool writable) {
  plan_ = std::move(plan);
  seen_ = plan_.settings;
  ++plan_serial_;
  size_ = {};
  board_.reset();
  initial_.reset();
  views_.set_options(plan_.session_options(live_));
  writes_.begin_files(writable);
  set_aside_.clear();
  journaling_ = false;
  taken_up_ = false;
  earlier_.reset();
  lens_ = LensWatch(plan_.settings.device);
  stream_ = {};
  times_ = {};
  newest_ = kNoTimestamp;
  entries_.clear();
  begin_session();
}

void CalibrationSession::begin_journal(Session::Views earlier, std::uint64_t newest_light) {
  newest_light_ = newest_light;
  set_aside_ = std::move(earlier);
  journaling_ = true;
}

std::optional<SettingsUpdate> CalibrationSession::begin_update(const SessionSettings& now) {
  if (!is_up_to_date(now)) return SettingsUpdate{now, seen_, plan_, plan_serial_};
  solve_when_up_to_date(now);
  return std::nullopt;
}

std::optional<std::vector<Error>> CalibrationSession::end_update(const SettingsUpdate& update,
                                                                 SettingsRead read,
                                                                 const SessionSettings& now) {
  if (update.serial != plan_serial_) return std::nullopt;
  ++plan_serial_;
  seen_ = update.now;
  std::optional<Error> warning;
  if (read.change.plan.settings != update.plan.settings) {
    warning = adopt(std::move(read.change.plan), read.writable.has_value());
  }
  solve_when_up_to_date(now);
  std::vector<Error> warnings;
  for (Error& error : read.change.refused) warnings.push_back(refused_setting(std::move(error)));
  if (!read.writable) warnings.push_back(read.writable.error());
  if (warning) warnings.push_back(*std::move(warning));
  return warnings;
}

std::optional<Error> CalibrationSession::adopt(SessionPlan plan, bool writable) {
  const bool solve = solves_differently(plan.settings, plan_.settings);
  const bool write = writes_elsewhere(plan.settings, plan_.settings);
  const bool other_points = points_text(plan.settings.points, plan.settings.board) !=
                            points_text(plan_.settings.points, plan_.settings.board);
  const bool other_files = names_other_files(plan.settings, plan_.settings);
  plan_ = std::move(plan);
  compare_with_target();
  views_.set_options(plan_.session_options(live_));
  if (views_.options().mode != CaptureMode::kAuto) guide_.reset();
  std::optional<Error> warning;
  if (solve) {
    auto fitted = fit_initial(plan_, size_);
    initial_ = std::move(fitted.calibration);
    warning = std::move(fitted.warning);
    published_ = false;  // the calibration is one of the old way
    solve_error_.clear();
  }
  if (other_points) begin_points();
  weigh_points();
  finished_ = !limit_reached().empty();
  renew_hint();  // `initial` is the camera until there is a solution
  if (other_files) writes_.begin_files(writable);
  if (solve || write) outdate_results();
  const bool final = finished_ && final_revision_ != revision_;
  if (enough_views() && (solve || write || final)) ask(final);
  return warning;
}

void CalibrationSession::solve_when_up_to_date(const SessionSettings& now) {
  if (!is_up_to_date(now) || !std::exchange(solve_waits_, false)) return;
  if (enough_views()) ask(true);
}

}  // namespace calvin
