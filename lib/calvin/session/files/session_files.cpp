// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which files a session writes, and which stay as another session left them.

#include "calvin/session/files/session_files.hpp"

#include <filesystem>
#include <system_error>
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

// The errors of pictures of different sizes are compared in parts of them.
bool is_better(const Calibration& one, const Calibration& other) {
  const auto error = compared_error(one);
  const auto of_other = compared_error(other);
  if (!error || !of_other) return error.has_value();
  return kAsGood * *error * other.image_size.width < *of_other * one.image_size.width;
}

KeptCopy keep_calibration(const std::string& path, const Calibration& before) {
  const auto copy = read_calibration(copy_of(path));
  const bool is_like =
      copy && copy->camera == before.camera && copy->image_size == before.image_size;
  if (is_like && is_better(*copy, before)) {
    return {{}, fmt::format("'{}' holds one that was better still, and stays.", copy_of(path))};
  }
  Status kept = keep_copy(path);
  std::string where = kept ? fmt::format("It is kept as '{}'.", copy_of(path))
                           : "No copy of it could be kept. " + kept.error().message;
  return {std::move(kept), std::move(where)};
}

// A word for the user where the calibration before was of another camera, as where two elements
// name one file, or better by its own figures.
std::optional<Error> lost_by(const std::string& path, const Calibration& before,
                             const Calibration& now, const KeptCopy& kept) {
  if (!compared_error(before)) {
    if (kept.status) return std::nullopt;
    return Error{kept.status.error().code,
                 fmt::format("'{}' held a calibration of another session, which this one's took "
                             "the place of. {}",
                             path, kept.where)};
  }
  std::string whose;
  if (before.camera != now.camera) whose += fmt::format(" of the camera '{}'", before.camera);
  if (!is_better(before, now)) {
    if (before.camera == now.camera || before.camera.empty()) return std::nullopt;
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("'{}' held a calibration{}, which that of '{}' took the place of: give "
                    "each camera a file of its own. {}",
                    path, whose, now.camera, kept.where)};
  }
  if (before.image_size != now.image_size) {
    whose += fmt::format(" of {}x{} pictures", before.image_size.width, before.image_size.height);
  }
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("'{}' held a calibration{} of another session that was better by its "
                           "own figures, with {}; this one, with {}, took its place. {}",
                           path, whose, figures(before), figures(now), kept.where)};
}

// A word for the user where a final result does not take the place of a better one.
Error stays(const std::string& path, const Calibration& before, const Calibration& now) {
  return {
      ErrorCode::kInvalidArgument,
      fmt::format("'{}' stays: the calibration of before is better by its own figures, with {}, "
                  "than this one with {}, and these views do not contradict it. Set "
                  "overwrite=true to replace it, or name another file.",
                  path, figures(before), figures(now))};
}

// Formats that name no camera may hold any.
bool is_of_same_camera(const Calibration& before, const Calibration& now) {
  return before.image_size == now.image_size &&
         (before.camera.empty() || before.camera == now.camera);
}

// Keeps what is no calibration, under a name that is free, and says so: whoever names a file of
// boards or of views here means another one. It may be larger than any calibration.
std::optional<Error> keep_other(const std::string& path) {
  constexpr int kMost = 100;
  std::error_code failed;
  if (!(std::filesystem::file_size(path, failed) > 0) || failed) return std::nullopt;
  std::string copy = copy_of(path);
  const auto is_taken = [&copy] {
    std::error_code unknown;
    return std::filesystem::exists(std::filesystem::symlink_status(copy, unknown));
  };
  for (int n = 2; n <= kMost && is_taken(); ++n) copy = fmt::format("{}~{}~", path, n);
  std::filesystem::copy_file(path, copy, failed);
  const std::string where = failed ? "No copy of it could be kept: " + failed.message() + "."
                                   : fmt::format("It is kept as '{}'.", copy);
  return Error{failed ? ErrorCode::kIo : ErrorCode::kInvalidArgument,
               fmt::format("'{}' held something that is no calibration, which this one took the "
                           "place of. {}",
                           path, where)};
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

SessionFiles::Foreign SessionFiles::find_foreign(const std::vector<CalibrationFile>& files) const {
  Foreign foreign;
  for (const CalibrationFile& file : files) {
    if (is_stream(file.path) || holds_ours(file.path)) continue;
    auto other = read_calibration(file.path);
    const bool unread = !other && other.error().code == ErrorCode::kUnsupported;
    foreign.has_unread |= unread;
    if (unread) other = Calibration();  // which tells nothing of itself
    if (other) foreign.calibrations.push_back(*other);
    foreign.by_path.emplace(file.path, other ? std::optional(*std::move(other)) : std::nullopt);
  }
  return foreign;
}

std::optional<Error> SessionFiles::take_loss(const std::string& path, const Calibration& now,
                                             bool final) {
  const auto replaced = replaced_.find(path);
  if (replaced == replaced_.end()) return std::nullopt;
  const auto& [before, kept] = replaced->second;
  // Without a copy it is gone whatever comes next.
  if (!final && kept.status) return std::nullopt;
  auto lost = lost_by(path, before, now, kept);
  replaced_.erase(replaced);
  return lost;
}

SessionFiles::Outcome SessionFiles::write(const std::vector<CalibrationFile>& files,
                                          const Calibration& calibration, bool final,
                                          bool overwrite, std::uint64_t session,
                                          const Questions& questions) {
  if (std::exchange(session_, session) != session) {
    ours_.clear();
    replaced_.clear();
  }
  const Foreign foreign = find_foreign(files);
  const auto better = std::ranges::find_if(foreign.calibrations, [&](const Calibration& before) {
    return is_better_of_same(before, calibration);
  });
  const bool is_better = final && !overwrite && better != foreign.calibrations.end() &&
                         !questions.contradicted(*better);
  const bool replace =
      overwrite || final || (!foreign.has_unread && may_replace(calibration, foreign.calibrations));
  Outcome outcome;
  for (const CalibrationFile& file : files) {
    if (!questions.counts()) break;
    if (!final && is_stream(file.path)) continue;
    const auto found = foreign.by_path.find(file.path);
    const bool is_foreign = found != foreign.by_path.end();
    const Calibration* before = is_foreign && found->second ? &*found->second : nullptr;
    if (before != nullptr && is_better && is_of_same_camera(*before, calibration)) {
      if (!outcome.stayed) outcome.stayed = stays(file.path, *better, calibration);
      continue;
    }
    if (!replace && before != nullptr) {
      if (outcome.kept.empty()) outcome.kept = file.path;
      continue;
    }
    if (before != nullptr) {
      replaced_.insert_or_assign(file.path,
                                 Replaced{*before, keep_calibration(file.path, *before)});
    }
    std::optional<Error> lost;
    if (is_foreign && before == nullptr) lost = keep_other(file.path);
    Status written = write_one(file, calibration);
    if (!written) {
      if (outcome.status) outcome.status = std::move(written);
      continue;
    }
    if (auto by_this = take_loss(file.path, calibration, final); !lost) lost = std::move(by_this);
    if (lost && !outcome.lost) outcome.lost = std::move(lost);
  }
  return outcome;
}

}  // namespace calvin
