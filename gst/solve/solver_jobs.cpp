// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibsolve does on its worker: solves what its session asks for, and posts the results.

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calvin/io/calibration_io.hpp"
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

void CalibSolver::judge_earlier(const SolveJob& job, const std::stop_token& stop) {
  const auto verdict = calvin::judge_earlier(job);
  if (!verdict) return;
  GST_INFO_OBJECT(element_, "%s", verdict->words.c_str());
  if (const auto report = begin_report(job, stop)) {
    {
      const std::lock_guard guard(lock_);
      if (!session_.judged(job, verdict->words)) return;
    }
    post_message(element_, check_message(job, *verdict));
  }
  const auto report = begin_report(job, stop);
  if (!report) return;
  if (verdict->holds) {
    post_info(element_, verdict->words);
  } else {
    post_warning(element_, {ErrorCode::kInvalidArgument, verdict->words});
  }
}

void CalibSolver::run_solve(const SolveJob& job, const std::stop_token& stop) {
  judge_earlier(job, stop);
  auto solution = solve_job(job, stop);
  if (stop.stop_requested()) {
    GST_DEBUG_OBJECT(element_, "the solve of %" G_GSIZE_FORMAT " views was cancelled",
                     job.views.size());
    return;
  }
  if (!solution) {
    GST_INFO_OBJECT(element_, "no solution from %" G_GSIZE_FORMAT " views: %s", job.views.size(),
                    solution.error().message.c_str());
    std::optional<Error> told;
    {
      const std::lock_guard guard(lock_);
      told = session_.failed(job, solution.error());
    }
    if (!told) return;
    if (const auto report = begin_report(job, stop)) post_warning(element_, *told);
    return;
  }
  // Absent where the clock is past the year 9999.
  if (g_autoptr(GDateTime) now = g_date_time_new_now_utc()) {
    g_autofree char* created = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
    solution->calibration.created = created;
  }
  publish(job, *solution, stop);
}

void CalibSolver::publish(const SolveJob& job, const Solution& solution,
                          const std::stop_token& stop) {
  std::optional<Published> published;
  auto errors = parameter_errors(solution.calibration);
  {
    const std::lock_guard guard(lock_);
    published = session_.solved(job, solution, std::move(errors));
    obey();
  }
  if (!published) {
    GST_INFO_OBJECT(element_, "a solve is thrown away: what it was made of has changed");
    return;
  }
  const Calibration& calibration = solution.calibration;
  GST_INFO_OBJECT(
      element_, "%s result of %" G_GSIZE_FORMAT " views: %s, rms %.4f px, expected error %.4f px%s",
      job.final ? "final" : "intermediate", job.views.size(), calibration.model.c_str(),
      calibration.rms.value_or(HUGE_VAL), calibration.expected_error.value_or(HUGE_VAL),
      published->better ? "" : ": no better than the one before");
  if (!published->reached.empty()) {
    GST_INFO_OBJECT(element_, "nothing more is captured: %s is reached",
                    std::string(published->reached).c_str());
  }
  const bool in_time = !published->writing || writer_.drain_for(kPatience);
  announce(job, solution, published->better, stop);
  if (auto guide = guide_job(job, solution)) {
    const std::lock_guard guard(lock_);
    session_.guided(job, std::move(guide));
  }
  if (!in_time) complain_of_late_files(job, stop);
}

void CalibSolver::complain_of_late_files(const SolveJob& job, const std::stop_token& stop) {
  const auto report = begin_report(job, stop);
  if (!report) return;
  std::optional<Notice> notice;
  {
    const std::lock_guard guard(lock_);
    notice = session_.files_are_late(kPatience);
  }
  if (notice) post_warning(element_, notice->error);
}

std::unique_ptr<Worker::Report> CalibSolver::begin_report(const SolveJob& job,
                                                          const std::stop_token& stop,
                                                          bool is_result) {
  const std::lock_guard guard(lock_);
  if (!session_.is_current(job.origin)) return nullptr;
  auto report = worker_.begin_report(stop, element_);
  if (report && is_result) session_.reported(job);
  return report;
}

void CalibSolver::post_rejected(const SolveJob& job, const Solution& solution, const Progress& now,
                                const std::stop_token& stop) {
  std::vector<TakenView> rejected;
  {
    const std::lock_guard guard(lock_);
    if (stop.stop_requested()) return;
    rejected = session_.newly_rejected(job, solution);
  }
  // Each by itself: a handler of the message may end the session.
  for (const TakenView& view : rejected) {
    GST_DEBUG_OBJECT(element_, "the view at %" GST_TIME_FORMAT " is left out: %s",
                     GST_TIME_ARGS(view.times.timestamp),
                     std::string(to_string(view.reason)).c_str());
    if (const auto report = begin_report(job, stop)) {
      post_message(element_,
                   view_message(view.times, solution.calibration.camera, view.reason, now));
    }
  }
}

void CalibSolver::announce(const SolveJob& job, const Solution& solution, bool better,
                           const std::stop_token& stop) {
  const Calibration& calibration = solution.calibration;
  // While the files were written more views may have been taken, of which messages tell already.
  Progress now;
  std::string location;
  {
    const std::lock_guard guard(lock_);
    now = session_.progress();
    if (better && session_.is_written()) location = job.location;
  }
  post_rejected(job, solution, now, stop);
  if (const auto report = begin_report(job, stop)) {
    post_message(element_, progress_message(job.times, calibration.camera, now));
  }
  const auto json = print_calibration(calibration);
  if (const auto report = begin_report(job, stop, true)) {
    post_message(element_, result_message(job.times, solution, location,
                                          job.final && json ? json->c_str() : nullptr));
  }
  if (const auto report = begin_report(job, stop)) {
    g_object_notify(G_OBJECT(element_), "calibration");
  }
}

}  // namespace calvin::gst
