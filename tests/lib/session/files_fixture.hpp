// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A session with a file, and another session's file in its place.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "session_fixture.hpp"
#include "temporary_folder.hpp"

namespace calvin {

class FilesOfSessions : public CalibrationSessions {
 protected:
  void begin_with(const std::string& exports = {}, bool overwrite = false) {
    SessionSettings settings;
    settings.location = path_;
    settings.overwrite = overwrite;
    settings.exports = exports;
    begin(settings);
  }
  // What another session left at the place.
  void leave(std::optional<double> error, const char* camera = "left") {
    Calibration left = camera_.to_calibration();
    left.camera = camera;
    left.expected_error = error;
    left.created = "another session";
    ASSERT_TRUE(write_calibration(path_, left).has_value());
  }
  [[nodiscard]] bool is_left(const std::string& path) const {
    const auto found = read_calibration(path);
    return found && found->created == "another session";
  }
  [[nodiscard]] int views_of(const std::string& path) const {
    const auto found = read_calibration(path);
    return found ? static_cast<int>(found->views.size()) : -1;
  }
  // The write that waits; its outcome as the disk gives it.
  SessionFiles::Outcome write() {
    const auto job = session_.take_write();
    EXPECT_TRUE(job.has_value()) << "no write is asked for";
    if (!job || !session_.begin_write(*job)) return {};
    auto outcome = write(*job, [&] { return session_.is_current(job->origin); });
    session_.end_write(*job, outcome);
    return outcome;
  }
  SessionFiles::Outcome write(const WriteJob& job, std::function<bool()> counts) {
    return files_.write(
        job.files, job.calibration, job.final, job.overwrite, job.origin.session,
        {std::move(counts), [this](const Calibration&) { return are_contradicted_; }});
  }
  // Or what a disk would say that is full.
  void fail_to_write() {
    const auto job = session_.take_write();
    ASSERT_TRUE(job.has_value());
    ASSERT_TRUE(session_.begin_write(*job));
    session_.end_write(*job, {make_error(ErrorCode::kIo, "The disk is full."), {}, {}, {}});
  }
  std::vector<std::string> notices() {
    std::vector<std::string> said;
    while (const auto notice = session_.take_notice()) said.push_back(notice->error.message);
    return said;
  }
  // A view more, so that there is another solve, with that result.
  void solve_again(std::optional<double> error) {
    session_.resume();
    show(1);
    solve(error);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.path("cam.json");
  SessionFiles files_;
  bool are_contradicted_ = false;  // what files hold, by the views of the session
};

}  // namespace calvin
