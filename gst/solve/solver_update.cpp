// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// On which thread settings of calibsolve are read that change while frames flow.

#include <utility>

#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

bool CalibSolver::is_up_to_date() {
  const std::lock_guard guard(lock_);
  return session_.is_up_to_date(settings_);
}

std::optional<SettingsUpdate> CalibSolver::begin_update() {
  const std::lock_guard guard(lock_);
  auto update = session_.begin_update(settings_);
  obey();
  return update;
}

void CalibSolver::update() {
  while (const auto update = begin_update()) {
    if (may_wait(update->seen, update->now)) {
      updater_.offer([this](const std::stop_token& stop) { update_beside(stop); });
      return;
    }
    if (const auto warnings = try_update(*update)) {
      for (const Error& error : *warnings) post_warning(element_, error);
      post_points_report();
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
        continue;
      }
      const std::lock_guard guard(lock_);
      session_.say_later({Notice::Kind::kWarning, error});
    }
    if (const auto report = updater_.begin_report(stop, element_)) post_points_report();
  }
}

bool CalibSolver::update_and_wait() {
  do {
    update();
    if (!updater_.drain()) return false;
  } while (!is_up_to_date());
  return true;
}

std::optional<std::vector<Error>> CalibSolver::try_update(const SettingsUpdate& update) {
  SettingsRead read = read_settings(update);
  const std::lock_guard guard(lock_);
  auto warnings = session_.end_update(update, std::move(read), settings_);
  GST_INFO_OBJECT(element_, "other settings %s",
                  warnings ? "are in force" : "have changed while they were read");
  obey();
  return warnings;
}

}  // namespace calvin::gst
