// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session has solved and written, and what it makes of the results.

#include <cmath>
#include <map>
#include <utility>

#include "calvin/session/calibration_session.hpp"
#include "calvin/session/files/replacement.hpp"

namespace calvin {

void CalibrationSession::ask(bool final) {
  // The newest job replaces one that waits, and takes over what it owes.
  final_owed_ |= final;
  asked_ = true;
}

std::optional<SolveJob> CalibrationSession::take_solve() {
  if (!std::exchange(asked_, false) || !enough_views()) return std::nullopt;
  SolveJob job;
  job.views = views_.views();
  job.size = size_;
  job.options = plan_.options;
  job.options.camera = camera_name();
  job.options.initial = initial_;
  job.options.readout = views_.readout();
  job.final = final_owed_;
  if (job.final) job.runs = plan_.settings.runs;
  job.location = plan_.settings.location;
  job.times = times_;
  if (views_.options().mode == CaptureMode::kAuto) job.next_board = board_;
  job.missed = missed_;
  job.lens = lens_.of_views();
  job.origin = origin();
  // Views of an earlier run may be those that it was made of.
  const bool guided = views_.options().mode == CaptureMode::kAuto && !views_.has_restored();
  if (guided) job.earlier = earlier_;
  return job;
}

bool CalibrationSession::judged(const SolveJob& job, std::string words) {
  if (!is_current(job.origin)) return false;
  earlier_.reset();
  notify(std::move(words));
  return true;
}

bool CalibrationSession::is_current(const JobOrigin& origin) const {
  return origin.generation == generation_;
}

std::optional<Error> CalibrationSession::failed(const SolveJob& job, const Error& why) {
  if (!is_current(job.origin)) return std::nullopt;
  solve_error_ = why.message;
  if (job.final) final_owed_ = false;
  if (!std::exchange(answer_owed_, false)) return std::nullopt;
  // More of the views that do not suffice are not enough, as of a board in one and the same place.
  const bool was_full = finished_ && views_.full();
  finished_ = false;
  if (was_full) capture_beyond_limit();
  renew_hint();
  notify(why.message);
  return solve_failed(solve_error_, calibration_.has_value());
}

void CalibrationSession::capture_beyond_limit() {
  constexpr int kMost = 1000;  // a stream may go on for ever
  const int now = plan_.settings.max_views + views_beyond_;
  if (now < kMost) views_beyond_ += now;  // twice as many
  views_.set_options(capture_options());
  next_solve_ = 0;
}

std::optional<Published> CalibrationSession::solved(const SolveJob& job, const Solution& solution,
                                                    std::vector<GroupError> errors) {
  if (!is_current(job.origin)) return std::nullopt;
  calibration_ = solution.calibration;
  compare_with_target();
  parameter_errors_ = std::move(errors);
  misfit_ = solution.misfit.cause;
  if (auto doubt = views_.readout_doubt()) calibration_->remarks.push_back(*std::move(doubt));
  solve_error_.clear();
  answer_owed_ = final_owed_;
  look_for_points();  // by the camera that is known now
  const double error = compared_error(*calibration_).value_or(HUGE_VAL);
  const bool better = job.final || !published_ || error < published_error_.value_or(HUGE_VAL);
  if (better) {
    published_ = true;
    announcement_ = calibration_;
    published_error_ = compared_error(*calibration_);
    writes_.add(*calibration_);
  }
  if (plan_.files.empty()) writes_.forget();
  writes_.ask(job.final);
  // A final result of all views is followed by no other one.
  const bool is_last = job.final && job.origin.revision == revision_;
  const std::string_view reached = finished_ ? "" : end_at_limit(!is_last);
  renew_hint();
  return Published{better, writes_.waiting(), reached};
}

void CalibrationSession::guided(const SolveJob& job, std::shared_ptr<ViewGuide> guide) {
  // Since the search began the user may have asked for another mode, or shown another board.
  const bool wanted = views_.options().mode == CaptureMode::kAuto && !finished_ &&
                      (!board_ || board_ == job.next_board);
  if (!is_current(job.origin) || !wanted) return;
  const bool stays = guide && guide_ && !answered_ && guide->keep_asking(*guide_, views_.views());
  guide_ = std::move(guide);
  if (!stays) asked_at_ = newest_;
  answered_ = false;
  share_ = 0;
  capture_.restart(times_.timestamp);
  end_at_limit();
  renew_hint();
}

std::vector<TakenView> CalibrationSession::newly_rejected(const SolveJob& job,
                                                          const Solution& solution) {
  if (!is_current(job.origin)) return {};
  // Since the solve began views were taken, and others may have had to go.
  std::map<const View*, Reason> reasons;
  for (const RejectedView& view : solution.rejected) {
    reasons[job.views[view.index].get()] = view.reason;
  }
  std::vector<TakenView> rejected;
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const auto found = reasons.find(views_.views()[i].get());
    const Reason now = found == reasons.end() ? Reason::kAccepted : found->second;
    const Reason before = std::exchange(taken_[i].reason, now);
    if (before == Reason::kAccepted && now != before) rejected.push_back(taken_[i]);
  }
  return rejected;
}

void CalibrationSession::reported(const SolveJob& job) {
  if (!job.final) return;
  final_owed_ = answer_owed_ = false;
  final_revision_ = job.origin.revision;
}

std::optional<Calibration> CalibrationSession::take_announcement() {
  return std::exchange(announcement_, std::nullopt);
}

// ---- Interruption and end -----------------------------------------------------------------------

void CalibrationSession::resume() {
  next_solve_ = 0;
  writes_.ask(false);
  if (final_owed_) ask(true);
}

LastWork CalibrationSession::end_of_stream() {
  if (!enough_views()) take_up_others();
  if (final_revision_ != revision_ && enough_views()) {
    ask(true);
    return LastWork::kSolve;
  }
  if (!writes_.waiting()) return LastWork::kNone;
  writes_.ask(true);  // a disk that was full may have room by now
  return LastWork::kWrite;
}

Verdict CalibrationSession::verdict() const {
  Verdict verdict;
  verdict.files_wanted = !plan_.files.empty();
  if (!solve_error_.empty()) {
    verdict.status = tl::unexpected<Error>(solve_failed(solve_error_, calibration_.has_value()));
  } else if (published_) {
    verdict.status = writes_.status();
  } else {
    verdict.status = tl::unexpected<Error>(too_few());
  }
  return verdict;
}

// ---- Writes -------------------------------------------------------------------------------------

std::optional<WriteJob> CalibrationSession::take_write() {
  auto job = writes_.take(plan_.files, origin());
  if (!job) return job;
  job->overwrite = plan_.settings.overwrite;
  job->views = views_.views();
  job->readout = views_.readout();
  return job;
}

bool CalibrationSession::begin_write(const WriteJob& job) {
  if (!is_current(job.origin)) return false;
  writes_.begun(job);
  return true;
}

void CalibrationSession::end_write(const WriteJob& job, const SessionFiles::Outcome& outcome) {
  // While the files were written a new session may have begun, whose own results count.
  if (is_current(job.origin)) writes_.ended(job, outcome);
  // A view may have been removed: what a file held of another session is lost to it all the same.
  if (job.origin.session == session_) writes_.replaced(outcome);
}

}  // namespace calvin
