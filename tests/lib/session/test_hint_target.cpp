// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a hint wants the board, held against where a camera would see it there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/session/guidance/hint_target.hpp"
#include "calvin/session/session.hpp"
#include "scenes.hpp"
#include "session_fixture.hpp"

namespace calvin {
namespace {

using enum HintKind;
using enum HintDirection;
using scenes::kBoard;
using scenes::kSize;

Camera pinhole(double focal) {
  return Camera::make("pinhole", kSize, {focal, focal, 639.5, 479.5}).value();
}

// The board at (x, y) m, z m ahead, its edges turned towards the camera by two angles.
struct Place {
  double x = 0, y = 0, z = 0.4, about_x = 0, about_y = 0;
};

View see(const Camera& camera, const Place& p) {
  scenes::Random random{1};
  const Eigen::Matrix3d rotation = exp_so3({p.about_x, p.about_y, 0});
  const Eigen::Vector3d center(0.1, 0.0625, 0);
  return scenes::observe(camera, kBoard,
                         {rotation, Eigen::Vector3d(p.x, p.y, p.z) - rotation * center}, 0, random);
}

// What the views ask for, and where they want the board.
Hint after(const Camera& camera, const std::vector<Place>& places) {
  ViewCoverage coverage;
  for (const Place& place : places) coverage.add(see(camera, place));
  Hint hint = coverage.hint();
  hint.target = hint_target(coverage, kBoard, camera);
  return hint;
}

// The corners of the board there, from the first one of its first row on; they must be seen.
std::vector<Pixel> corners_at(const Camera& camera, const Pose& target) {
  const BoardArea area = kBoard.extent();
  std::vector<Pixel> corners;
  for (const auto& [x, y] : {std::pair(area.left, area.top),
                             {area.right, area.top},
                             {area.right, area.bottom},
                             {area.left, area.bottom}}) {
    corners.push_back(camera.project(to_se3(target) * Eigen::Vector3d(x, y, 0)).value());
  }
  return corners;
}

constexpr Place kNear{0, 0, 0.3};
constexpr Place kLeftNearer{0, 0, 0.4, 0, -0.6};
constexpr Place kRightNearer{0, 0, 0.4, 0, 0.6};
constexpr Place kTopNearer{0, 0, 0.4, 0.6, 0};
constexpr Place kBottomNearer{0, 0, 0.4, -0.6, 0};
const std::vector<Place> kTilted = {kNear, kLeftNearer, kRightNearer, kTopNearer, kBottomNearer};

TEST(HintTargets, ShowTheWholeBoardInTheMiddle) {
  const Camera camera = pinhole(1100);
  const Hint hint = after(camera, {});
  ASSERT_EQ(hint.kind, kShowBoard);
  ASSERT_TRUE(hint.target.has_value());
  EXPECT_TRUE(scenes::sees_all(camera, kBoard, to_se3(*hint.target)));
  const auto c = corners_at(camera, *hint.target);
  EXPECT_NEAR(c[0].u + c[2].u, 2 * 639.5, 1);
  EXPECT_NEAR(c[0].v + c[2].v, 2 * 479.5, 1);
}

TEST(HintTargets, AreCloserThanAnyViewBefore) {
  const Camera camera = pinhole(1100);
  const Place far{0, 0, 1.2};
  const Hint hint = after(camera, {far});
  ASSERT_EQ(hint.kind, kComeCloser);
  ASSERT_TRUE(hint.target.has_value());
  const double area = polygon_area(corners_at(camera, *hint.target));
  EXPECT_GT(std::abs(area), 0.16 * kSize.width * kSize.height) << "what counts as large";
  EXPECT_TRUE(scenes::sees_all(camera, kBoard, to_se3(*hint.target)));
}

TEST(HintTargets, BringTheEdgeNearerThatTheHintNames) {
  const Camera camera = pinhole(1100);
  // The corners of each edge, and of the one opposite.
  const struct {
    HintDirection edge;
    std::vector<Place> before;
    std::size_t near[2], far[2];
  } kEdges[] = {
      {kLeft, {kNear, kRightNearer, kTopNearer, kBottomNearer}, {0, 3}, {1, 2}},
      {kRight, {kNear, kLeftNearer, kTopNearer, kBottomNearer}, {1, 2}, {0, 3}},
      {kTop, {kNear, kLeftNearer, kRightNearer, kBottomNearer}, {0, 1}, {3, 2}},
      {kBottom, {kNear, kLeftNearer, kRightNearer, kTopNearer}, {3, 2}, {0, 1}},
  };
  for (const auto& [edge, before, near, far] : kEdges) {
    const Hint hint = after(camera, before);
    SCOPED_TRACE(to_text(hint));
    ASSERT_EQ(hint, (Hint{kTilt, edge}));
    ASSERT_TRUE(hint.target.has_value());
    const auto c = corners_at(camera, *hint.target);
    const auto length = [&c](const std::size_t(&e)[2]) {
      return std::hypot(c[e[0]].u - c[e[1]].u, c[e[0]].v - c[e[1]].v);
    };
    EXPECT_GT(length(near), 1.13 * length(far));
    EXPECT_TRUE(scenes::sees_all(camera, kBoard, to_se3(*hint.target)));
  }
}

TEST(HintTargets, TouchTheSideOfThePictureThatTheHintNames) {
  const Camera camera = pinhole(1100);
  constexpr Place kAtLeft{-0.19, 0, 0.55};
  constexpr Place kAtRight{0.19, 0, 0.55};
  constexpr Place kAtTop{0, -0.16, 0.55};
  constexpr Place kAtBottom{0, 0.16, 0.55};
  const struct {
    HintDirection side;
    std::vector<Place> before;
  } kSides[] = {{kRight, {kAtLeft}},
                {kLeft, {kAtRight}},
                {kBottom, {kAtLeft, kAtRight, kAtTop}},
                {kTop, {kAtLeft, kAtRight, kAtBottom}}};
  for (const auto& [side, before] : kSides) {
    std::vector<Place> places = kTilted;
    places.insert(places.end(), before.begin(), before.end());
    const Hint hint = after(camera, places);
    SCOPED_TRACE(to_text(hint));
    ASSERT_EQ(hint, (Hint{kMove, side}));
    ASSERT_TRUE(hint.target.has_value());
    EXPECT_TRUE(scenes::sees_all(camera, kBoard, to_se3(*hint.target)));
    const auto c = corners_at(camera, *hint.target);
    // Of the inner corners: the board ends one square further out.
    const auto [first, last] =
        std::minmax_element(c.begin(), c.end(), [](Pixel a, Pixel b) { return a.u < b.u; });
    const auto [top, bottom] =
        std::minmax_element(c.begin(), c.end(), [](Pixel a, Pixel b) { return a.v < b.v; });
    const double beyond = side == kLeft    ? first->u / kSize.width
                          : side == kRight ? 1 - last->u / kSize.width
                          : side == kTop   ? top->v / kSize.height
                                           : 1 - bottom->v / kSize.height;
    EXPECT_LT(beyond, 0.1);
  }
}

TEST(HintTargets, AreAbsentWhereNothingIsMissing) {
  const Camera camera = pinhole(1100);
  std::vector<Place> all = kTilted;
  for (const Place& place :
       std::vector<Place>{{-0.19, -0.16, 0.55}, {0.19, 0.16, 0.55}, {0, 0, 0.45, 0.6, 0.6}}) {
    all.push_back(place);
  }
  const Hint hint = after(camera, all);
  EXPECT_EQ(hint.kind, kGood);
  EXPECT_FALSE(hint.target.has_value());
}

// Whoever holds the board at each target in turn is done soon, whatever lens and board there are.
TEST(HintTargets, CompleteASessionOneAfterTheOther) {
  const std::vector<Camera> cameras = {
      pinhole(1100), pinhole(1600), pinhole(9000),
      Camera::make("brown5", kSize, {900, 900, 650, 470, -0.3, 0.1, 0.001, -0.001, 0}).value(),
      Camera::make("fisheye", kSize, {420, 420, 639.5, 479.5, 0.02, -0.01, 0, 0}).value()};
  const std::vector<Board> boards = {kBoard, Checkerboard{4, 7, 0.1}, Checkerboard{14, 5, 0.02}};
  for (const Camera& camera : cameras) {
    for (const Board& board : boards) {
      SCOPED_TRACE(std::string(camera.model()) + " " + board.text());
      Session session({CaptureMode::kAuto, 3, 0});
      scenes::Random random{1};
      int steps = 0;
      while (!session.complete() && steps < 20) {
        const auto target = hint_target(session.coverage(), board, camera);
        ASSERT_TRUE(target.has_value()) << to_text(session.hint());
        const SE3 pose = to_se3(*target);
        ASSERT_TRUE(scenes::sees_all(camera, board, pose)) << to_text(session.hint());
        const View view = scenes::observe(camera, board, pose, 0, random);
        session.offer(view);
        ASSERT_EQ(session.offer(view), Reason::kAccepted) << to_text(session.hint());
        ++steps;
      }
      EXPECT_TRUE(session.complete()) << to_text(session.hint());
      EXPECT_LE(steps, 15);
    }
  }
}

TEST_F(CalibrationSessions, WantTheBoardWhereTheirCameraSeesIt) {
  begin();
  EXPECT_EQ(session_.hint(), Hint{});
  EXPECT_FALSE(session_.hint().target.has_value()) << "nobody knows the board yet";
  // A view that is not kept tells the board.
  Observation few = seen(0);
  few.ids.resize(4);
  few.uv.resize(4);
  EXPECT_EQ(session_.offer(few, times(0)).reason, Reason::kTooFewPoints);
  const Camera nominal = nominal_camera(kSize).value();
  ASSERT_TRUE(session_.hint().target.has_value());
  EXPECT_TRUE(scenes::sees_all(nominal, kBoard, to_se3(*session_.hint().target)));
  EXPECT_EQ(session_.progress().target->translation, session_.hint().target->translation);

  // Once the camera is solved it is the one that counts: a long lens wants the board farther off.
  show(3);
  const auto job = session_.take_solve();
  Solution tele = found(*job, 0.1);
  tele.calibration.parameters[0].value = tele.calibration.parameters[1].value = 5000;
  ASSERT_TRUE(session_.solved(*job, tele).has_value());
  ASSERT_TRUE(session_.hint().target.has_value()) << to_text(session_.hint());
  const SE3 target = to_se3(*session_.hint().target);
  EXPECT_TRUE(scenes::sees_all(pinhole(5000), kBoard, target));
  EXPECT_GT(target.translation.z(), 1);
  session_.reset();
  EXPECT_EQ(session_.hint(), Hint{});
  ASSERT_TRUE(session_.hint().target.has_value());
  EXPECT_LT(session_.hint().target->translation[2], 1);
}

}  // namespace
}  // namespace calvin
