// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Two cameras of different models on a rig, a board that may bend, a board without a grid and with
// gaps in its ids, and free points, in one problem: the same optimum as Ceres finds with formulas
// of its own (ceres_formulas.hpp).
#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "ceres_rig.hpp"
#include "rig_scene.hpp"

namespace calvin {
namespace {

using formulas::CeresRig;
using formulas::Numbers;
using formulas::numbers_of;
using scenes::kFrames;
using scenes::make_scene;
using scenes::pushed;
using scenes::Scene;
using scenes::table_of;
using scenes::with_priors;

struct Solved {
  BundlePoint point;
  double cost = 0;
  Eigen::MatrixXd information;
};

Solved solve_ours(const Scene& scene, const ParameterTable& table, BundlePoint start,
                  std::vector<PointResiduals> points) {
  std::vector<ViewPoints> views;
  for (std::size_t v = 0; v < scene.seen.size(); ++v) {
    views.emplace_back(scene.sets[v], scene.seen[v].board == 0 ? scene.shape : BoardShape());
  }
  ResidualBlocks blocks = {scene.seen, std::move(points), {}};
  for (std::size_t v = 0; v < views.size(); ++v) blocks.boards[v].seen = &views[v];
  BundleProblem problem(std::move(blocks), {&table, table.basis(), table.priors()},
                        std::move(start), Loss{});
  EXPECT_TRUE(problem.valid());
  EXPECT_TRUE(minimise(problem, LmOptions{200}, {}).converged);
  const auto reduced = problem.reduced();
  EXPECT_TRUE(reduced.has_value());
  return {problem.point(), problem.cost(), reduced ? reduced->information : Eigen::MatrixXd()};
}

TEST(Rig, IsSolvedToTheOptimumOfCeres) {
  const Scene scene = make_scene();
  ASSERT_GE(scene.seen.size(), 2u * kFrames);
  const ParameterTable table = with_priors(table_of(scene, false));
  const Solved ours = solve_ours(scene, table, pushed(scene, table, 1), scene.points);
  CeresRig at_ours(scene, table, ours.point);
  EXPECT_NEAR(at_ours.cost() / ours.cost, 1, 1e-11);
  EXPECT_NEAR(at_ours.solve() / ours.cost, 1, 1e-9);
  CeresRig by_itself(scene, table, pushed(scene, table, 2));
  EXPECT_NEAR(by_itself.solve() / ours.cost, 1, 1e-9);

  // Not the cost alone is the same.
  const Eigen::VectorXd sigma = ours.information.inverse().diagonal().cwiseSqrt();
  const auto expect_same = [&](ParameterRange range, const double* theirs) {
    for (int i = 0; i < range.count; ++i) {
      const double value = ours.point.shared[static_cast<std::size_t>(range[i])];
      EXPECT_NEAR((value - theirs[i]) / sigma[range[i]], 0, 1e-3) << table.name(range[i]);
    }
  };
  for (std::size_t c = 0; c < 2; ++c) expect_same(table.camera(c), by_itself.camera(c).data());
  expect_same(table.warp(0), by_itself.warp().data());
  const Numbers rig = numbers_of(ours.point.camera_from_rig[1]);
  for (int i = 0; i < 6; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int unknown = table.rig_pose(1)[i];
    EXPECT_NEAR((rig[k] - by_itself.rig(1)[k]) / sigma[unknown], 0, 1e-3) << table.name(unknown);
  }
}

// The same rig described in another frame, in which no camera stands: the first one is held.
TEST(Rig, HasTheSameOptimumInAnyFrame) {
  const Scene scene = make_scene();
  const ParameterTable table = with_priors(table_of(scene, false));
  const Solved ours = solve_ours(scene, table, pushed(scene, table, 1), scene.points);

  ParameterTable held = with_priors(table_of(scene, true));
  const ParameterRange first = held.rig_pose(0);
  for (int i = first.first; i < first.end(); ++i) held.hold(i, 0);
  const SE3 camera_from_frame = {exp_so3({0.3, 1.1, -0.4}), {0.2, -0.3, 0.5}};
  const SE3 frame_from_camera = camera_from_frame.inverse();
  BundlePoint start = pushed(scene, table, 1);
  start.shared.insert(start.shared.begin() + first.first, 6, 0.0);
  for (SE3& place : start.camera_from_rig) place = place * camera_from_frame;
  for (SE3& pose : start.rig_from_board) pose = frame_from_camera * pose;
  std::vector<PointResiduals> points = scene.points;
  for (PointResiduals& block : points) {
    block.rig_from_world = frame_from_camera * block.rig_from_world;
  }
  const Solved other = solve_ours(scene, held, std::move(start), std::move(points));
  EXPECT_NEAR(other.cost / ours.cost, 1, 1e-10);
  EXPECT_EQ(other.point.camera_from_rig[0].rotation, camera_from_frame.rotation);
  const SE3 second = other.point.camera_from_rig[1] * frame_from_camera;
  EXPECT_LT((second.rotation - ours.point.camera_from_rig[1].rotation).norm(), 1e-7);
  EXPECT_LT((second.translation - ours.point.camera_from_rig[1].translation).norm(), 1e-7);
}

// What is known is no unknown; what is held is one that does not move.
TEST(Rig, WithKnownIntrinsicsIsThatWithHeldOnes) {
  const Scene scene = make_scene();
  const BundlePoint start = pushed(scene, table_of(scene, false), 1);
  ParameterTable held = table_of(scene, false);
  BundlePoint from = scene.truth;
  from.rig_from_board = start.rig_from_board;
  from.camera_from_rig = start.camera_from_rig;
  std::vector<TableCamera> cameras;
  for (std::size_t c = 0; c < 2; ++c) {
    const ParameterRange range = held.camera(c);
    for (int i = range.first; i < range.end(); ++i) {
      held.hold(i, scene.truth.shared[static_cast<std::size_t>(i)]);
    }
    TableCamera camera = {std::string(scene.cameras[c].model())};
    camera.skew = scene.cameras[c].skew();
    camera.has_rig_pose = c > 0;
    camera.known = scene.cameras[c].parameters();
    cameras.push_back(std::move(camera));
  }
  const ParameterTable known(cameras, {scene.shape.unknowns, BoardUnknowns()});
  EXPECT_TRUE(known.camera(0).empty());
  EXPECT_FALSE(known.find("fx", 1));
  EXPECT_EQ(known.basis().cols(), held.basis().cols());
  const Solved by_held = solve_ours(scene, held, from, scene.points);
  const auto intrinsics = held.camera(0).count + held.camera(1).count;
  from.shared.erase(from.shared.begin(), from.shared.begin() + intrinsics);
  const Solved by_known = solve_ours(scene, known, from, scene.points);
  EXPECT_NEAR(by_known.cost / by_held.cost, 1, 1e-11);
  EXPECT_LT((by_known.information - by_held.information).norm(), 1e-6 * by_held.information.norm());
  const SE3& a = by_known.point.camera_from_rig[1];
  const SE3& b = by_held.point.camera_from_rig[1];
  EXPECT_LT((a.rotation - b.rotation).norm() + (a.translation - b.translation).norm(), 1e-8);
}

// Where the cameras share no board and no point, nothing that one sees says anything of the other.
TEST(Rig, LeavesACameraAloneThatDoesNotSeeTheBoard) {
  Scene scene = make_scene();
  const ParameterTable table = with_priors(table_of(scene, false));
  std::vector<BoardResiduals> seen;
  std::deque<PointSet> sets;
  std::vector<SE3> poses;
  BundlePoint start = scene.truth;
  for (std::size_t v = 0; v < scene.seen.size(); ++v) {
    if ((scene.seen[v].pose / 2) % 2 != scene.seen[v].camera) continue;
    seen.push_back(scene.seen[v]);
    seen.back().pose = poses.size();
    poses.push_back(scene.truth.rig_from_board[scene.seen[v].pose]);
    sets.push_back(scene.sets[v]);
  }
  start.rig_from_board = poses;
  start.points.clear();
  std::vector<ViewPoints> views;
  for (std::size_t v = 0; v < seen.size(); ++v) {
    views.emplace_back(sets[v], seen[v].board == 0 ? scene.shape : BoardShape());
  }
  for (std::size_t v = 0; v < seen.size(); ++v) seen[v].seen = &views[v];
  BundleProblem problem({seen, {}, {}}, {&table, table.basis(), table.priors()}, start, Loss{});
  ASSERT_TRUE(problem.valid());
  const auto reduced = problem.reduced();
  ASSERT_TRUE(reduced);
  const ParameterRange a = table.camera(0);
  const ParameterRange b = table.camera(1);
  EXPECT_EQ(reduced->information.block(a.first, b.first, a.count, b.count).cwiseAbs().maxCoeff(),
            0);
  EXPECT_GT(reduced->information.block(a.first, a.first, a.count, a.count).cwiseAbs().minCoeff(),
            0);
}

TEST(Rig, IsRefusedWhereTableAndBlocksDoNotFitTogether) {
  Scene scene = make_scene();
  std::vector<ViewPoints> views;
  for (std::size_t v = 0; v < scene.seen.size(); ++v) {
    views.emplace_back(scene.sets[v], scene.seen[v].board == 0 ? scene.shape : BoardShape());
  }
  for (std::size_t v = 0; v < views.size(); ++v) scene.seen[v].seen = &views[v];
  const ParameterTable table = table_of(scene, false);
  const auto is_valid = [&](const ParameterTable& of, const std::vector<BoardResiduals>& boards,
                            const BundlePoint& start) {
    return BundleProblem({boards, scene.points, {}}, {&of, of.basis(), {}}, start, Loss{}).valid();
  };
  EXPECT_TRUE(is_valid(table, scene.seen, scene.truth));

  BundlePoint start = scene.truth;
  start.camera_from_rig.clear();
  EXPECT_FALSE(is_valid(table, scene.seen, start)) << "a place in a rig that is not there";
  start.camera_from_rig.resize(1);
  EXPECT_FALSE(is_valid(table, scene.seen, start)) << "a rig of fewer cameras";

  for (const auto member :
       {&BoardResiduals::camera, &BoardResiduals::board, &BoardResiduals::pose}) {
    std::vector<BoardResiduals> boards = scene.seen;
    boards.back().*member = 1000;
    EXPECT_FALSE(is_valid(table, boards, scene.truth));
  }
}

TEST(Rig, DoesNotDetermineAPointThatNobodySees) {
  Scene scene = make_scene();
  const ParameterTable table = with_priors(table_of(scene, false));
  BundlePoint start = scene.truth;
  start.points.emplace_back(0, 0, 1);
  std::vector<ViewPoints> views;
  for (std::size_t v = 0; v < scene.seen.size(); ++v) {
    views.emplace_back(scene.sets[v], scene.seen[v].board == 0 ? scene.shape : BoardShape());
  }
  for (std::size_t v = 0; v < views.size(); ++v) scene.seen[v].seen = &views[v];
  BundleProblem problem({scene.seen, scene.points, {}}, {&table, table.basis(), {}}, start, Loss{});
  ASSERT_TRUE(problem.valid());
  EXPECT_FALSE(problem.reduced());
  EXPECT_FALSE(minimise(problem, LmOptions{}, {}).converged);
}

}  // namespace
}  // namespace calvin
