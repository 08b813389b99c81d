// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the session behind calibsolve does on its writer: a thread of its own, for a disk or a
// server may never answer.

#include <memory>
#include <utility>

#include <fmt/format.h>

#include "solve/calib_solver.hpp"

GST_DEBUG_CATEGORY_EXTERN(calibsolve_debug);
#define GST_CAT_DEFAULT calibsolve_debug

namespace calvin::gst {

struct CalibSolver::Write {
  Calibration calibration;
  std::vector<CalibrationFile> files;
  bool final = false;
  std::uint64_t session = 0;
  std::uint64_t generation = 0;
  std::uint64_t number = 0;
};

void CalibSolver::request_write(const std::vector<CalibrationFile>& files, bool final) {
  final_waits_ |= final;
  auto write = std::make_shared<Write>(
      Write{*unwritten_, files, final_waits_, session_number_, generation_, ++writes_});
  writer_.offer([this, write](const std::stop_token& stop) { this->write(*write, stop); });
}

bool CalibSolver::begin_write(const Write& write) {
  const std::lock_guard guard(lock_);
  if (write.generation != generation_) return false;
  final_waits_ = false;
  being_written_ = write.files;
  return true;
}

void CalibSolver::write(const Write& write, const std::stop_token& stop) {
  if (!begin_write(write)) return;
  const auto outcome = files_.write(write.files, write.calibration, write.final, write.session);
  const std::string& kept = outcome.kept;
  GST_DEBUG_OBJECT(element_, "%" G_GSIZE_FORMAT " files: %s", write.files.size(),
                   outcome.status ? "written" : outcome.status.error().message.c_str());
  if (!kept.empty()) GST_INFO_OBJECT(element_, "'%s' stays another session's", kept.c_str());
  bool held = false;
  for (const Error& warning : end_write(write, outcome, held)) {
    if (const auto report = begin_report(write, stop)) post_warning(element_, warning);
  }
  if (!held) return;
  if (const auto report = begin_report(write, stop)) {
    post_info(element_,
              fmt::format("'{}' holds the calibration of another session, which stays until this "
                          "one's is final or as good: end with EOS (gst-launch-1.0 -e) or emit "
                          "the signal solve to replace it.",
                          kept));
  }
}

std::vector<Error> CalibSolver::end_write(const Write& write, const SessionFiles::Outcome& outcome,
                                          bool& held) {
  const auto& [written, kept, lost] = outcome;
  std::vector<Error> warnings;
  const std::lock_guard guard(lock_);
  // While the file was written, a new session may have begun, whose own results count.
  if (write.generation != generation_) return {};
  held = !kept.empty() && !std::exchange(kept_reported_, true);
  written_ = written;
  final_waits_ |= !written && write.final;  // it is final when it is tried again, too
  // A newer calibration may wait behind this one.
  if (written && write.number == writes_) unwritten_.reset();
  if (!written && !std::exchange(write_failed_, true)) warnings.push_back(written.error());
  if (lost) warnings.push_back(*lost);
  return warnings;
}

std::unique_ptr<Worker::Report> CalibSolver::begin_report(const Write& write,
                                                          const std::stop_token& stop) {
  const std::lock_guard guard(lock_);
  return write.generation == generation_ ? writer_.begin_report(stop, element_) : nullptr;
}

}  // namespace calvin::gst
