// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tells the session of calibsolve what happens on the streaming thread and what the application
// commands; solver_update.cpp brings other settings into force, solver_jobs.cpp solves,
// solver_files.cpp writes, solver_finish.cpp waits for both, and solver_watch.cpp watches the
// camera.

#include "solve/calib_solver.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/io/calibration_io.hpp"
#include "common/metas.hpp"
#include "solve/solve_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

bool CalibSolver::refines_with_camera() {
  const std::lock_guard guard(lock_);
  return settings_.runs > 1;
}

Status CalibSolver::start() {
  Status begun = begin();
  // A journal that nobody writes to must not be kept from others.
  if (!begun) stop();
  return begun;
}

Status CalibSolver::begin() {
  auto plan = make_plan(settings());
  if (!plan) return tl::unexpected<Error>(plan.error());
  const Status writable = can_write_all(plan->files);
  if (!writable) post_warning(element_, writable.error());
  GST_INFO_OBJECT(element_, "solves %s from %d views on, %" G_GSIZE_FORMAT " files",
                  plan->settings.model.c_str(), plan->settings.min_views, plan->files.size());
  const SessionSettings settings = plan->settings;
  auto earlier = find_earlier(settings, plan->initial);
  {
    const std::lock_guard guard(lock_);
    session_.start(*std::move(plan), writable.has_value());
    session_.judge_first(std::move(earlier));
  }
  if (!settings.journal.empty()) {
    if (Status opened = open_journal(settings); !opened) return opened;
  }
  for (Worker* worker : {&updater_, &writer_, &worker_}) {
    if (Status started = worker->start(); !started) return started;
  }
  if (settings.device.empty()) return {};
  if (Status started = lens_reader_.start(); !started) return started;
  return begin_watch();
}

void CalibSolver::obey() {
  if (auto solve = session_.take_solve()) {
    GST_DEBUG_OBJECT(element_, "%s solve of %" G_GSIZE_FORMAT " views asked for",
                     solve->final ? "final" : "intermediate", solve->views.size());
    const auto job = std::make_shared<const SolveJob>(*std::move(solve));
    worker_.offer([this, job](const std::stop_token& stop) { run_solve(*job, stop); });
  }
  if (auto write = session_.take_write()) {
    const auto job = std::make_shared<const WriteJob>(*std::move(write));
    writer_.offer([this, job](const std::stop_token& stop) { run_write(*job, stop); });
  }
  for (JournalEntry& entry : session_.take_journal()) {
    if (journal_) {
      journal_->add(std::move(entry));
    } else if (entry.reset) {
      between_runs_.push_back(std::move(entry));
    }
  }
}

void CalibSolver::stop() {
  for (Worker* worker : workers()) worker->stop();
  const std::lock_guard guard(lock_);
  waiting_points_.clear();
  watching_ = is_live_ = stream_runs_ = false;
  // The syncer may have it until its disk answers.
  if (journal_) journal_->end();
  journal_.reset();
}

void CalibSolver::set_size(ImageSize size) {
  std::optional<Error> warning;
  Told before;
  {
    const std::lock_guard guard(lock_);
    before = told();
    if (!session_.set_size(size, warning)) return;
    GST_INFO_OBJECT(element_, "frames of %dx%d px: a session with %d views", size.width,
                    size.height, session_.progress().views);
    obey();
  }
  if (warning) post_warning(element_, *warning);
  post_notices();
  post_points_report();
  tell_of_change(before);
}

CalibSolver::Told CalibSolver::told() const {
  return {session_.views().views().size(), session_.calibration().has_value()};
}

void CalibSolver::tell_beside(const Told& before) {
  {
    const std::lock_guard guard(lock_);
    if (!untold_) untold_ = before;
  }
  gst_element_call_async(
      element_,
      [](GstElement* /*element*/, gpointer of) {
        auto* solver = static_cast<CalibSolver*>(of);
        std::optional<Told> since;
        {
          const std::lock_guard guard(solver->lock_);
          since = std::exchange(solver->untold_, std::nullopt);
        }
        if (since) solver->tell_of_change(*since);
      },
      this, nullptr);
}

void CalibSolver::tell_of_change(const Told& before) {
  Progress now;
  std::string camera;
  Told after;
  {
    const std::lock_guard guard(lock_);
    now = session_.progress();
    camera = session_.camera_name();
    after = told();
  }
  if (before.views != after.views) post_message(element_, progress_message({}, camera, now));
  if (before.calibrated != after.calibrated) g_object_notify(G_OBJECT(element_), "calibration");
}

void CalibSolver::set_live(bool live) {
  watch_stream(live);
  const std::lock_guard guard(lock_);
  session_.set_live(live);
  const CaptureMode mode = session_.views().options().mode;
  GST_INFO_OBJECT(element_, "the source is %s: %s", live ? "live" : "not live",
                  mode == CaptureMode::kAll    ? "every view is kept"
                  : mode == CaptureMode::kAuto ? "still, large and new views are kept"
                                               : "views are kept on the signal capture-view");
}

void CalibSolver::cancel() {
  for (Worker* worker : workers()) worker->cancel();
  expect_no_frame();
}

void CalibSolver::resume() {
  for (Worker* worker : workers()) worker->resume();
  bool watching = false;
  {
    const std::lock_guard guard(lock_);
    session_.resume();
    obey();
    watching = watching_;
  }
  if (watching) watch_on();
  sync_later(journal());
  post_notices();
}

// ---- Collecting: on the streaming thread --------------------------------------------------------

bool CalibSolver::offer(const Observation& observation, const FrameTimes& times,
                        std::size_t place) {
  Offered offered;
  {
    const std::lock_guard guard(lock_);
    offered = session_.offer(observation, times, place);
    obey();
  }
  write_journal();
  const bool taken = offered.reason == Reason::kAccepted;
  GST_LOG_OBJECT(element_, "the view at %" GST_TIME_FORMAT " with %" G_GSIZE_FORMAT " corners: %s",
                 GST_TIME_ARGS(times.timestamp), observation.ids.size(),
                 std::string(to_string(offered.reason)).c_str());
  if (!offered.reached.empty()) {
    GST_INFO_OBJECT(element_, "nothing more is captured: %s is reached",
                    std::string(offered.reached).c_str());
  }
  if (offered.complaint) post_warning(element_, broken_observation(*offered.complaint));
  if (!offered.report) return false;
  post_message(element_, view_message(times, offered.camera, offered.reason, offered.progress));
  if (!taken) return false;
  GST_DEBUG_OBJECT(element_, "view %d is the one at %" GST_TIME_FORMAT, offered.progress.views,
                   GST_TIME_ARGS(times.timestamp));
  post_message(element_, progress_message(times, offered.camera, offered.progress));
  return true;
}

void CalibSolver::hear_detector(const std::string& words, bool wrong_board) {
  const std::lock_guard guard(lock_);
  session_.hear_detector(words, wrong_board);
}

void CalibSolver::complain(const Error& why) {
  {
    const std::lock_guard guard(lock_);
    if (!session_.first_complaint()) return;
  }
  post_warning(element_, broken_observation(why));
}

Progress CalibSolver::progress() {
  const std::lock_guard guard(lock_);
  return session_.progress();
}

std::optional<CalibrationEvent> CalibSolver::take_event() {
  const std::lock_guard guard(lock_);
  const auto calibration = session_.take_announcement();
  if (!calibration) return std::nullopt;
  const auto json = print_calibration(*calibration);
  if (!json) return std::nullopt;
  return CalibrationEvent{calibration->camera, *json};
}

// ---- Commands -----------------------------------------------------------------------------------

void CalibSolver::capture_view() {
  const std::lock_guard guard(lock_);
  GST_INFO_OBJECT(element_, "the next view is kept whatever else it is");
  session_.capture_view();
}

void CalibSolver::solve_now() {
  update();
  Status asked;
  {
    const std::lock_guard guard(lock_);
    asked = session_.solve_now(settings_);
    obey();
  }
  if (!asked) post_warning(element_, asked.error());
}

void CalibSolver::reset() {
  GST_INFO_OBJECT(element_, "a new session begins: all views are forgotten");
  Told before;
  {
    const std::lock_guard guard(lock_);
    before = told();
    session_.reset();
    waiting_points_.clear();
    obey();
  }
  write_journal();
  post_points_report();
  tell_beside(before);
}

bool CalibSolver::remove_view(std::optional<unsigned> wanted) {
  Told before;
  {
    const std::lock_guard guard(lock_);
    before = told();
    // Where there is none, what comes before the first one is no index.
    const std::size_t index = wanted ? *wanted : session_.views().views().size() - 1;
    if (!session_.remove_view(index)) {
      GST_WARNING_OBJECT(element_, "there is no view %" G_GSIZE_FORMAT " to remove", index);
      return false;
    }
    GST_INFO_OBJECT(element_, "view %" G_GSIZE_FORMAT " is removed, %" G_GSIZE_FORMAT " are left",
                    index, session_.views().views().size());
    obey();
  }
  write_journal();
  tell_beside(before);
  return true;
}

void CalibSolver::run_command(const SolveCommand& command) {
  switch (command.kind) {
    case SolveCommand::Kind::kCaptureView:
      capture_view();
      break;
    case SolveCommand::Kind::kSolve:
      solve_now();
      break;
    case SolveCommand::Kind::kReset:
      reset();
      break;
    case SolveCommand::Kind::kRemoveView:
      if (!remove_view(command.index) && command.index) {
        post_warning(element_, {ErrorCode::kInvalidArgument,
                                "The event calvin-remove-view names no view that there is: its "
                                "`index` is a number from 0, less than the `views` of messages."});
      }
      break;
    case SolveCommand::Kind::kPoint:
      add_point(command.point);
      break;
    case SolveCommand::Kind::kRemovePoint:
      remove_point(command.index);
      break;
    case SolveCommand::Kind::kClick:
      clicks_choose() ? add_point(command.point) : capture_view();
      break;
    case SolveCommand::Kind::kUndo:
      has_points() ? remove_point({}) : remove_view({});
      break;
    case SolveCommand::Kind::kTakeOut:
      if (has_points()) remove_point({});
      break;
  }
}

std::string CalibSolver::calibration_json() {
  const std::lock_guard guard(lock_);
  if (!session_.calibration()) return {};
  return print_calibration(*session_.calibration()).value_or(std::string());
}

GstStructure* CalibSolver::stats() {
  const std::lock_guard guard(lock_);
  const Progress now = session_.progress();
  GstStructure* s = gst_structure_new("stats", "views", G_TYPE_INT, now.views, "coverage",
                                      G_TYPE_DOUBLE, now.coverage, nullptr);
  if (now.rms) gst_structure_set(s, "rms", G_TYPE_DOUBLE, *now.rms, nullptr);
  if (now.expected_error) {
    gst_structure_set(s, "expected-error", G_TYPE_DOUBLE, *now.expected_error, nullptr);
  }
  return s;
}

}  // namespace calvin::gst
