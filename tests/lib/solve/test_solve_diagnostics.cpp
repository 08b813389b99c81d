// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the residuals of a solve have in common by view, by place and by corner of the board: the
// sums themselves, from their definitions, and that noise alone has none.
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/dense.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/fit_diagnostics.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/solve.hpp"
#include "dense_solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

constexpr double kNoise = 0.1;  // px
constexpr int kViews = 25;

std::vector<View> session(const Camera& camera, bool uneven, Random& random) {
  std::normal_distribution<double> normal(0, 1);
  auto views = scenes::observe_all(camera, kBoard,
                                   scenes::random_poses(camera, kBoard, random, kViews), 0, random);
  for (View& view : views) {
    Observation& o = view.observation;
    for (std::size_t i = 0; i < o.uv.size(); ++i) {
      o.sigma[i] = kNoise * (uneven ? scenes::uniform(random, 0.5, 2) : 1);
      o.uv[i] = {o.uv[i].u + o.sigma[i] * normal(random), o.uv[i].v + o.sigma[i] * normal(random)};
    }
  }
  return views;
}

SolveOptions options_of(const Camera& camera) {
  SolveOptions options;
  options.model = camera.model();
  options.warp = false;
  options.reject_outliers = false;
  options.skew = camera.skew() != 0;
  return options;
}

struct Judged {
  Fit fit;
  FitDiagnostics found;
};

// As solve() does, with weights of 1 / sigma.
Judged judge(const std::vector<View>& views, const Camera& camera) {
  const SolveOptions options = options_of(camera);
  const Parameterization parameterization = make_parameterization(options, kSize).value();
  const BoardShape flat;
  std::vector<PointSet> sets;
  for (const View& view : views)
    sets.push_back(to_points(kBoard, kBoard.points(), view.observation));
  Judged judged;
  judged.fit = fit_camera(sets, flat, kSize, parameterization, options, {});
  EXPECT_TRUE(judged.fit.converged);
  const Eigen::Index n = judged.fit.information.rows();
  const auto covariance =
      scaled_solve(judged.fit.information, Eigen::MatrixXd::Identity(n, n), 0).value();
  const auto& p = judged.fit.shared;
  const std::ptrdiff_t count = n - (options.skew ? 1 : 0);
  const Camera at = Camera::make(options.model, kSize, {p.begin(), p.begin() + count},
                                 options.skew ? p.back() : 0)
                        .value();
  std::vector<int> columns;
  for (int i = 0; i < count; ++i) columns.push_back(i);
  if (options.skew) columns.push_back(kSkewColumn);
  judged.found = diagnose(judged.fit, at, flat, parameterization,
                          projection_grids(at, columns, {}).picture, covariance, 1, {});
  return judged;
}

// Of mean residuals: the score of a shift and its information.
struct Score {
  double sum = 0;
  double information = 0;

  void add(double residual, double by) {
    sum += residual * by;
    information += by * by;
  }
};

double square_of(const std::map<int, Score>& scores) {
  double sum = 0;
  for (const auto& [key, s] : scores) sum += s.sum * s.sum / s.information;
  return sum;
}

TEST(FitDiagnostics, IsThatOfItsDefinition) {
  for (const double skew : {0.0, 2.0}) {
    Random random(51);
    const Camera plain = scenes::random_camera("brown5", random);
    const Camera camera = Camera::make("brown5", kSize, plain.parameters(), skew).value();
    const auto views = session(camera, true, random);
    const Judged judged = judge(views, camera);
    dense::Unknowns unknowns;
    unknowns.model = "brown5";
    unknowns.size = kSize;
    unknowns.parameters.assign(judged.fit.shared.begin(), judged.fit.shared.begin() + 9);
    unknowns.has_skew = skew != 0;
    if (unknowns.has_skew) unknowns.skew = judged.fit.shared.back();
    double sum = 0;
    std::map<int, Score> places;
    std::map<int, Score> corners;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const SE3& pose = judged.fit.camera_from_board[v];
      const dense::Rows rows = dense::rows_of(unknowns, views[v], pose, true);
      const dense::ViewSums view = dense::sums_of(rows, unknowns.basis());
      const Eigen::VectorXd scale = view.information.diagonal().cwiseSqrt().cwiseInverse();
      const Eigen::MatrixXd scaled = scale.asDiagonal() * view.information * scale.asDiagonal();
      const Eigen::VectorXd g = scale.cwiseProduct(view.gradient);
      sum += g.dot(solve_symmetric(scaled, g).col(0));
      const Observation& o = views[v].observation;
      for (std::size_t i = 0; i < o.ids.size(); ++i) {
        // 1350 corners, 40 in each part of the picture: 7 by 5 of them.
        const int cell = static_cast<int>((o.uv[i].v + 0.5) / (kSize.height / 5.0)) * 7 +
                         static_cast<int>((o.uv[i].u + 0.5) / (kSize.width / 7.0));
        for (int k = 0; k < 2; ++k) {
          const auto row = static_cast<Eigen::Index>(2 * i) + k;
          places[2 * cell + k].add(rows.residual[row], 1 / o.sigma[i]);
          // A corner that is elsewhere on the board moves the point in the camera's frame.
          const Eigen::RowVector3d by = rows.by_pose.block<1, 3>(row, 3) * pose.rotation;
          for (int axis = 0; axis < 3; ++axis) {
            corners[3 * o.ids[i] + axis].add(rows.residual[row], by[axis]);
          }
        }
      }
    }
    const int directions = 9 + (skew != 0 ? 1 : 0);
    // The part of the variance that a fit of so many unknowns leaves.
    const double kept = 1 - (6.0 * kViews + directions) / (2 * 54 * kViews);
    EXPECT_NEAR(judged.found.views.sum / sum, 1, 1e-3);
    EXPECT_EQ(judged.found.views.degrees, directions * (kViews - 1));
    EXPECT_NEAR(judged.found.board.sum * kept / square_of(corners), 1, 1e-3);
    // A board may be shifted, turned and scaled as a whole.
    EXPECT_EQ(judged.found.board.degrees, 3 * 54 - 7);
    double most = 0;
    for (const auto& [key, s] : places) most = std::max(most, s.information);
    std::erase_if(places, [most](const auto& p) { return p.second.information < 1e-3 * most; });
    EXPECT_NEAR(judged.found.picture.sum * kept / square_of(places), 1, 1e-3);
    EXPECT_EQ(judged.found.picture.degrees, static_cast<double>(places.size()));
  }
}

// Each is a standard normal number then, but for the picture, of which the lens takes its part, and
// for the board, of which it takes a little: 3 of 155 degrees.
TEST(FitDiagnostics, OfNoiseIsNone) {
  Random random(52);
  const int sessions = scenes::full_count() ? 1000 : 120;
  double views[2] = {0, 0};
  double board[2] = {0, 0};
  double picture = 0;
  for (int i = 0; i < sessions; ++i) {
    const Camera camera = scenes::random_camera("brown4", random);
    const FitDiagnostics found = judge(session(camera, true, random), camera).found;
    views[0] += found.views.deviations() / sessions;
    views[1] += std::pow(found.views.deviations(), 2) / sessions;
    board[0] += found.board.deviations() / sessions;
    board[1] += std::pow(found.board.deviations(), 2) / sessions;
    picture += found.picture.deviations() / sessions;
  }
  const double mean = 4 / std::sqrt(sessions);
  const double square = 4 * std::sqrt(2.0 / sessions);
  EXPECT_NEAR(views[0], 0, mean);
  EXPECT_NEAR(views[1], 1, square);
  EXPECT_LT(board[0], mean);
  EXPECT_GT(board[0], -3 / std::sqrt(2.0 * 155) - mean);
  EXPECT_NEAR(board[1], 1, square);
  EXPECT_LT(picture, mean);
}

}  // namespace
}  // namespace calvin
