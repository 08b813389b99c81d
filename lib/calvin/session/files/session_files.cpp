// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which files a session writes, and which stay as another session left them.

#include "calvin/session/files/session_files.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/session/files/replacement.hpp"

namespace calvin {

namespace {

std::string figures(const Calibration& calibration) {
  const auto error = compared_error(calibration);
  std::string text =
      error ? fmt::format("an expected error of {:.3g} px anywhere in the picture", *error)
            : std::string("no expected error");
  const std::size_t views = calibration.views.size();
  if (views > 0) text += fmt::format(" from {} view{}", views, views == 1 ? "" : "s");
  return text;
}

// A word for the user where the calibration before was better by its own figures.
std::optional<Error> lost_by(const std::string& path, const Calibration& before,
                             const Calibration& now, const Status& kept) {
  const auto error_before = compared_error(before);
  if (!error_before) {
    if (kept) return std::nullopt;
    return Error{
        kept.error().code,
        fmt::format("'{}' held a calibration of another session, which this one's took the "
                    "place of. No copy of it could be kept. {}",
                    path, kept.error().message)};
  }
  const auto error = compared_error(now);
  if (error && *error <= *error_before) return std::nullopt;
  const std::string whose =
      before.camera != now.camera ? fmt::format(" of the camera '{}'", before.camera) : "";
  const std::string where = kept ? fmt::format("It is kept as '{}'.", copy_of(path))
                                 : "No copy of it could be kept. " + kept.error().message;
  return Error{
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' held a calibration{} of another session that was better by its own "
                  "figures, with {}; this one, with {}, took its place. {}",
                  path, whose, figures(before), figures(now), where)};
}

}  // namespace

bool SessionFiles::holds_ours(const std::string& path) const {
  const auto ours = ours_.find(path);
  if (ours == ours_.end()) return false;
  const auto bytes = read_file(path);
  return bytes && *bytes == ours->second;
}

Status SessionFiles::write_one(const CalibrationFile& file, const Calibration& calibration) {
  auto text = print_calibration(calibration, file.format);
  if (!text) return tl::unexpected<Error>(text.error());
  Status written = write_file(file.path, *text);
  if (written) ours_[file.path] = *std::move(text);
  return written;
}

SessionFiles::Outcome SessionFiles::write(const std::vector<CalibrationFile>& files,
                                          const Calibration& calibration, bool final,
                                          std::uint64_t session,
                                          const std::function<bool()>& counts) {
  if (std::exchange(session_, session) != session) ours_.clear();
  std::map<std::string, Calibration> foreign;
  std::vector<Calibration> others;
  bool any_unread = false;
  for (const CalibrationFile& file : files) {
    if (is_stream(file.path) || holds_ours(file.path)) continue;
    auto other = read_calibration(file.path);
    // What only another build or a later version reads is one that tells nothing of itself.
    const bool unread = !other && other.error().code == ErrorCode::kUnsupported;
    any_unread |= unread;
    if (unread) other = Calibration();
    if (!other) continue;
    others.push_back(*other);
    foreign.emplace(file.path, *std::move(other));
  }
  const bool replace = final || (!any_unread && may_replace(calibration, others));
  Outcome outcome;
  for (const CalibrationFile& file : files) {
    if (!counts()) break;
    if (!final && is_stream(file.path)) continue;
    const auto before = foreign.find(file.path);
    if (!replace && before != foreign.end()) {
      if (outcome.kept.empty()) outcome.kept = file.path;
      continue;
    }
    const Status kept = before != foreign.end() ? keep_copy(file.path) : Status();
    Status written = write_one(file, calibration);
    if (written && before != foreign.end() && !outcome.lost) {
      outcome.lost = lost_by(file.path, before->second, calibration, kept);
    }
    if (!written && outcome.status) outcome.status = std::move(written);
  }
  return outcome;
}

}  // namespace calvin
