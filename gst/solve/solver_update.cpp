// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The session behind calibsolve: how settings come into force that change while frames flow.

#include <utility>

#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

// Settings that were set, and those that they are to take the place of.
struct CalibSolver::Update {
  SessionSettings now;
  SessionSettings seen;
  SessionPlan plan;
  std::uint64_t serial = 0;
};

bool CalibSolver::is_up_to_date() {
  const std::lock_guard guard(lock_);
  return settings_ == seen_;
}

std::optional<CalibSolver::Update> CalibSolver::begin_update() {
  const std::lock_guard guard(lock_);
  if (settings_ != seen_) return Update{settings_, seen_, plan_, plan_serial_};
  solve_when_up_to_date();
  return std::nullopt;
}

void CalibSolver::update() {
  while (const auto update = begin_update()) {
    if (may_wait(update->seen, update->now)) {
      updater_.offer([this](const std::stop_token& stop) { update_beside(stop); });
      return;
    }
    if (const auto warnings = try_update(*update)) {
      for (const Error& error : *warnings) post_warning(element_, error);
      return;
    }
  }
}

void CalibSolver::update_beside(const std::stop_token& stop) {
  while (const auto update = begin_update()) {
    const auto warnings = try_update(*update);
    if (!warnings) continue;
    for (const Error& error : *warnings) {
      if (const auto report = updater_.begin_report(stop, element_)) {
        post_warning(element_, error);
      }
    }
  }
}

bool CalibSolver::update_and_wait() {
  do {
    update();
    if (!updater_.drain()) return false;
  } while (!is_up_to_date());
  return true;
}

std::optional<std::vector<Error>> CalibSolver::try_update(const Update& update) {
  PlanChange change = change_plan(update.plan, update.seen, update.now);
  const bool changed = change.plan.settings != update.plan.settings;
  const bool other_files = names_other_files(change.plan.settings, update.plan.settings);
  const Status writable = other_files ? can_write_all(change.plan.files) : Status();
  std::optional<Error> warning;
  {
    const std::lock_guard guard(lock_);
    if (update.serial != plan_serial_) return std::nullopt;
    ++plan_serial_;
    seen_ = update.now;
    if (changed) warning = adopt(std::move(change.plan), writable.has_value());
    solve_when_up_to_date();
  }
  std::vector<Error> warnings = std::move(change.refused);
  for (Error& error : warnings) error.message += " What was set before goes on.";
  if (!writable) warnings.push_back(writable.error());
  if (warning) warnings.push_back(*std::move(warning));
  return warnings;
}

std::optional<Error> CalibSolver::adopt(SessionPlan plan, bool writable) {
  const bool solve = solves_differently(plan.settings, plan_.settings);
  const bool write = writes_elsewhere(plan.settings, plan_.settings);
  plan_ = std::move(plan);
  session_.set_options(plan_.session_options(live_));
  finished_ = false;
  std::optional<Error> warning;
  if (solve) {
    auto fitted = fit_initial(plan_, size_);
    initial_ = std::move(fitted.calibration);
    warning = std::move(fitted.warning);
    ++generation_;  // what is being solved in the old way is of no use
  }
  GST_INFO_OBJECT(element_, "other settings: the views are %s, the files %s",
                  solve ? "solved again" : "as they were", write ? "written again" : "the same");
  if (write) {
    write_failed_ = !writable;
    write_late_ = false;
  }
  if (solve || write) {
    ++revision_;
    published_ = false;
    forget_unwritten();
    if (enough_views()) request(false);
  }
  return warning;
}

void CalibSolver::solve_when_up_to_date() {
  if (settings_ != seen_ || !std::exchange(solve_waits_, false)) return;
  if (enough_views()) request(true);
}

}  // namespace calvin::gst
