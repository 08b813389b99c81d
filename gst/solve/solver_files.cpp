// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What calibsolve does on its writer: a thread of its own, for a disk or a server may never answer.

#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

namespace {

void post_notice(GstElement* element, const Notice& notice) {
  if (notice.kind == Notice::Kind::kInfo) {
    post_info(element, notice.error.message);
  } else {
    post_warning(element, notice.error);
  }
}

}  // namespace

bool CalibSolver::begin_write(const WriteJob& job) {
  const std::lock_guard guard(lock_);
  return session_.begin_write(job);
}

void CalibSolver::run_write(const WriteJob& job, const std::stop_token& stop) {
  if (!begin_write(job)) return;
  SessionFiles::Questions questions;
  questions.counts = [this, &job] {
    const std::lock_guard guard(lock_);
    return session_.is_current(job.origin);
  };
  questions.contradicted = [&job](const Calibration& before) { return contradict(job, before); };
  const auto outcome = files_.write(job.files, job.calibration, job.final, job.overwrite,
                                    job.origin.session, questions);
  const std::string& kept = outcome.kept;
  GST_DEBUG_OBJECT(element_, "%" G_GSIZE_FORMAT " files: %s", job.files.size(),
                   outcome.status ? "written" : outcome.status.error().message.c_str());
  if (!kept.empty()) GST_INFO_OBJECT(element_, "'%s' stays another session's", kept.c_str());
  {
    const std::lock_guard guard(lock_);
    session_.end_write(job, outcome);
  }
  post_notices(writer_, stop);
}

void CalibSolver::post_notices(Worker& worker, const std::stop_token& stop) {
  for (;;) {
    std::unique_lock guard(lock_);
    if (!session_.has_notice()) return;
    // A notice is taken only where it may be posted.
    const auto report = worker.begin_report(stop, element_);
    if (!report) return;
    const auto notice = session_.take_notice();
    guard.unlock();
    post_notice(element_, *notice);
  }
}

void CalibSolver::post_notices() {
  for (;;) {
    std::unique_lock guard(lock_);
    const auto notice = session_.take_notice();
    guard.unlock();
    if (!notice) return;
    post_notice(element_, *notice);
  }
}

}  // namespace calvin::gst
