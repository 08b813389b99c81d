// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a CalibrationSession is done, and which of two results is the better one.

#include <cmath>
#include <functional>
#include <numbers>
#include <string_view>
#include <vector>

#include "session_fixture.hpp"

namespace calvin {
namespace {

class SessionGoals : public CalibrationSessions {
 protected:
  // What a new session with target-error=0.2 has reached with a result that is exact to 0.1 px
  // where corners were seen, and otherwise as `change` makes it.
  std::string_view reached_by(const std::function<void(Solution&)>& change) {
    session_ = CalibrationSession();
    settings_ = {};
    SessionSettings settings;
    settings.target_error = 0.2;
    begin(settings);
    show(3);
    const auto job = session_.take_solve();
    Solution solution = found(*job, 0.1);
    change(solution);
    const auto published = session_.solved(*job, solution);
    EXPECT_TRUE(published.has_value());
    return published ? published->reached : "none";
  }
};

// A board that is held in the middle tells little of the rest of the picture.
TEST_F(SessionGoals, AreNotCompleteWithACornerOfThePicture) {
  const std::vector<Pixel> middle = {{540, 380}, {740, 380}, {740, 580}, {540, 580}};
  const std::vector<Pixel> most = {{20, 20}, {1260, 20}, {1260, 940}, {20, 940}};
  struct Case {
    double anywhere;
    std::vector<Pixel> covered;
    std::string_view reached;
  };
  for (const Case& c : {Case{50, middle, ""}, Case{1.01, middle, ""},
                        Case{0.99, middle, "target-error"}, Case{50, most, "target-error"}}) {
    const auto like_that = [&](Solution& solution) {
      solution.calibration.expected_error_anywhere = c.anywhere;
      solution.calibration.covered = c.covered;
    };
    EXPECT_EQ(reached_by(like_that), c.reached) << c.anywhere;
  }
}

// A lens of more than 180 degrees whose picture is round: its corners are black, and no board is
// ever seen there.
TEST_F(SessionGoals, AreCompleteWithAPictureThatIsRound) {
  const std::vector<double> equidistant = {305.6, 305.6, 640, 480, 0, 0, 0, 0};
  const Calibration round =
      Camera::make("fisheye", scenes::kSize, equidistant).value().to_calibration();
  const auto disc = [](double radius) {
    std::vector<Pixel> corners;
    for (int i = 0; i < 64; ++i) {
      const double angle = 2 * std::numbers::pi * i / 64;
      corners.push_back({640 + radius * std::cos(angle), 480 + radius * std::sin(angle)});
    }
    return corners;
  };
  struct Case {
    double radius;  // px, of what boards covered: 480 are 90 degrees from the axis, 453 85
    double anywhere;
    std::string_view reached;
  };
  for (const Case& c : {Case{420, 5, "target-error"}, Case{390, 5, ""}, Case{420, 50, ""}}) {
    const auto like_that = [&](Solution& solution) {
      Calibration& calibration = solution.calibration;
      calibration.model = round.model;
      calibration.parameters = round.parameters;
      calibration.expected_error_anywhere = c.anywhere;
      calibration.covered = disc(c.radius);
    };
    EXPECT_EQ(reached_by(like_that), c.reached) << c.radius << ", " << c.anywhere;
  }
}

// More views of the kind help nobody whose board bends: the words say what does.
TEST_F(SessionGoals, AreNotCompleteWhereSomethingSpeaksAgainstTheResult) {
  const auto bent = [](Solution& solution) {
    solution.misfit.cause = Misfit::Cause::kBoard;
    solution.calibration.misfit = "board";
  };
  EXPECT_EQ(reached_by(bent), "");
  EXPECT_FALSE(session_.progress().done);
  EXPECT_EQ(session_.progress().hint, advice(Misfit::Cause::kBoard));
  // Once a result agrees with its views, it counts.
  show(1);
  const auto next = session_.take_solve();
  EXPECT_EQ(session_.solved(*next, found(*next, 0.1))->reached, "target-error");
  EXPECT_TRUE(session_.progress().done);
  EXPECT_EQ(session_.progress().hint, to_text(Hint{HintKind::kDone}));
}

TEST_F(CalibrationSessions, TellWhatIsKnownOfTheCamera) {
  SessionSettings settings;
  settings.target_error = 0.2;
  begin(settings);
  show(3);
  EXPECT_TRUE(session_.progress().parameters.empty());
  const auto job = session_.take_solve();
  const auto published =
      session_.solved(*job, found(*job, 0.5), {{"focal length", 2}, {"principal point", 0.9}});
  ASSERT_TRUE(published.has_value());
  const Progress now = session_.progress();
  ASSERT_EQ(now.parameters.size(), 2U);
  EXPECT_EQ(now.parameters[0].name, "focal length");
  EXPECT_DOUBLE_EQ(now.parameters[0].known, 0.5);  // wanted: 5 times the target
  EXPECT_DOUBLE_EQ(now.parameters[1].known, 1);
  EXPECT_TRUE(now.summary.empty()) << "not done yet";
}

// Of two results the one is better that is better anywhere: with more of the picture in view, the
// error where corners were seen may grow.
TEST_F(CalibrationSessions, CompareResultsByTheWholePicture) {
  begin();
  show(3);
  const auto first = session_.take_solve();
  Solution small = found(*first, 0.1);
  small.calibration.expected_error_anywhere = 40;
  EXPECT_TRUE(session_.solved(*first, small)->better);
  show(1);
  const auto second = session_.take_solve();
  Solution large = found(*second, 0.2);
  large.calibration.expected_error_anywhere = 0.3;
  EXPECT_TRUE(session_.solved(*second, large)->better);
}

}  // namespace
}  // namespace calvin
