// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The files of a session that goes on, which may hold what another session left.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/result.hpp"
#include "calvin/session/files/calibration_files.hpp"

namespace calvin {

// A copy of what a file held, which is kept unless a better one of the same camera is there
// already, and where it is for the user.
struct KeptCopy {
  Status status;
  std::string where;
};

// Belongs to the thread that writes.
class SessionFiles {
 public:
  struct Outcome {
    Status status;                // the first error
    std::string kept;             // the first file that stays as another session left it, or empty
    std::optional<Error> lost;    // the first one that held something better, for the user
    std::optional<Error> stayed;  // likewise, that stays though the result is final
  };
  struct Questions {
    // Whether the result still counts.
    std::function<bool()> counts = [] { return true; };
    // Whether the views of the session contradict what a file holds, as after a change of focus.
    std::function<bool(const Calibration&)> contradicted = [](const Calibration&) { return false; };
  };

  // Writes a final result to all files, but for those of another session that hold a calibration
  // that is_better_of_same() and not contradicted; then all calibrations of that camera stay, so
  // that they go on saying the same. A result on the way to it does not take the place of another
  // session's calibration, unless may_replace() says that nothing is lost; it goes to files that
  // are not there yet or hold no calibration, and to those that hold what this session has written
  // before: what someone has put there since is another session's. With `overwrite` all are
  // replaced. What is no calibration is kept, too. A pipe or a device gets final results alone:
  // what is read from it cannot be replaced. What another session's file FILE held is kept as
  // FILE~, unless that holds a better one of the same camera already; that it was better is said
  // with the final result.
  //
  // Before each file counts() is asked; once it is false the others stay as they are.
  [[nodiscard]] Outcome write(const std::vector<CalibrationFile>& files,
                              const Calibration& calibration, bool final, bool overwrite,
                              std::uint64_t session, const Questions& questions);

 private:
  // What the files hold that are not this session's; no calibration is absent.
  struct Foreign {
    std::map<std::string, std::optional<Calibration>> by_path;
    std::vector<Calibration> calibrations;
    bool has_unread = false;  // what only another build or a later version reads
  };
  [[nodiscard]] Foreign find_foreign(const std::vector<CalibrationFile>& files) const;
  [[nodiscard]] bool holds_ours(const std::string& path) const;
  [[nodiscard]] Status write_one(const CalibrationFile& file, const Calibration& calibration);
  // What is said of another session's calibration whose place `now` has: once, and for good.
  [[nodiscard]] std::optional<Error> take_loss(const std::string& path, const Calibration& now,
                                               bool final);

  std::uint64_t session_ = 0;
  std::map<std::string, std::string> ours_;  // by path, what session_ has written last

  // A calibration of another session whose place was taken by a result on the way, and where it is
  // now: whether anything was lost the final result tells.
  struct Replaced {
    Calibration before;
    KeptCopy kept;
  };
  std::map<std::string, Replaced> replaced_;  // by path
};

}  // namespace calvin
