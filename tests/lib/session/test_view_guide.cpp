// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which view a guide asks for, what others tell beside it, and the words that lead there.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "calvin/geometry/convex_hull.hpp"
#include "calvin/session/guidance/view_guide.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using enum HintKind;
using enum HintDirection;
using Kept = std::vector<std::shared_ptr<const View>>;

Kept views_of(const Camera& camera, const std::vector<SE3>& poses, scenes::Random& random) {
  Kept kept;
  for (const View& view : scenes::observe_all(camera, scenes::kBoard, poses, 0.1, random)) {
    kept.push_back(std::make_shared<const View>(view));
  }
  return kept;
}

double variance_of(const Camera& camera, const std::vector<SE3>& poses) {
  scenes::Random random(1);
  const ViewScorer scorer = ViewScorer::make(camera, {}).value();
  Eigen::MatrixXd sum = scorer.prior();
  for (const SE3& pose : poses) {
    const View view = scenes::observe(camera, scenes::kBoard, pose, 0.1, random);
    sum += scorer.information(view, pose).value();
  }
  return scorer.variance(sum);
}

class EveryLens : public ::testing::TestWithParam<std::string_view> {};

double covered_by(const Camera& camera, const std::vector<SE3>& poses) {
  std::vector<Pixel> corners;
  for (const SE3& pose : poses) {
    for (const Eigen::Vector3d& point : scenes::kBoard.points()) {
      corners.push_back(camera.project(pose * point).value());
    }
  }
  return polygon_area(convex_hull(corners)) / (1.0 * scenes::kSize.width * scenes::kSize.height);
}

// Views that were asked for cover the picture; through a lens that is not wide they leave a third
// of the variance of others, too.
TEST_P(EveryLens, AsksForViewsThatTellMuch) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera(GetParam(), random);
    std::vector<SE3> asked = scenes::random_poses(camera, scenes::kBoard, random, 3);
    std::vector<SE3> others = asked;
    for (int i = 0; i < 7; ++i) {
      const auto guide =
          ViewGuide::make(camera, {}, views_of(camera, asked, random), scenes::kBoard);
      ASSERT_TRUE(guide && guide->target());
      ASSERT_TRUE(scenes::sees_all(camera, scenes::kBoard, *guide->target()));
      asked.push_back(*guide->target());
    }
    for (const SE3& pose : scenes::random_poses(camera, scenes::kBoard, random, 7)) {
      others.push_back(pose);
    }
    EXPECT_GT(covered_by(camera, asked), covered_by(camera, others)) << "seed " << seed;
    if (scenes::is_wide(GetParam())) continue;
    EXPECT_LT(variance_of(camera, asked), 0.3 * variance_of(camera, others)) << "seed " << seed;
  }
}
INSTANTIATE_TEST_SUITE_P(ViewGuide, EveryLens, ::testing::Values("pinhole", "brown5", "fisheye"),
                         [](const auto& lens) { return std::string(lens.param); });

TEST(ViewGuide, MeasuresOtherViewsByItsOwn) {
  scenes::Random random(2);
  const Camera camera = scenes::random_camera("brown5", random);
  const std::vector<SE3> poses = scenes::random_poses(camera, scenes::kBoard, random, 6);
  const Kept kept = views_of(camera, poses, random);
  const ViewGuide guide = ViewGuide::make(camera, {}, kept, scenes::kBoard).value();
  const View there = scenes::observe(camera, scenes::kBoard, *guide.target(), 0.1, random);
  EXPECT_NEAR(guide.share(there), 1, 0.05);
  for (const auto& view : kept) EXPECT_LT(guide.share(*view), 0.6);
  View blurred = there;
  for (double& sigma : blurred.observation.sigma) sigma *= 10;
  EXPECT_LT(guide.share(blurred), 0.7 * guide.share(there));
  EXPECT_EQ(guide.share(View{}), 0);
  // The outline is that of the corners, all around, from the first one on.
  EXPECT_EQ(guide.outline().size() % 4, 0U);
  const SE3 target = guide.target().value();
  const BoardArea area = scenes::kBoard.extent();
  const Pixel corner = camera.project(target * Eigen::Vector3d(area.left, area.top, 0)).value();
  EXPECT_NEAR(guide.outline().front().u, corner.u, 1e-9);
  EXPECT_NEAR(guide.outline().front().v, corner.v, 1e-9);
}

// RMS distance of the corners of the board at two places, px.
double distance_of(const Camera& camera, const SE3& a, const SE3& b) {
  double squares = 0;
  for (const Eigen::Vector3d& point : scenes::kBoard.points()) {
    const Pixel one = camera.project(a * point).value();
    const Pixel other = camera.project(b * point).value();
    squares += std::pow(one.u - other.u, 2) + std::pow(one.v - other.v, 2);
  }
  return std::sqrt(squares / scenes::kBoard.point_count());
}

// A board that is held where it was asked for is never asked for there again, nor nearly there: its
// corners have to move by 6 % of the picture's diagonal, less what noise does to a kept view.
TEST(ViewGuide, AsksForSomethingElseNext) {
  const double diagonal = std::hypot(scenes::kSize.width, scenes::kSize.height);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera("brown5", random);
    std::vector<SE3> poses = scenes::random_poses(camera, scenes::kBoard, random, 3);
    for (int i = 0; i < 12; ++i) {
      const auto guide =
          ViewGuide::make(camera, {}, views_of(camera, poses, random), scenes::kBoard);
      if (!guide->target()) break;
      for (const SE3& pose : poses) {
        ASSERT_GT(distance_of(camera, pose, *guide->target()), 0.059 * diagonal)
            << seed << ", " << i;
      }
      poses.push_back(*guide->target());
    }
    EXPECT_GT(poses.size(), 8U);
  }
}

// Where no outline can be drawn, nobody can bring a board: a lens that sees 180 degrees ends within
// many boards at its border.
TEST(ViewGuide, AsksForWhatCanBeDrawn) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera("fisheye", random);
    std::vector<SE3> poses = scenes::random_poses(camera, scenes::kBoard, random, 3);
    for (int i = 0; i < 4; ++i) {
      const auto guide =
          ViewGuide::make(camera, {}, views_of(camera, poses, random), scenes::kBoard);
      ASSERT_TRUE(guide->target().has_value());
      EXPECT_FALSE(guide->outline().empty()) << seed << ", " << i;
      poses.push_back(*guide->target());
    }
  }
}

TEST(ViewGuide, DoesNotAskForWhatWasMissedBefore) {
  const double diagonal = std::hypot(scenes::kSize.width, scenes::kSize.height);
  scenes::Random random(3);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto kept =
      views_of(camera, scenes::random_poses(camera, scenes::kBoard, random, 4), random);
  const auto first = ViewGuide::make(camera, {}, kept, scenes::kBoard);
  ASSERT_TRUE(first && first->target_view());
  const auto second = ViewGuide::make(camera, {}, kept, scenes::kBoard, {first->target_view()});
  ASSERT_TRUE(second && second->target());
  EXPECT_GT(distance_of(camera, *first->target(), *second->target()), 0.059 * diagonal);
}

// From a convex hull, px; 0 within.
double distance_to(const std::vector<Pixel>& hull, Pixel at) {
  double least = contains(hull, at) ? 0 : HUGE_VAL;
  for (std::size_t i = 0; i < hull.size() && least > 0; ++i) {
    const Pixel a = hull[i];
    const Pixel b = hull[(i + 1) % hull.size()];
    const Pixel side = {b.u - a.u, b.v - a.v};
    const double along =
        ((at.u - a.u) * side.u + (at.v - a.v) * side.v) / (side.u * side.u + side.v * side.v);
    const double t = std::clamp(along, 0.0, 1.0);
    least = std::min(least, std::hypot(a.u + t * side.u - at.u, a.v + t * side.v - at.v));
  }
  return least;
}

// Where nobody gets to the first view: others, which a hand may miss by a tenth of the distance and
// see the whole board still, about where the camera has seen corners.
TEST(ViewGuide, AsksForWhatIsEasierToHold) {
  const double diagonal = std::hypot(scenes::kSize.width, scenes::kSize.height);
  for (unsigned seed = 1; seed <= 6; ++seed) {
    scenes::Random random(seed);
    const Camera camera = scenes::random_camera("brown5", random);
    const auto kept =
        views_of(camera, scenes::random_poses(camera, scenes::kBoard, random, 5), random);
    std::vector<Pixel> seen;
    for (const auto& view : kept) {
      seen.insert(seen.end(), view->observation.uv.begin(), view->observation.uv.end());
    }
    seen = convex_hull(std::move(seen));
    ViewGuide guide = ViewGuide::make(camera, {}, kept, scenes::kBoard).value();
    std::vector<SE3> asked = {guide.target().value()};
    while (guide.has_another()) {
      guide.ask_for_another();
      SE3 pose = guide.target().value();
      for (const SE3& before : asked) {
        EXPECT_GT(distance_of(camera, before, pose), 0.059 * diagonal);
      }
      asked.push_back(pose);
      EXPECT_NEAR(guide.share(scenes::observe(camera, scenes::kBoard, pose, 0.1, random)), 1, 0.05);
      for (const Pixel& at :
           scenes::observe(camera, scenes::kBoard, pose, 0, random).observation.uv) {
        EXPECT_LT(distance_to(seen, at), 0.06 * diagonal) << seed;
      }
      pose.translation *= 0.9;
      EXPECT_TRUE(scenes::sees_all(camera, scenes::kBoard, pose)) << seed;
    }
    EXPECT_EQ(asked.size(), 3U);
    guide.ask_for_another();
    EXPECT_EQ(distance_of(camera, asked.back(), guide.target().value()), 0);
  }
}

TEST(ViewGuide, NeedsNoViews) {
  scenes::Random random(4);
  const Camera camera = scenes::random_camera("brown5", random);
  EXPECT_TRUE(ViewGuide::make(camera, {}, {}, scenes::kBoard)->target().has_value());
  SolveOptions wrong;
  wrong.fix = {"nothing"};
  EXPECT_FALSE(ViewGuide::make(camera, wrong, {}, scenes::kBoard).has_value());
}

TEST(HintTowards, MovesAndNearsThenTilts) {
  BoardFootprint wanted;
  wanted.center = {0.5, 0.5};
  wanted.size = 0.5;
  const auto from = [&wanted](double u, double v, double size, double left, double top) {
    BoardFootprint now;
    now.center = {u, v};
    now.size = size;
    now.left_nearer = left;
    now.top_nearer = top;
    return hint_towards(wanted, now);
  };
  EXPECT_EQ(from(0.2, 0.5, 0.9, 1, 0), (Hint{kMove, kRight, kMoveBack}));
  EXPECT_EQ(from(0.2, 0.2, 0.3, 1, 0), (Hint{kMove, kLowerRight, kComeCloser}));
  EXPECT_EQ(from(0.8, 0.55, 0.5, 0, 0), (Hint{kMove, kLeft}));
  EXPECT_EQ(from(0.5, 0.8, 0.5, 0, 0), (Hint{kMove, kTop}));
  EXPECT_EQ(from(0.5, 0.2, 0.5, 0, 0), (Hint{kMove, kBottom}));
  EXPECT_EQ(from(0.2, 0.2, 0.5, 0, 0), (Hint{kMove, kLowerRight}));
  EXPECT_EQ(from(0.8, 0.2, 0.5, 0, 0), (Hint{kMove, kLowerLeft}));
  EXPECT_EQ(from(0.2, 0.8, 0.5, 0, 0), (Hint{kMove, kUpperRight}));
  EXPECT_EQ(from(0.8, 0.8, 0.5, 0, 0), (Hint{kMove, kUpperLeft}));
  EXPECT_EQ(from(0.5, 0.5, 0.3, 0, 0), (Hint{kComeCloser}));
  EXPECT_EQ(from(0.5, 0.5, 0.8, 0, 0), (Hint{kMoveBack}));
  EXPECT_EQ(from(0.5, 0.5, 0.3, 0.3, 0), (Hint{kComeCloser, kRight, kTilt}));
  EXPECT_EQ(from(0.5, 0.5, 0.8, 0, -0.3), (Hint{kMoveBack, kTop, kTilt}));
  EXPECT_EQ(from(0.5, 0.5, 0.5, 0.3, 0), (Hint{kTilt, kRight}));
  EXPECT_EQ(from(0.5, 0.5, 0.5, -0.3, 0), (Hint{kTilt, kLeft}));
  EXPECT_EQ(from(0.5, 0.5, 0.5, 0, 0.3), (Hint{kTilt, kBottom}));
  EXPECT_EQ(from(0.5, 0.5, 0.5, 0, -0.3), (Hint{kTilt, kTop}));
  EXPECT_EQ(from(0.55, 0.5, 0.55, 0.02, -0.02), (Hint{kHoldStill}));
}

}  // namespace
}  // namespace calvin
