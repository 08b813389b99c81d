// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the session behind calibsolve does on its worker.

#include <cmath>
#include <memory>
#include <utility>

#include "calib_solver.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/second_look.hpp"
#include "solve_messages.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

struct CalibSolver::Job {
  std::vector<View> views;
  ImageSize size;
  SolveOptions options;
  int runs = 1;
  std::vector<CalibrationFile> files;
  std::string location;
  FrameTimes times;
  std::uint64_t generation = 0;
  std::uint64_t revision = 0;
  bool final = false;
};

void CalibSolver::request(bool final) {
  auto job = std::make_shared<Job>();
  job->views = session_.views();
  job->size = size_;
  job->files = plan_.files;
  job->location = plan_.settings.location;
  job->times = times_;
  job->generation = generation_;
  job->revision = revision_;
  // The newest job replaces one that waits, and takes over what it owes.
  final_owed_ |= final;
  job->final = final_owed_;
  job->options = plan_.options;
  if (job->final) job->runs = plan_.settings.runs;
  job->options.camera = camera_name();
  job->options.initial = initial_;
  worker_.offer([this, job](const std::stop_token& stop) { run(*job, stop); });
}

void CalibSolver::run(const Job& job, const std::stop_token& stop) {
  auto solution = solve_in_runs(job.views, job.size, job.options, job.runs, stop);
  if (stop.stop_requested()) return;
  if (!solution) {
    GST_INFO_OBJECT(element_, "no solution from %" G_GSIZE_FORMAT " views: %s", job.views.size(),
                    solution.error().message.c_str());
    const std::lock_guard guard(lock_);
    if (job.generation != generation_) return;
    solve_error_ = solution.error().message;
    if (job.final) final_owed_ = false;
    return;
  }
  g_autoptr(GDateTime) now = g_date_time_new_now_utc();
  g_autofree char* created = g_date_time_format(now, "%Y-%m-%dT%H:%M:%SZ");
  solution->calibration.created = created;
  publish(job, *solution, stop);
}

void CalibSolver::publish(const Job& job, const Solution& solution, const std::stop_token& stop) {
  const Calibration& calibration = solution.calibration;
  Guidance now;
  bool better = false;
  {
    const std::lock_guard guard(lock_);
    if (job.generation != generation_) return;
    calibration_ = calibration;
    solve_error_.clear();
    now = make_guidance(session_.progress(), calibration_);
    better = job.final || !anything_written_ ||
             calibration.expected_error.value_or(HUGE_VAL) < written_error_.value_or(HUGE_VAL);
    announce_ |= better;
  }
  if (better) {
    const Status written = write_all(job.files, calibration);
    bool news = false;
    {
      const std::lock_guard guard(lock_);
      news = !written && !write_failed_;
      write_failed_ |= !written;
      written_ = written;
      anything_written_ = true;
      written_error_ = calibration.expected_error;
    }
    if (news) {
      worker_.deliver(stop, [&] {
        const Posting posting(element_);
        post_warning(element_, written.error());
      });
    }
  }
  worker_.deliver(stop, [&] { announce(job, solution, now); });
}

std::vector<CalibSolver::TakenView> CalibSolver::newly_rejected(const Solution& solution) {
  // Views that were taken since are behind those that were solved.
  std::vector<Reason> reasons(taken_.size(), Reason::kAccepted);
  for (const RejectedView& view : solution.rejected) reasons[view.index] = view.reason;
  std::vector<TakenView> news;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const Reason before = std::exchange(taken_[i].reason, reasons[i]);
    if (before == Reason::kAccepted && reasons[i] != before) news.push_back(taken_[i]);
  }
  return news;
}

void CalibSolver::announce(const Job& job, const Solution& solution, const Guidance& now) {
  const Calibration& calibration = solution.calibration;
  std::vector<TakenView> rejected;
  {
    const std::lock_guard guard(lock_);
    if (job.generation != generation_) return;
    rejected = newly_rejected(solution);
    if (job.final) {
      final_owed_ = false;
      final_revision_ = job.revision;
    }
  }
  const auto json = print_calibration(calibration);
  const Posting posting(element_);
  for (const TakenView& view : rejected) {
    post_message(element_, view_message(view.times, calibration.camera, view.reason, now));
  }
  post_message(element_, progress_message(job.times, calibration.camera, now));
  post_message(element_, result_message(job.times, solution, job.location,
                                        job.final && json ? json->c_str() : nullptr));
  g_object_notify(G_OBJECT(element_), "calibration");
}

}  // namespace calvin::gst
