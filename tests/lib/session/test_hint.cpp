// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a session asks for next, against where boards were seen, and the words for it.
#include <gtest/gtest.h>

#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "calvin/session/session.hpp"
#include "scenes.hpp"

namespace calvin {

void PrintTo(const Hint& hint, std::ostream* out) { *out << to_text(hint); }

namespace {

using enum HintKind;
using enum HintDirection;
using scenes::kBoard;

// A place of the board: its centre at (x, y) m, z m ahead, turned about the axes of the camera.
struct Place {
  double x = 0, y = 0, z = 0.4, about_x = 0, about_y = 0;
};

constexpr Place kNear{0, 0, 0.3};
// Turned about y by a positive angle, the right edge comes nearer; about x, the top one.
constexpr Place kLeftNearer{0, 0, 0.4, 0, -0.6};
constexpr Place kRightNearer{0, 0, 0.4, 0, 0.6};
constexpr Place kTopNearer{0, 0, 0.4, 0.6, 0};
constexpr Place kBottomNearer{0, 0, 0.4, -0.6, 0};

// The hint after these views.
Hint after(const std::vector<Place>& places, double focal = 1100) {
  scenes::Random random{1};
  const Camera camera =
      Camera::make("pinhole", scenes::kSize, {focal, focal, 639.5, 479.5}).value();
  const Eigen::Vector3d center(0.1, 0.0625, 0);
  Session session({CaptureMode::kAll, 3, 0});
  for (const Place& p : places) {
    const Eigen::Matrix3d rotation = exp_so3({p.about_x, p.about_y, 0});
    const SE3 pose = {rotation, Eigen::Vector3d(p.x, p.y, p.z) - rotation * center};
    EXPECT_EQ(session.offer(scenes::observe(camera, kBoard, pose, 0.02, random)),
              Reason::kAccepted);
  }
  EXPECT_EQ(session.progress().hint, to_text(session.hint()));
  return session.hint();
}

std::vector<Place> tilted_and(std::vector<Place> more) {
  more.insert(more.end(), {kNear, kLeftNearer, kRightNearer, kTopNearer, kBottomNearer});
  return more;
}

TEST(Hints, BeginWithTheBoardAndItsSize) {
  EXPECT_EQ(after({}), (Hint{kShowBoard, kNone}));
  EXPECT_EQ(after({{0, 0, 1.2}}), (Hint{kComeCloser, kNone}));
}

TEST(Hints, AskForTheEdgeThatWasNeverNearer) {
  EXPECT_EQ(after({kNear, kRightNearer, kTopNearer, kBottomNearer}), (Hint{kTilt, kLeft}));
  EXPECT_EQ(after({kNear, kLeftNearer, kTopNearer, kBottomNearer}), (Hint{kTilt, kRight}));
  EXPECT_EQ(after({kNear, kLeftNearer, kRightNearer, kBottomNearer}), (Hint{kTilt, kTop}));
  EXPECT_EQ(after({kNear, kLeftNearer, kRightNearer, kTopNearer}), (Hint{kTilt, kBottom}));
}

TEST(Hints, AskForTheSideOfTheImageWhereTheBoardWasNot) {
  constexpr Place kAtLeft{-0.19, 0, 0.55};
  constexpr Place kAtRight{0.19, 0, 0.55};
  constexpr Place kAtTop{0, -0.16, 0.55};
  constexpr Place kAtBottom{0, 0.16, 0.55};
  EXPECT_EQ(after(tilted_and({kAtLeft})), (Hint{kMove, kRight}));
  EXPECT_EQ(after(tilted_and({kAtRight})), (Hint{kMove, kLeft}));
  EXPECT_EQ(after(tilted_and({kAtLeft, kAtRight, kAtTop})), (Hint{kMove, kBottom}));
  EXPECT_EQ(after(tilted_and({kAtLeft, kAtRight, kAtBottom})), (Hint{kMove, kTop}));
  EXPECT_EQ(after(tilted_and({kAtLeft, kAtRight, kAtTop, kAtBottom, {0, 0, 0.45, 0.6, 0.6}})),
            (Hint{kGood, kNone}));
}

TEST(Hints, AskForMoreTiltWhereEveryEdgeWasALittleNearer) {
  EXPECT_EQ(after({kNear,
                   {0, 0, 0.4, 0, -0.3},
                   {0, 0, 0.4, 0, 0.3},
                   {0, 0, 0.4, 0.45, 0},
                   {0, 0, 0.4, -0.45, 0},
                   {-0.19, -0.16, 0.55},
                   {0.19, 0.16, 0.55}}),
            (Hint{kTilt, kNone}));
}

// The bars are full: there is nothing to ask for.
TEST(Hints, AskForNothingWhereAllIsSpanned) {
  EXPECT_EQ(after({kNear, {-0.19, -0.16, 0.55}, {0.19, 0.16, 0.55}, {0, 0, 0.45, 0.6, 0.6}}),
            (Hint{kGood, kNone}));
}

// From far away both edges look equally long, however much the board is tilted.
TEST(Hints, AskALongLensForNoEdgeThatItCannotTell) {
  constexpr double kFocal = 9000;  // 8 degrees across
  constexpr double kScale = kFocal / 1100;
  const std::vector<Place> near = {{0, 0, 0.3 * kScale}};
  EXPECT_EQ(after(near, kFocal).kind, kTilt);
  // Too little of a tilt tells nothing.
  EXPECT_EQ(after({near[0], {0, 0, 0.35 * kScale, 0, 0.2}}, kFocal), (Hint{kTilt, kLeft}));
  EXPECT_EQ(after({near[0], {0, 0, 0.35 * kScale, 0, 0.7}}, kFocal), (Hint{kTilt, kTop}));
  EXPECT_EQ(after({near[0], {0, 0, 0.35 * kScale, 0.7, 0}}, kFocal), (Hint{kTilt, kLeft}));
  EXPECT_EQ(
      after({near[0], {0, 0, 0.35 * kScale, 0, 0.7}, {0, 0, 0.35 * kScale, -0.7, 0}}, kFocal).kind,
      kMove);
}

TEST(Hints, EachThatIsMadeHasItsOwnSentence) {
  std::set<std::string> sentences;
  for (const Hint& hint : std::vector<Hint>{{kShowBoard, kNone},
                                            {kComeCloser, kNone},
                                            {kMove, kLeft},
                                            {kMove, kRight},
                                            {kMove, kTop},
                                            {kMove, kBottom},
                                            {kTilt, kLeft},
                                            {kTilt, kRight},
                                            {kTilt, kTop},
                                            {kTilt, kBottom},
                                            {kTilt, kNone},
                                            {kGood, kNone}}) {
    EXPECT_TRUE(sentences.insert(to_text(hint)).second) << to_text(hint);
  }
  for (const HintKind kind : {kShowBoard, kComeCloser, kMove, kTilt, kGood}) {
    for (const HintDirection direction : {kNone, kLeft, kRight, kTop, kBottom}) {
      EXPECT_TRUE(to_text({kind, direction}).ends_with('.'));
    }
  }
}

// A hint of a direction names it, and no other.
TEST(Hints, SayWhichWay) {
  const std::vector<std::pair<HintDirection, std::string>> names = {
      {kLeft, " left "}, {kRight, " right "}, {kTop, " top "}, {kBottom, " bottom "}};
  for (const auto& [kind, verb] : {std::pair(kMove, "Move "), {kTilt, "Tilt "}}) {
    for (const HintDirection direction : {kNone, kLeft, kRight, kTop, kBottom}) {
      const std::string text = to_text({kind, direction});
      EXPECT_TRUE(text.starts_with(verb)) << text;
      for (const auto& [named, name] : names) {
        EXPECT_EQ(text.find(name) != std::string::npos, named == direction) << text;
      }
    }
  }
}

// What leads to a place is told beside the outline that shows it.
TEST(Hints, LeadToTheOutline) {
  EXPECT_EQ(text_to_outline({kMove, kLeft}), "To the outline: move left in the image.");
  EXPECT_EQ(text_to_outline({kTilt, kTop}),
            "To the outline: tilt the board, its top edge nearer to the camera.");
  EXPECT_EQ(text_to_outline({kMove, kUpperRight, kComeCloser}),
            "To the outline: move right and up in the image, and come closer.");
  EXPECT_EQ(text_to_outline({kMoveBack, kLeft, kTilt}),
            "To the outline: move away from the camera, its left edge nearer than the other.");
  EXPECT_EQ(text_to_outline({kComeCloser}), "To the outline: come closer.");
  for (const HintKind kind : {HintKind::kHoldStill, HintKind::kGood, HintKind::kDone}) {
    EXPECT_EQ(text_to_outline({kind}), to_text({kind}));
  }
  EXPECT_EQ(done_text("cam.json"), "Done: the calibration is in 'cam.json'.");
}

}  // namespace
}  // namespace calvin
