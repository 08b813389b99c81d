// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every number that a solve tells of its own accuracy, against the same computed whole from its
// definition: covariance, sigma, chi, rms, the expected error, halves, what is left of the board.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/dense.hpp"
#include "dense_solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using dense::Mode;
using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

// What corners are given, and what is asked for.
struct Ask {
  const char* name;
  const char* model = "brown5";
  double factor = 1;    // of the noise, of what the sigmas say
  bool known = true;    // whether there are sigmas
  bool uneven = false;  // whether they differ
  double skew = 0;      // px, of the lens; it is estimated
  bool warp = false;    // and so are these
  bool aspect = false;
  bool offsets = false;
  std::vector<std::string> fix = {};
  double prior = 0;  // sigma of what is told of each parameter, in those of a solve; 0: nothing

  friend std::ostream& operator<<(std::ostream& out, const Ask& ask) { return out << ask.name; }
};

constexpr double kNoise = 0.1;  // px
constexpr int kViews = 12;

// x and y in -1..1 over the board.
template <typename F>
Mode mode(F field) {
  Mode result;
  for (const Eigen::Vector3d& p : kBoard.points()) {
    result.push_back(
        field(2 * p.x() / kBoard.extent().width() - 1, 2 * p.y() / kBoard.extent().height() - 1));
  }
  return result;
}

const std::vector<Mode>& curvatures() {
  static const std::vector<Mode> modes = {
      mode([](double x, double) { return Eigen::Vector3d(0, 0, 1 - x * x); }),
      mode([](double, double y) { return Eigen::Vector3d(0, 0, 1 - y * y); })};
  return modes;
}

Mode stretched() {
  Mode result;
  for (const Eigen::Vector3d& p : kBoard.points()) result.emplace_back(0, p.y(), 0);
  return result;
}

// All that corners may do but shift, turn, scale, shear, tilt and curvature of the board.
std::vector<Mode> single_corners() {
  std::vector<Mode> known = curvatures();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(axis);
    known.push_back(mode([&](double, double) { return along; }));
    known.push_back(mode([&](double x, double) -> Eigen::Vector3d { return x * along; }));
    known.push_back(mode([&](double, double y) -> Eigen::Vector3d { return y * along; }));
  }
  const auto n = 3 * static_cast<Eigen::Index>(kBoard.points().size());
  Eigen::MatrixXd columns(n, static_cast<Eigen::Index>(known.size()));
  for (std::size_t m = 0; m < known.size(); ++m) {
    for (std::size_t i = 0; i < known[m].size(); ++i) {
      columns.block<3, 1>(3 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(m)) =
          known[m][i];
    }
  }
  const Eigen::MatrixXd basis = orthogonal_complement(columns);
  std::vector<Mode> modes;
  for (Eigen::Index m = 0; m < basis.cols(); ++m) {
    modes.emplace_back();
    for (Eigen::Index i = 0; i < n; i += 3) modes.back().emplace_back(basis.block<3, 1>(i, m));
  }
  return modes;
}

// The parameters of a camera of which what is held is true: else views contradict each other, and
// the covariance is no longer that of noise.
std::vector<double> held_in(const Ask& ask, std::vector<double> parameters) {
  const auto has = [&ask](const char* name) {
    return std::find(ask.fix.begin(), ask.fix.end(), name) != ask.fix.end();
  };
  if (has("aspect")) parameters[1] = parameters[0];
  if (has("center")) {
    parameters[2] = image_center(kSize).u;
    parameters[3] = image_center(kSize).v;
  }
  if (has("k3")) parameters[8] = 0;
  return parameters;
}

class Covariance : public ::testing::TestWithParam<Ask> {
 protected:
  void SetUp() override {
    const Ask& ask = GetParam();
    Random random(31);
    const Camera plain = scenes::random_camera(ask.model, random);
    truth_ = Camera::make(ask.model, kSize, held_in(ask, plain.parameters()), ask.skew).value();
    const auto poses = scenes::random_poses(*truth_, kBoard, random, kViews);
    std::normal_distribution<double> normal(0, 1);
    for (View& view : views_ = scenes::observe_all(*truth_, kBoard, poses, 0, random)) {
      Observation& o = view.observation;
      for (std::size_t i = 0; i < o.uv.size(); ++i) {
        o.sigma[i] = kNoise * (ask.uneven ? scenes::uniform(random, 0.5, 2) : 1);
        const double error = ask.factor * o.sigma[i];
        o.uv[i] = {o.uv[i].u + error * normal(random), o.uv[i].v + error * normal(random)};
      }
      if (!ask.known) o.sigma.clear();
    }
    options_.model = ask.model;
    options_.reject_outliers = false;
    options_.skew = ask.skew != 0;
    options_.warp = ask.warp;
    options_.aspect = ask.aspect;
    options_.offsets = ask.offsets;
    options_.fix = ask.fix;
    if (ask.prior > 0) tell(ask.prior);
    const auto solution = solve(views_, kSize, options_);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    solution_ = *solution;
    gather();
  }

  // The truth, off by what it is told to be.
  void tell(double sigmas) {
    const Calibration alone = solve(views_, kSize, options_).value().calibration;
    options_.initial = truth_->to_calibration();
    for (std::size_t i = 0; i < alone.parameters.size(); ++i) {
      Parameter& p = options_.initial->parameters[i];
      p.sigma = sigmas * *alone.parameters[i].sigma;
      p.value += (i % 2 == 0 ? 1.5 : -1.5) * *p.sigma;
    }
    options_.initial_is_prior = true;
  }

  void gather() {
    const Calibration& c = solution_.calibration;
    const std::size_t count = truth_->parameters().size();
    unknowns_.model = c.model;
    unknowns_.size = kSize;
    for (std::size_t i = 0; i < count; ++i) {
      unknowns_.parameters.push_back(c.parameters[i].value);
    }
    unknowns_.has_skew = options_.skew;
    if (options_.skew) unknowns_.skew = c.find("skew")->value;
    tie();
    add_shape();
    if (options_.initial_is_prior) {
      for (std::size_t i = 0; i < count; ++i) {
        const Parameter& p = options_.initial->parameters[i];
        unknowns_.priors.push_back({static_cast<Eigen::Index>(i), p.value, *p.sigma});
      }
    }
    for (const ViewRecord& view : c.views) poses_.push_back(to_se3(view.camera_from_board));
    ASSERT_EQ(poses_.size(), views_.size());
  }

  // The directions that are left of brown5 where the aspect is 1, the centre held, or k3.
  void tie() {
    const Eigen::Index n = unknowns_.count();
    Eigen::MatrixXd all = Eigen::MatrixXd::Identity(n, n);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < n; ++i) kept.push_back(i);
    const auto drop = [&](Eigen::Index i) { kept.erase(std::find(kept.begin(), kept.end(), i)); };
    for (const std::string& word : options_.fix) {
      if (word == "aspect") {
        all(1, 0) = 1;
        drop(1);
      } else if (word == "center") {
        drop(2);
        drop(3);
      } else if (word == "k3") {
        drop(8);
      }
    }
    unknowns_.directions.resize(n, static_cast<Eigen::Index>(kept.size()));
    for (std::size_t i = 0; i < kept.size(); ++i) {
      unknowns_.directions.col(static_cast<Eigen::Index>(i)) = all.col(kept[i]);
    }
    if (options_.fix.empty()) unknowns_.directions.resize(0, 0);
  }

  // The priors are those that board_shape.hpp names: they matter where views tell nothing.
  void add_shape() {
    const auto add = [this](const Mode& m, double coefficient, double sigma) {
      unknowns_.priors.push_back({unknowns_.count(), 0, sigma});
      unknowns_.modes.push_back(m);
      unknowns_.shape.push_back(coefficient);
    };
    const double diagonal = kBoard.points().back().norm();
    if (options_.warp) {
      const BoardWarp warp = solution_.calibration.warp.value();
      add(curvatures()[0], warp.kx, 0.01 * diagonal);
      add(curvatures()[1], warp.ky, 0.01 * diagonal);
    }
    if (options_.aspect) add(stretched(), solution_.board_aspect->value - 1, 0.01);
    if (!options_.offsets) return;
    for (const Mode& m : single_corners()) {
      double coefficient = 0;
      for (std::size_t i = 0; i < m.size(); ++i) {
        coefficient += m[i].dot(solution_.corner_offsets[i].value);
      }
      add(m, coefficient, 0.05 * kBoard.cell_size(0));
    }
  }

  // Over all unknowns: those of the board last.
  [[nodiscard]] Eigen::MatrixXd promised(const dense::Solve& whole) const {
    const double left = whole.cost / whole.degrees;
    const double variance = GetParam().known ? std::max(1.0, left) : left;
    const Eigen::MatrixXd basis = unknowns_.basis();
    return variance * congruent(whole.inverse(), basis.transpose());
  }

  std::optional<Camera> truth_;
  std::vector<View> views_;
  SolveOptions options_;
  Solution solution_;
  dense::Unknowns unknowns_;
  std::vector<SE3> poses_;
};
INSTANTIATE_TEST_SUITE_P(
    Solve, Covariance,
    ::testing::Values(
        Ask{.name = "Plain"}, Ask{.name = "Pinhole", .model = "pinhole"},
        Ask{.name = "Fisheye", .model = "fisheye"}, Ask{.name = "NoSigmas", .known = false},
        Ask{.name = "Uneven", .factor = 0.8, .uneven = true}, Ask{.name = "TooSure", .factor = 2},
        Ask{.name = "TooModest", .factor = 0.5}, Ask{.name = "Skew", .skew = 2},
        Ask{.name = "SkewOfAPinhole", .model = "pinhole", .skew = -3},
        Ask{.name = "Aspect", .model = "ucm", .fix = {"aspect"}},
        Ask{.name = "Center", .fix = {"center"}},
        Ask{.name = "CenterAspectAndK3", .fix = {"center", "aspect", "k3"}},
        Ask{.name = "Warp", .warp = true},
        Ask{.name = "WarpAndSkew", .factor = 1.5, .skew = 1, .warp = true},
        Ask{.name = "BoardAspect", .aspect = true},
        Ask{.name = "WarpAndAspect", .warp = true, .aspect = true},
        Ask{.name = "Offsets", .warp = true, .aspect = true, .offsets = true},
        Ask{.name = "Told", .prior = 1}, Ask{.name = "ToldAndTooSure", .factor = 3, .prior = 0.5}),
    [](const auto& test) { return std::string(test.param.name); });

// Central differences are good to 1e-7, the optimum to 1e-3 sigma.
constexpr double kExact = 1e-4;

TEST_P(Covariance, IsThatOfTheNormalEquations) {
  const Calibration& c = solution_.calibration;
  const dense::Solve whole(unknowns_, views_, poses_, GetParam().known);
  const Eigen::MatrixXd expected = promised(whole);
  std::vector<Eigen::Index> estimated;
  for (Eigen::Index i = 0; i < unknowns_.of_camera(); ++i) {
    const Parameter& p = c.parameters[static_cast<std::size_t>(i)];
    EXPECT_EQ(p.sigma.has_value(), expected(i, i) > 0) << p.name;
    if (!p.sigma) continue;
    estimated.push_back(i);
    EXPECT_NEAR(*p.sigma / std::sqrt(expected(i, i)), 1, kExact) << p.name;
  }
  if (unknowns_.basis().row(2).isZero()) {
    EXPECT_EQ(c.find("cx")->value, (kSize.width - 1) / 2.0);
    EXPECT_EQ(c.find("cy")->value, (kSize.height - 1) / 2.0);
  }
  ASSERT_EQ(c.covariance.size(), estimated.size() * estimated.size());
  for (std::size_t i = 0; i < estimated.size(); ++i) {
    for (std::size_t k = 0; k < estimated.size(); ++k) {
      const Eigen::Index a = estimated[i];
      const Eigen::Index b = estimated[k];
      const double unit = std::sqrt(expected(a, a) * expected(b, b));
      EXPECT_NEAR(c.covariance[i * estimated.size() + k] / unit, expected(a, b) / unit, kExact)
          << a << " " << b;
    }
  }
}

TEST_P(Covariance, AndOfTheBoard) {
  const dense::Solve whole(unknowns_, views_, poses_, GetParam().known);
  const Eigen::MatrixXd expected = promised(whole);
  Eigen::Index at = unknowns_.of_camera();
  const auto sigma = [&] { return std::sqrt(expected(at, at)); };
  EXPECT_EQ(solution_.calibration.warp.has_value(), options_.warp);
  if (options_.warp) {
    EXPECT_NEAR(*solution_.calibration.warp->kx_sigma / sigma(), 1, kExact);
    ++at;
    EXPECT_NEAR(*solution_.calibration.warp->ky_sigma / sigma(), 1, kExact);
    ++at;
  }
  EXPECT_EQ(solution_.board_aspect.has_value(), options_.aspect);
  if (options_.aspect) {
    EXPECT_NEAR(solution_.board_aspect->sigma / sigma(), 1, kExact);
    ++at;
  }
  const Eigen::Index left = expected.rows() - at;
  const Eigen::MatrixXd offsets = expected.bottomRightCorner(left, left);
  for (std::size_t i = 0; i < solution_.corner_offsets.size(); ++i) {
    Eigen::MatrixXd moves(3, left);
    for (Eigen::Index m = 0; m < left; ++m) {
      moves.col(m) = unknowns_.modes[static_cast<std::size_t>(m + at - unknowns_.of_camera())][i];
    }
    const Eigen::Matrix3d spread = moves * offsets * moves.transpose();
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(solution_.corner_offsets[i].sigma[k] / std::sqrt(spread(k, k)), 1, kExact) << i;
    }
  }
}

TEST_P(Covariance, AndChiAndRmsAreThoseOfTheResiduals) {
  const Calibration& c = solution_.calibration;
  const dense::Solve whole(unknowns_, views_, poses_, GetParam().known);
  ASSERT_EQ(c.chi.has_value(), GetParam().known);
  // One degree of freedom is a thousandth of a variance.
  if (c.chi) {
    EXPECT_NEAR(*c.chi / std::sqrt(whole.corners_cost / whole.corners_degrees), 1, 1e-5);
  }
  double squares = 0;
  std::size_t corners = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    const double square =
        dense::rows_of(unknowns_, views_[v], poses_[v], false).residual.squaredNorm();
    const std::size_t n = views_[v].observation.ids.size();
    EXPECT_NEAR(c.views[v].rms / std::sqrt(square / static_cast<double>(n)), 1, 1e-5) << v;
    EXPECT_EQ(c.views[v].points, static_cast<int>(n));
    squares += square;
    corners += n;
  }
  EXPECT_NEAR(*c.rms / std::sqrt(squares / static_cast<double>(corners)), 1, 1e-5);
}

TEST_P(Covariance, IsWhatTheExpectedErrorIsMadeOf) {
  const Calibration& c = solution_.calibration;
  const dense::Solve whole(unknowns_, views_, poses_, GetParam().known);
  const Eigen::Index n = unknowns_.of_camera();
  const Eigen::MatrixXd of_camera = promised(whole).topLeftCorner(n, n);
  const double covered = dense::worst_of(dense::grid_of(unknowns_, c.covered), of_camera);
  const double anywhere = dense::worst_of(dense::grid_of(unknowns_), of_camera);
  ASSERT_TRUE(c.expected_error && c.expected_error_anywhere);
  EXPECT_NEAR(*c.expected_error / covered, 1, kExact);
  EXPECT_NEAR(*c.expected_error_anywhere / std::max(covered, anywhere), 1, kExact);
}

// To first order the solve of a half of the views is that of all, moved by twice the covariance
// times what its views say; and what a view says spreads by its information, less what the optimum
// takes of it.
TEST_P(Covariance, AndHalvesAreThoseOfWhatViewsSay) {
  const dense::Solve whole(unknowns_, views_, poses_, GetParam().known);
  const double left = whole.cost / whole.degrees;
  const double variance = GetParam().known ? std::max(1.0, left) : left;
  const Eigen::MatrixXd inverse = whole.inverse();
  const Eigen::Index n = unknowns_.of_camera();
  const auto grid = dense::grid_of(unknowns_, solution_.calibration.covered);
  const Eigen::MatrixXd basis = unknowns_.basis().topRows(n);
  Eigen::MatrixXd metric = Eigen::MatrixXd::Zero(basis.cols(), basis.cols());
  for (const Eigen::MatrixXd& cell : grid) {
    const Eigen::MatrixXd moves = product(cell, basis);
    metric += transposed_product(moves, moves) / static_cast<double>(grid.size());
  }
  double observed = 0;
  double predicted = 0;
  for (const dense::ViewSums& view : whole.views) {
    const Eigen::VectorXd moved = inverse * view.gradient;
    observed += moved.dot(metric * moved);
    const Eigen::MatrixXd spread =
        variance * (view.information - congruent(inverse, view.information));
    predicted += product(metric, congruent(spread, inverse)).trace();
  }
  // Halves are compared with the points of the board where all views together see them.
  const double held = GetParam().offsets ? 0.2 : 1e-3;
  EXPECT_NEAR(solution_.misfit.split_half_ratio / std::sqrt(observed / predicted), 1, held);
}

}  // namespace
}  // namespace calvin
