// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words of a session for its user.

#include "calvin/session/session_words.hpp"

#include <fmt/format.h>

#include "calvin/core/text.hpp"

namespace calvin {

Error too_few_views(std::size_t views, int least) {
  return {
      ErrorCode::kDegenerate,
      fmt::format("No calibration: {} taken, at least {} are needed. Show the whole board, flat "
                  "and sharp, in different places and tilts, and check that the property "
                  "`board` tells its inner corners.",
                  views == 0   ? "no view of the board was"
                  : views == 1 ? "only one view of the board was"
                               : fmt::format("only {} views of the board were", views),
                  least)};
}

Error solve_failed(const std::string& why, bool before) {
  return {
      ErrorCode::kDegenerate,
      (before ? "The final solve failed and the one before it stays: " : "No calibration: ") + why};
}

Error refused_setting(Error why) {
  why.message += " What was set before goes on.";
  return why;
}

Notice late_files(const std::vector<CalibrationFile>& files, std::chrono::seconds waited) {
  std::vector<std::string> paths;
  for (const CalibrationFile& file : files) paths.push_back(file.path);
  return {Notice::Kind::kWarning,
          {ErrorCode::kIo,
           fmt::format("The write of '{}' has not ended after {} s: its disk, or the server or "
                       "reader behind it, does not answer. Results go on to the bus, and the "
                       "newest one is written once it answers; EOS waits for that.",
                       join(paths, "', '"), waited.count())}};
}

Notice kept_file(const std::string& path) {
  return {Notice::Kind::kInfo,
          {ErrorCode::kInvalidArgument,
           fmt::format("'{}' holds the calibration of another session, which stays until this "
                       "one's is final or as good: end with EOS (gst-launch-1.0 -e) or emit "
                       "the signal solve to replace it.",
                       path)}};
}

}  // namespace calvin
