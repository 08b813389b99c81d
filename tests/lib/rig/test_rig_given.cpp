// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is given of a rig and cannot be used is refused before anything is solved, and the message
// says what to give.
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

class GivenRig : public ::testing::Test {
 protected:
  // Whether the rig is refused in these words.
  static void expect_refused(const std::vector<RigCameraViews>& seen, const RigOptions& options,
                             ErrorCode code, const std::string& words) {
    const auto solved = solve_rig(seen, options);
    ASSERT_FALSE(solved.has_value()) << words;
    EXPECT_EQ(solved.error().code, code) << solved.error().message;
    EXPECT_NE(solved.error().message.find(words), std::string::npos) << solved.error().message;
  }

  Random random_{15};
  std::vector<RigCameraViews> seen_ =
      scenes::seen_by(scenes::stereo_rig(random_), 15, 0.7, random_);
};

TEST_F(GivenRig, IsSolved) { EXPECT_TRUE(solve_rig(seen_).has_value()); }

TEST_F(GivenRig, HasCalibrationsOfTheSizeOfItsViews) {
  Calibration& own = seen_[1].calibration;
  const Camera camera = Camera::make(own).value();
  for (const int factor : {2, 3}) {
    const ImageSize size = camera.image_size();
    own = camera.scaled({size.width * factor, size.height * factor}).to_calibration();
    own.camera = "cam1";
    expect_refused(seen_, {}, ErrorCode::kInvalidArgument, "Scale the camera");
    expect_refused({seen_[1]}, {.mode = RigMode::kFloor}, ErrorCode::kInvalidArgument, "'cam1'");
  }
  // Views that do not say their size are taken as they are.
  own = camera.to_calibration();
  own.camera = "cam1";
  for (View& view : seen_[1].views) view.observation.image_size = {};
  EXPECT_TRUE(solve_rig(seen_).has_value());
}

TEST_F(GivenRig, IsTurnedAboutAxesThatThereAre) {
  for (const int axis : {3, -1, 1'000'000}) {
    RigOptions options;
    options.world = RigWorld{"cam1", {}, {{0, 1}, {axis, 1}}};
    expect_refused(seen_, options, ErrorCode::kInvalidArgument, "axis " + std::to_string(axis));
  }
  RigOptions options;
  options.world = RigWorld{"", kNan, {}};
  expect_refused(seen_, options, ErrorCode::kInvalidArgument, "time of the board");
  options.world->time = kInfinity;
  EXPECT_TRUE(solve_rig(seen_, options).has_value());
}

TEST_F(GivenRig, HasBoardsOfAKnownSize) {
  for (const double sigma : {kNan, kInfinity, -0.01, 1.5, 1e300}) {
    RigOptions options;
    options.board_sigma = sigma;
    expect_refused(seen_, options, ErrorCode::kInvalidArgument, "board_sigma");
  }
  RigOptions exact;
  exact.board_sigma = 0;
  EXPECT_TRUE(solve_rig(seen_, exact).has_value());
}

TEST_F(GivenRig, HasCovariancesOfErrors) {
  Calibration& own = seen_[1].calibration;
  own.parameters[0].sigma = own.parameters[1].sigma = 2;
  const auto refused = [&](std::vector<double> covariance) {
    own.covariance = std::move(covariance);
    expect_refused(seen_, {}, ErrorCode::kInvalidArgument, "'cam1': its covariance");
  };
  refused({4, 0, 0, kNan});
  refused({4, kNan, kNan, 4});
  refused({4, 0, 0, -4});
  refused({4, 1, 2, 4});
  refused({4, 5, 5, 4});
  own.parameters[2].sigma = 2;
  // Each two of them are possible, and all three together are not.
  refused({4, -3.6, -3.6, -3.6, 4, -3.6, -3.6, -3.6, 4});
  own.covariance = {4, -1.6, -1.6, -1.6, 4, -1.6, -1.6, -1.6, 4};
  EXPECT_TRUE(solve_rig(seen_).has_value());
}

TEST_F(GivenRig, HasTimestamps) {
  for (View& view : seen_[1].views) view.observation.timestamp = kNoTimestamp;
  expect_refused(seen_, {}, ErrorCode::kInvalidArgument, "No view of 'cam1' has a timestamp");
  expect_refused(seen_, {}, ErrorCode::kInvalidArgument, "give views their timestamps");
  // Before a floor nothing has to be seen at one time.
  const auto solved = solve_rig({seen_[1]}, {.mode = RigMode::kFloor});
  if (!solved) {
    EXPECT_EQ(solved.error().message.find("timestamp"), std::string::npos);
  }
}

TEST_F(GivenRig, IsLeftOutOfAPartialOneWithItsReason) {
  Random random(16);
  auto seen = scenes::seen_by(scenes::ring_rig(4, random), 60, 0.7, random);
  for (View& view : seen[2].views) view.observation.timestamp = kNoTimestamp;
  const auto solved = solve_rig(seen, {.is_partial = true});
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  ASSERT_EQ(solved->left_out.size(), 1U);
  EXPECT_EQ(solved->left_out[0].camera, "cam2");
  EXPECT_NE(solved->left_out[0].reason.find("has a timestamp"), std::string::npos)
      << solved->left_out[0].reason;
}

TEST_F(GivenRig, HasABoardInCommon) {
  const Board other = parse_board("checkerboard:9x6:31mm").value();
  for (View& view : seen_[1].views) view.board = other;
  const std::string own = seen_[0].views.front().board.text();
  for (const std::string& words : {other.text(), own}) {
    expect_refused(seen_, {}, ErrorCode::kDegenerate, words);
  }
}

}  // namespace
}  // namespace calvin
