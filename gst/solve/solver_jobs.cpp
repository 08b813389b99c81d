// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the session behind calibsolve does on its worker.

#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/refine_with_camera.hpp"
#include "solve/calib_solver.hpp"
#include "solve/solve_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

namespace {

// How long a result waits for its files: whoever hears of it finds them written, unless the disk
// takes longer than anybody would wait for a result.
constexpr std::chrono::seconds kPatience{1};

}  // namespace

struct CalibSolver::Job {
  Session::Views views;
  ImageSize size;
  SolveOptions options;
  int runs = 1;
  std::string location;
  FrameTimes times;
  std::uint64_t generation = 0;
  std::uint64_t revision = 0;
  bool final = false;
};

std::shared_ptr<CalibSolver::Job> CalibSolver::make_job() const {
  auto job = std::make_shared<Job>();
  job->views = session_.views();
  job->size = size_;
  job->location = plan_.settings.location;
  job->times = times_;
  job->generation = generation_;
  job->revision = revision_;
  return job;
}

void CalibSolver::request(bool final) {
  auto job = make_job();
  // The newest job replaces one that waits, and takes over what it owes.
  final_owed_ |= final;
  job->final = final_owed_;
  job->options = plan_.options;
  if (job->final) job->runs = plan_.settings.runs;
  job->options.camera = camera_name();
  job->options.initial = initial_;
  GST_DEBUG_OBJECT(element_, "%s solve of %" G_GSIZE_FORMAT " views asked for",
                   job->final ? "final" : "intermediate", job->views.size());
  worker_.offer([this, job](const std::stop_token& stop) { run(*job, stop); });
}

void CalibSolver::run(const Job& job, const std::stop_token& stop) {
  std::vector<View> views;
  views.reserve(job.views.size());
  for (const auto& view : job.views) views.push_back(*view);
  auto solution = solve_in_runs(views, job.size, job.options, job.runs, stop);
  if (stop.stop_requested()) {
    GST_DEBUG_OBJECT(element_, "the solve of %" G_GSIZE_FORMAT " views was cancelled",
                     views.size());
    return;
  }
  if (!solution) {
    GST_INFO_OBJECT(element_, "no solution from %" G_GSIZE_FORMAT " views: %s", views.size(),
                    solution.error().message.c_str());
    const std::lock_guard guard(lock_);
    if (job.generation != generation_) return;
    solve_error_ = solution.error().message;
    if (job.final) final_owed_ = false;
    return;
  }
  // Absent where the clock is past the year 9999.
  if (g_autoptr(GDateTime) now = g_date_time_new_now_utc()) {
    g_autofree char* created = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
    solution->calibration.created = created;
  }
  publish(job, *solution, stop);
}

void CalibSolver::publish(const Job& job, const Solution& solution, const std::stop_token& stop) {
  const Calibration& calibration = solution.calibration;
  const double error = calibration.expected_error.value_or(HUGE_VAL);
  Progress now;
  bool better = false;
  bool writing = false;
  {
    const std::lock_guard guard(lock_);
    if (job.generation != generation_) {
      GST_INFO_OBJECT(element_, "a solve is thrown away: what it was made of has changed");
      return;
    }
    calibration_ = calibration;
    solve_error_.clear();
    now = with_quality(session_.progress(), calibration_);
    better = job.final || !published_ || error < published_error_.value_or(HUGE_VAL);
    if (better) {
      announce_ = published_ = true;
      published_error_ = calibration.expected_error;
      unwritten_ = calibration;
    }
    if (plan_.files.empty()) forget_unwritten();
    if (unwritten_) request_write(plan_.files, job.final);
    writing = unwritten_.has_value();
  }
  GST_INFO_OBJECT(element_,
                  "%s result of %" G_GSIZE_FORMAT
                  " views: %s, rms %.4f px, expected error %.4f "
                  "px%s",
                  job.final ? "final" : "intermediate", job.views.size(), calibration.model.c_str(),
                  calibration.rms.value_or(HUGE_VAL), error,
                  better ? "" : ": no better than the one before");
  const bool in_time = !writing || writer_.drain_for(kPatience);
  announce(job, solution, now, stop);
  if (!in_time) complain_of_late_files(job, stop);
}

void CalibSolver::complain_of_late_files(const Job& job, const std::stop_token& stop) {
  const auto report = begin_report(job, stop);
  if (!report) return;
  std::vector<std::string> paths;
  {
    const std::lock_guard guard(lock_);
    if (std::exchange(write_late_, true)) return;
    for (const CalibrationFile& file : being_written_) paths.push_back(file.path);
  }
  post_warning(
      element_,
      {ErrorCode::kIo,
       fmt::format("The write of '{}' has not ended after {} s: its disk, or the server or "
                   "reader behind it, does not answer. Results go on to the bus, and the "
                   "newest one is written once it answers; EOS waits for that.",
                   join(paths, "', '"), kPatience.count())});
}

std::vector<CalibSolver::TakenView> CalibSolver::newly_rejected(const Solution& solution) {
  // Views that were taken since are behind those that were solved.
  std::vector<Reason> reasons(taken_.size(), Reason::kAccepted);
  for (const RejectedView& view : solution.rejected) reasons[view.index] = view.reason;
  std::vector<TakenView> rejected;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const Reason before = std::exchange(taken_[i].reason, reasons[i]);
    if (before == Reason::kAccepted && reasons[i] != before) rejected.push_back(taken_[i]);
  }
  return rejected;
}

std::unique_ptr<Worker::Report> CalibSolver::begin_report(const Job& job,
                                                          const std::stop_token& stop,
                                                          bool is_result) {
  const std::lock_guard guard(lock_);
  if (job.generation != generation_) return nullptr;
  auto report = worker_.begin_report(stop, element_);
  if (report && is_result && job.final) {
    final_owed_ = false;
    final_revision_ = job.revision;
  }
  return report;
}

void CalibSolver::announce(const Job& job, const Solution& solution, const Progress& now,
                           const std::stop_token& stop) {
  const Calibration& calibration = solution.calibration;
  std::vector<TakenView> rejected;
  {
    const std::lock_guard guard(lock_);
    if (job.generation != generation_ || stop.stop_requested()) return;
    rejected = newly_rejected(solution);
  }
  // Each by itself: a handler of the message may end the session.
  for (const TakenView& view : rejected) {
    GST_DEBUG_OBJECT(element_, "the view at %" GST_TIME_FORMAT " is left out: %s",
                     GST_TIME_ARGS(view.times.timestamp),
                     std::string(to_string(view.reason)).c_str());
    if (const auto report = begin_report(job, stop)) {
      post_message(element_, view_message(view.times, calibration.camera, view.reason, now));
    }
  }
  if (const auto report = begin_report(job, stop)) {
    post_message(element_, progress_message(job.times, calibration.camera, now));
  }
  const auto json = print_calibration(calibration);
  if (const auto report = begin_report(job, stop, true)) {
    post_message(element_, result_message(job.times, solution, job.location,
                                          job.final && json ? json->c_str() : nullptr));
  }
  if (const auto report = begin_report(job, stop)) {
    g_object_notify(G_OBJECT(element_), "calibration");
  }
}

}  // namespace calvin::gst
