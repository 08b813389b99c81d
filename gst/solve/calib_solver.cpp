// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The session behind calibsolve: collects views and obeys commands; solver_update.cpp brings other
// settings into force, solver_jobs.cpp solves, solver_files.cpp writes, and solver_finish.cpp waits
// for both.

#include "solve/calib_solver.hpp"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "calvin/target/board.hpp"
#include "common/values.hpp"
#include "solve/solve_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

bool CalibSolver::refines_with_camera() {
  const std::lock_guard guard(lock_);
  return settings_.runs > 1;
}

Status CalibSolver::start() {
  auto plan = make_plan(settings());
  if (!plan) return tl::unexpected<Error>(plan.error());
  const Status writable = can_write_all(plan->files);
  if (!writable) post_warning(element_, writable.error());
  {
    const std::lock_guard guard(lock_);
    plan_ = *std::move(plan);
    seen_ = plan_.settings;
    ++plan_serial_;
    size_ = {};
    initial_.reset();
    write_failed_ = !writable;
    GST_INFO_OBJECT(element_, "solves %s from %d views on, %" G_GSIZE_FORMAT " files",
                    plan_.settings.model.c_str(), plan_.settings.min_views, plan_.files.size());
  }
  reset();
  for (Worker* worker : {&updater_, &writer_}) {
    if (Status started = worker->start(); !started) return started;
  }
  return worker_.start();
}

void CalibSolver::set_size(ImageSize size) {
  std::optional<Error> warning;
  {
    const std::lock_guard guard(lock_);
    if (std::exchange(size_, size) == size) return;
    GST_INFO_OBJECT(element_, "frames of %dx%d px: %s", size.width, size.height,
                    session_.views().empty() ? "no view was taken before" : "a new session begins");
    auto fitted = fit_initial(plan_, size);
    initial_ = std::move(fitted.calibration);
    warning = std::move(fitted.warning);
    if (!session_.views().empty()) forget();
  }
  if (warning) post_warning(element_, *warning);
}

void CalibSolver::set_live(bool live) {
  const std::lock_guard guard(lock_);
  live_ = live;
  session_.set_options(plan_.session_options(live));
  const CaptureMode mode = session_.options().mode;
  GST_INFO_OBJECT(element_, "the source is %s: %s", live ? "live" : "not live",
                  mode == CaptureMode::kAll    ? "every view is kept"
                  : mode == CaptureMode::kAuto ? "still, large and new views are kept"
                                               : "views are kept on the signal capture-view");
}

void CalibSolver::resume() {
  writer_.resume();
  worker_.resume();
  updater_.resume();
  const std::lock_guard guard(lock_);
  next_solve_ = 0;
  if (unwritten_) request_write(plan_.files, false);
  if (final_owed_) request(true);
}

// ---- Collecting: on the streaming thread --------------------------------------------------------

Result<Board> CalibSolver::board_of(const std::string& text) {
  constexpr std::size_t kMany = 16;
  const std::lock_guard guard(lock_);
  if (const auto known = boards_.find(text); known != boards_.end()) return known->second;
  auto board = parse_board(text);
  if (!board) return board;
  if (boards_.size() >= kMany) boards_.clear();
  boards_.emplace(text, *board);
  return board;
}

bool CalibSolver::offer(const Observation& observation, const FrameTimes& times) {
  if (!observation.found()) {
    GST_LOG_OBJECT(element_, "no board on the frame at %" GST_TIME_FORMAT,
                   GST_TIME_ARGS(times.timestamp));
    return false;
  }
  const auto board = board_of(observation.board);
  if (!board) {
    complain(board.error());
    return false;
  }
  Reason reason;
  Progress now;
  std::string camera;
  {
    const std::lock_guard guard(lock_);
    if (finished_ || observation.image_size != size_) {
      GST_LOG_OBJECT(element_, "the view at %" GST_TIME_FORMAT " is of no use: %s",
                     GST_TIME_ARGS(times.timestamp),
                     finished_ ? "the session is finished" : "its frame has another size");
      return false;
    }
    camera_ = observation.camera;
    camera = camera_name();
    times_ = times;
    View view = {observation, *board};
    if (plan_.settings.runs < 2) view.observation.patches.reset();
    reason = session_.offer(view);
    now = with_quality(session_.progress(), calibration_);
    if (reason == Reason::kAccepted) {
      GST_DEBUG_OBJECT(
          element_, "view %d is the one at %" GST_TIME_FORMAT ", with %" G_GSIZE_FORMAT " corners",
          now.views, GST_TIME_ARGS(times.timestamp), observation.ids.size());
      taken_.push_back({times});
      consider();
    }
    if (reason != Reason::kAccepted) {
      GST_LOG_OBJECT(element_, "the view at %" GST_TIME_FORMAT " is not kept: %s",
                     GST_TIME_ARGS(times.timestamp), std::string(to_string(reason)).c_str());
    }
    // A rejection is posted only when its reason is new.
    if (reason != Reason::kAccepted && std::exchange(last_reason_, reason) == reason) return false;
    last_reason_ = reason;
  }
  if (reason == Reason::kWrongBoard) {
    if (const Status fine = check({observation, *board}, observation.image_size); !fine) {
      complain(fine.error());
    }
  }
  post_message(element_, view_message(times, camera, reason, now));
  if (reason != Reason::kAccepted) return false;
  post_message(element_, progress_message(times, camera, now));
  return true;
}

void CalibSolver::complain(const Error& why) {
  {
    const std::lock_guard guard(lock_);
    if (std::exchange(complained_, true)) return;
  }
  post_warning(element_, {why.code, fmt::format("An observation from upstream cannot be used, and "
                                                "further ones like it are dropped silently: {}{} "
                                                "Check what writes the meta {}.",
                                                why.message, why.message.ends_with('.') ? "" : ".",
                                                kObservationName)});
}

Progress CalibSolver::progress() {
  const std::lock_guard guard(lock_);
  return with_quality(session_.progress(), calibration_);
}

std::optional<CalibrationEvent> CalibSolver::take_event() {
  const std::lock_guard guard(lock_);
  if (!std::exchange(announce_, false) || !calibration_) return std::nullopt;
  const auto json = print_calibration(*calibration_);
  if (!json) return std::nullopt;
  return CalibrationEvent{calibration_->camera, *json};
}

bool CalibSolver::enough_views() const {
  return session_.views().size() >= static_cast<std::size_t>(plan_.settings.min_views);
}

std::string CalibSolver::camera_name() const {
  return plan_.settings.camera.empty() ? camera_ : plan_.settings.camera;
}

void CalibSolver::consider() {
  ++revision_;
  if (!enough_views()) return;
  const std::size_t views = session_.views().size();
  const bool full =
      plan_.settings.max_views > 0 && views >= static_cast<std::size_t>(plan_.settings.max_views);
  const bool good = plan_.settings.target_error > 0 && calibration_ &&
                    calibration_->expected_error.value_or(HUGE_VAL) <= plan_.settings.target_error;
  if (full || good) {
    GST_INFO_OBJECT(element_, "nothing more is captured: %s is reached",
                    full ? "max-views" : "target-error");
    finished_ = true;
    request(true);
  } else if (views >= next_solve_) {
    // When every frame is a view, each solve waits for a quarter more of them.
    next_solve_ = session_.options().mode == CaptureMode::kAll ? views + views / 4 + 1 : views + 1;
    request(false);
  }
}

// ---- Commands -----------------------------------------------------------------------------------

void CalibSolver::capture_view() {
  const std::lock_guard guard(lock_);
  GST_INFO_OBJECT(element_, "the next view is kept whatever else it is");
  session_.capture_next();
}

void CalibSolver::solve_now() {
  update();
  std::optional<Error> refused;
  {
    const std::lock_guard guard(lock_);
    solve_waits_ = enough_views();
    if (!solve_waits_) refused = too_few_views();
    solve_when_up_to_date();
  }
  if (refused) post_warning(element_, *refused);
}

void CalibSolver::reset() {
  GST_INFO_OBJECT(element_, "a new session begins: all views are forgotten");
  const std::lock_guard guard(lock_);
  forget();
}

void CalibSolver::forget() {
  ++generation_;
  ++session_number_;
  session_.reset();
  taken_.clear();
  calibration_.reset();
  published_ = finished_ = announce_ = complained_ = kept_reported_ = write_late_ = false;
  final_owed_ = solve_waits_ = false;
  last_reason_ = Reason::kAccepted;
  ++revision_;
  written_ = {};
  forget_unwritten();
  solve_error_.clear();
  next_solve_ = 0;
}

bool CalibSolver::remove_view(unsigned index) {
  const std::lock_guard guard(lock_);
  if (!session_.remove_view(index)) {
    GST_WARNING_OBJECT(element_, "there is no view %u to remove", index);
    return false;
  }
  GST_INFO_OBJECT(element_, "view %u is removed, %" G_GSIZE_FORMAT " are left", index,
                  session_.views().size());
  taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(index));
  ++generation_;                   // what is being solved has the view in it
  finished_ = published_ = false;  // and the files have it
  forget_unwritten();
  ++revision_;
  next_solve_ = 0;
  if (enough_views()) {
    request(false);
  } else {
    calibration_.reset();
  }
  return true;
}

std::string CalibSolver::calibration_json() {
  const std::lock_guard guard(lock_);
  if (!calibration_) return {};
  return print_calibration(*calibration_).value_or(std::string());
}

GstStructure* CalibSolver::stats() {
  const std::lock_guard guard(lock_);
  GstStructure* s =
      gst_structure_new("stats", "views", G_TYPE_INT, static_cast<int>(session_.views().size()),
                        "coverage", G_TYPE_DOUBLE, session_.progress().coverage, nullptr);
  if (!calibration_) return s;
  if (calibration_->rms) gst_structure_set(s, "rms", G_TYPE_DOUBLE, *calibration_->rms, nullptr);
  if (calibration_->expected_error) {
    gst_structure_set(s, "expected-error", G_TYPE_DOUBLE, *calibration_->expected_error, nullptr);
  }
  return s;
}

}  // namespace calvin::gst
