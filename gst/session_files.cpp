// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which files a session writes, and which stay as another session left them.

#include "session_files.hpp"

#include <utility>

#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/replacement.hpp"

namespace calvin::gst {

SessionFiles::Outcome SessionFiles::write(const std::vector<CalibrationFile>& files,
                                          const Calibration& calibration, bool final,
                                          std::uint64_t session) {
  if (std::exchange(session_, session) != session) ours_.clear();
  std::set<std::string> foreign;
  std::vector<Calibration> others;
  for (const CalibrationFile& file : files) {
    if (final || ours_.contains(file.path) || is_stream(file.path)) continue;
    auto other = read_calibration(file.path);
    if (!other) continue;
    foreign.insert(file.path);
    others.push_back(*std::move(other));
  }
  const bool replace = may_replace(calibration, others);
  Outcome outcome;
  for (const CalibrationFile& file : files) {
    if (!final && is_stream(file.path)) continue;
    if (!replace && foreign.contains(file.path)) {
      if (outcome.kept.empty()) outcome.kept = file.path;
      continue;
    }
    Status written = write_calibration(file.path, calibration, file.format);
    if (written) ours_.insert(file.path);
    if (!written && outcome.status) outcome.status = std::move(written);
  }
  return outcome;
}

}  // namespace calvin::gst
