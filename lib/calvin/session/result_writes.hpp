// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which result of a session has yet to reach its files, and what its user should hear of them.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/session/files/session_files.hpp"
#include "calvin/session/session_jobs.hpp"
#include "calvin/session/session_words.hpp"

namespace calvin {

// Not thread-safe. The newest result takes the place of one that waits, and is written as a final
// one where that was final: what a final result may replace, the one after it may.
class ResultWrites {
 public:
  // For a new session: nothing waits, and nothing was said.
  void reset();
  // For other files; whether they can be written now, which the user was told else.
  void begin_files(bool writable);

  void add(const Calibration& result);
  void forget();  // what waits
  // Whether a result is not in all files yet.
  [[nodiscard]] bool waiting() const noexcept { return unwritten_.has_value(); }

  // Asks for a write of the result that waits, if any; take() then gives it, once.
  void ask(bool final);
  [[nodiscard]] std::optional<WriteJob> take(const std::vector<CalibrationFile>& files,
                                             const JobOrigin& origin);
  void begun(const WriteJob& job);
  void ended(const WriteJob& job, const SessionFiles::Outcome& outcome);
  // Of a write whose result does not count any more, too.
  void replaced(const SessionFiles::Outcome& outcome);
  // To say where the write that began last has not ended for so long: once for each set of files.
  [[nodiscard]] std::optional<Notice> late(std::chrono::seconds waited);

  // Whether all files have the newest result, and none stayed as another session left it.
  [[nodiscard]] bool is_written() const noexcept {
    return last_number_ > 0 && !waiting() && status_.has_value() && !stayed_;
  }
  // Of the write that ended last.
  [[nodiscard]] const Status& status() const noexcept { return status_; }
  // What is to be said of the writes that have ended, and what else had to wait; a notice that is
  // taken counts as said.
  void say_later(Notice notice);
  [[nodiscard]] bool has_notice() const noexcept { return !notices_.empty(); }
  [[nodiscard]] std::optional<Notice> take_notice();

 private:
  std::optional<Calibration> unwritten_;        // for the files, which do not all have it
  bool final_waits_ = false;                    // unwritten_ is final, or replaced one that was
  bool asked_ = false;                          // take() has something to give
  std::uint64_t last_number_ = 0;               // of the writes asked for so far
  std::vector<CalibrationFile> being_written_;  // by the write that began last
  Status status_;
  std::deque<Notice> notices_;
  bool stayed_ = false;  // a file did, at the write that ended last
  bool failed_ = false;  // a write did, and there was a notice of it
  bool late_ = false;    // likewise, one did not end
  bool kept_ = false;    // likewise, one left another session's file as it was
};

}  // namespace calvin
