// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Keeps the result that waits for its files until a write of it has ended well.

#include "calvin/session/result_writes.hpp"

#include <utility>

namespace calvin {

void ResultWrites::reset() {
  forget();
  status_ = {};
  notices_.clear();
  late_ = kept_ = stayed_ = false;
}

void ResultWrites::begin_files(bool writable) {
  status_ = {};
  failed_ = !writable;
  late_ = kept_ = stayed_ = false;
}

void ResultWrites::add(const Calibration& result) { unwritten_ = result; }

void ResultWrites::say_later(Notice notice) { notices_.push_back(std::move(notice)); }

void ResultWrites::forget() {
  unwritten_.reset();
  final_waits_ = asked_ = false;
}

void ResultWrites::ask(bool final) {
  if (!unwritten_) return;
  final_waits_ |= final;
  asked_ = true;
}

std::optional<WriteJob> ResultWrites::take(const std::vector<CalibrationFile>& files,
                                           const JobOrigin& origin) {
  if (!std::exchange(asked_, false) || !unwritten_) return std::nullopt;
  WriteJob job;
  job.calibration = *unwritten_;
  job.files = files;
  job.final = final_waits_;
  job.origin = origin;
  job.number = ++last_number_;
  return job;
}

void ResultWrites::begun(const WriteJob& job) {
  final_waits_ = false;
  being_written_ = job.files;
}

void ResultWrites::ended(const WriteJob& job, const SessionFiles::Outcome& outcome) {
  const Status& written = outcome.status;
  status_ = written;
  stayed_ = !outcome.kept.empty() || outcome.stayed.has_value();
  final_waits_ |= !written && job.final;  // it is final when it is tried again, too
  // A newer calibration may wait behind this one.
  if (written && job.number == last_number_) unwritten_.reset();
  if (!written && !std::exchange(failed_, true)) {
    notices_.push_back({Notice::Kind::kWarning, written.error()});
  }
  if (!outcome.kept.empty() && !std::exchange(kept_, true)) {
    notices_.push_back(kept_file(outcome.kept));
  }
}

void ResultWrites::replaced(const SessionFiles::Outcome& outcome) {
  for (const auto& word : {outcome.lost, outcome.stayed}) {
    if (word) notices_.push_back({Notice::Kind::kWarning, *word});
  }
}

std::optional<Notice> ResultWrites::late(std::chrono::seconds waited) {
  if (std::exchange(late_, true)) return std::nullopt;
  return late_files(being_written_, waited);
}

std::optional<Notice> ResultWrites::take_notice() {
  if (notices_.empty()) return std::nullopt;
  Notice first = std::move(notices_.front());
  notices_.pop_front();
  return first;
}

}  // namespace calvin
