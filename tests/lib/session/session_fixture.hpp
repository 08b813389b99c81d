// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A calibration session that is told by a test what is seen, solved and written, in the order in
// which threads of calibsolve would tell it.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calvin/session/calibration_session.hpp"
#include "scenes.hpp"

namespace calvin {

class CalibrationSessions : public ::testing::Test {
 protected:
  // A run that keeps every view, for frames of scenes::kSize.
  void begin(SessionSettings settings = {}) {
    settings.capture_mode = CaptureChoice::kAll;
    settings_ = settings;
    session_.start(make_plan(settings).value(), true);
    std::optional<Error> warning;
    EXPECT_TRUE(session_.set_size(scenes::kSize, warning));
    EXPECT_FALSE(warning.has_value());
    session_.set_live(false);
  }

  // The frame of that number, at n / 30 s.
  static FrameTimes times(int n) {
    const auto at = static_cast<std::uint64_t>(n) * 33'333'333;
    return {at, at + 1, at + 2, 33'333'333};
  }
  Observation seen(int n) {
    scenes::Random random(static_cast<unsigned>(n));
    const SE3 pose = scenes::random_pose(camera_, scenes::kBoard, random, 0.5);
    Observation o = scenes::observe(camera_, scenes::kBoard, pose, 0.1, random).observation;
    o.camera = "left";
    o.timestamp = times(n).timestamp;
    return o;
  }
  // So many new views; what came of the last one.
  Offered show(int count) {
    Offered last;
    for (int i = 0; i < count; ++i, ++frame_) last = session_.offer(seen(frame_), times(frame_));
    return last;
  }

  // What a solve of that job could find.
  static Solution found(const SolveJob& job, std::optional<double> expected_error) {
    Solution solution;
    solution.calibration =
        Camera::make("pinhole", job.size, {1100, 1100, 639.5, 479.5}).value().to_calibration();
    solution.calibration.camera = job.options.camera;
    solution.calibration.expected_error = expected_error;
    solution.calibration.views.resize(job.views.size());
    return solution;
  }
  // The job that waits is solved with that expected error, and its result is reported.
  std::optional<Published> solve(std::optional<double> expected_error) {
    const auto job = session_.take_solve();
    EXPECT_TRUE(job.has_value()) << "no solve is asked for";
    if (!job) return std::nullopt;
    const auto published = session_.solved(*job, found(*job, expected_error));
    session_.reported(*job);
    return published;
  }
  // Other settings, as they come into force at once.
  std::vector<Error> set(const SessionSettings& settings) {
    settings_ = settings;
    const auto update = session_.begin_update(settings);
    EXPECT_TRUE(update.has_value()) << "nothing has changed";
    return session_.end_update(*update, read_settings(*update), settings).value();
  }

  Camera camera_ = Camera::make("pinhole", scenes::kSize, {1100, 1100, 639.5, 479.5}).value();
  SessionSettings settings_;
  CalibrationSession session_;
  int frame_ = 0;
};

}  // namespace calvin
