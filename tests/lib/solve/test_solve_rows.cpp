// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rows that the least squares works on, for every lens: residuals are what Camera::project()
// says, derivatives are central differences of it, cost and gradient are those of the loss. The
// rays that are found by these rows are those of Camera::unproject().
#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/models.hpp"
#include "calvin/solve/residuals/grid_rays.hpp"
#include "calvin/solve/residuals/view_rows.hpp"
#include "lens_samples.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

constexpr ImageSize kSize = {640, 480};
constexpr int kModes = 2;  // the curvatures of BoardWarp

std::vector<std::string> all_models() {
  std::vector<std::string> names;
  [&]<typename... L>(std::tuple<L...>*) {
    (names.emplace_back(L::kName), ...);
  }(static_cast<AllLenses*>(nullptr));
  return names;
}

// One view of a bent board that moves, through a lens with every coefficient, a skew and a rolling
// shutter, and the unknowns in the order of RowLayout: six of the pose, then the shared ones.
class Rows : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const std::string& model = GetParam();
    layout_ = {CameraUnknowns::of(parameter_names(model).size(), true), kModes, true};
    shared_ = {520, 518, 325, 236};
    const auto& lens = samples::lens(model).coefficients.back();
    shared_.insert(shared_.end(), lens.begin(), lens.begin() + layout_.camera.coefficients);
    shared_.insert(shared_.end(), {0.7, 0.02, 2e-3, -3e-3});  // px, s, m, m
    pose_ = {exp_so3({0.3, -0.4, 0.2}), {-0.08, -0.05, 0.25}};
    set_.points = kBoard.points();
    Random random(3);
    for (std::size_t i = 0; i < set_.points.size(); ++i) {
      const auto speed = [&random] { return scenes::uniform(random, -400, 400); };
      set_.motion.push_back({{speed(), speed()}, scenes::uniform(random, -5, 5)});
      const Pixel at = seen(i, pose_, shared_);
      set_.ids.push_back(static_cast<int>(i));
      set_.weight.push_back(scenes::uniform(random, 0.5, 2));
      // Distances of 0.1 to 30 px.
      const double off = std::pow(10, scenes::uniform(random, -1, 1.5));
      const double side = scenes::uniform(random, 0, 2 * std::numbers::pi);
      set_.uv.push_back({at.u + off * std::cos(side), at.v + off * std::sin(side)});
    }
    set_.weight[kLeftOut] = 0;
  }

  [[nodiscard]] Pixel seen(std::size_t i, const SE3& pose, const std::vector<double>& q) const {
    const auto of_lens = static_cast<std::ptrdiff_t>(4 + layout_.camera.coefficients);
    const double* rest = &q[static_cast<std::size_t>(of_lens)];
    const Camera camera =
        Camera::make(GetParam(), kSize, {q.begin(), q.begin() + of_lens}, rest[0]).value();
    Eigen::Vector3d point = kBoard.points()[i];
    // z = kx (1 - x^2) + ky (1 - y^2), x and y in -1..1 over the board.
    const double x = 2 * point.x() / kBoard.extent().width() - 1;
    const double y = 2 * point.y() / kBoard.extent().height() - 1;
    point.z() += rest[2] * (1 - x * x) + rest[3] * (1 - y * y);
    const Pixel still = camera.project(pose * point).value();
    // The row of a corner that moves down with the readout is read later.
    const RowMotion& motion = set_.motion[i];
    const double later = rest[1] / (1 + rest[1] * motion.rate);
    return {still.u + motion.by_readout.u * later, still.v + motion.by_readout.v * later};
  }

  // With one of the unknowns moved by `step`: a pose by exp(d) from the left.
  [[nodiscard]] Pixel moved(std::size_t i, int unknown, double step) const {
    SE3 pose = pose_;
    std::vector<double> shared = shared_;
    if (unknown < 3) {
      const Eigen::Matrix3d turn = exp_so3(step * Eigen::Vector3d::Unit(unknown));
      pose = {turn * pose.rotation, turn * pose.translation};
    } else if (unknown < 6) {
      pose.translation[unknown - 3] += step;
    } else {
      shared[static_cast<std::size_t>(unknown - 6)] += step;
    }
    return seen(i, pose, shared);
  }

  [[nodiscard]] int unknowns() const { return 6 + layout_.shared(); }
  [[nodiscard]] static int column(int unknown) { return unknown < 6 ? unknown : unknown + 1; }
  // Of pixels the step is longer than of what they are multiplied by.
  [[nodiscard]] double step(int unknown) const {
    const int skew = 10 + layout_.camera.coefficients;
    return (unknown >= 6 && unknown < 10) || unknown == skew ? 1e-3 : 1e-6;
  }

  // The square of the weighted distance of a corner, px^2.
  [[nodiscard]] double square(std::size_t i, const Pixel& at) const {
    const double w = set_.weight[i];
    return w * w * (std::pow(at.u - set_.uv[i].u, 2) + std::pow(at.v - set_.uv[i].v, 2));
  }

  RowSums fill(const Loss& loss, ViewRows& rows, RowContent content = RowContent::kAll) const {
    SolveOptions options;
    options.warp = true;
    const ViewPoints points(set_, make_shape(kBoard, options));
    rows.resize(points.padded());
    const double* skew = &shared_[4 + static_cast<std::size_t>(layout_.camera.coefficients)];
    const RowPoint at = {shared_.data(), *skew, skew + 2, skew[1]};
    return fill_rows_of(GetParam())(points, at, pose_, loss, rows, content);
  }

  static constexpr std::size_t kLeftOut = 17;
  RowLayout layout_;
  std::vector<double> shared_;
  SE3 pose_;
  PointSet set_;
};
INSTANTIATE_TEST_SUITE_P(EveryModel, Rows, ::testing::ValuesIn(all_models()),
                         [](const auto& model) { return model.param; });

TEST_P(Rows, AreResidualsAndTheirDerivatives) {
  ViewRows rows(layout_);
  ASSERT_TRUE(fill({}, rows).valid);
  std::size_t at = 0;  // of the corners in use
  for (std::size_t i = 0; i < set_.size(); ++i) {
    if (i == kLeftOut) continue;
    const double w = set_.weight[i];
    const Pixel here = moved(i, 0, 0);
    EXPECT_NEAR(rows.u(RowLayout::kResidual)[at], w * (here.u - set_.uv[i].u), 1e-8);
    EXPECT_NEAR(rows.v(RowLayout::kResidual)[at], w * (here.v - set_.uv[i].v), 1e-8);
    for (int k = 0; k < unknowns(); ++k) {
      const Pixel up = moved(i, k, step(k));
      const Pixel down = moved(i, k, -step(k));
      const double u = w * (up.u - down.u) / (2 * step(k));
      const double v = w * (up.v - down.v) / (2 * step(k));
      EXPECT_NEAR(rows.u(column(k))[at], u, 1e-5 * (1 + std::abs(u))) << k << " of corner " << i;
      EXPECT_NEAR(rows.v(column(k))[at], v, 1e-5 * (1 + std::abs(v))) << k << " of corner " << i;
    }
    ++at;
  }
}

TEST_P(Rows, HaveTheSameResidualsWithoutDerivatives) {
  ViewRows all(layout_);
  ViewRows some(layout_);
  const RowSums with = fill({}, all);
  const RowSums without = fill({}, some, RowContent::kResiduals);
  EXPECT_EQ(without.valid, with.valid);
  EXPECT_NEAR(without.cost, with.cost, 1e-12 * with.cost);
  for (std::size_t i = 0; i + 1 < set_.size(); ++i) {  // one of them is left out
    EXPECT_NEAR(some.u(RowLayout::kResidual)[i], all.u(RowLayout::kResidual)[i], 1e-9);
    EXPECT_NEAR(some.v(RowLayout::kResidual)[i], all.v(RowLayout::kResidual)[i], 1e-9);
  }
}

struct Published {
  const char* name;
  Loss loss;
  double (*cost)(double square);
};

// Huber's parabola with straight arms, and the logarithm that belongs to Cauchy's distribution.
const std::vector<Published> kLosses = {
    {"squares", {}, [](double s) { return s; }},
    {"huber", {Loss::Kind::kHuber, 2}, [](double s) { return s < 4 ? s : 4 * std::sqrt(s) - 4; }},
    {"cauchy", {Loss::Kind::kCauchy, 3}, [](double s) { return 9 * std::log(1 + s / 9); }},
};

// What a solve goes downhill by: rows that are weighted otherwise lead past the optimum.
TEST_P(Rows, HaveTheCostAndTheGradientOfTheLoss) {
  for (const Published& published : kLosses) {
    ViewRows rows(layout_);
    const RowSums sums = fill(published.loss, rows);
    const auto cost = [&](int unknown, double step) {
      double sum = 0;
      for (std::size_t i = 0; i < set_.size(); ++i) {
        sum += published.cost(square(i, moved(i, unknown, step)));
      }
      return sum;
    };
    EXPECT_NEAR(sums.cost / cost(0, 0), 1, 1e-9) << published.name;
    for (int k = 0; k < unknowns(); ++k) {
      double found = 0;
      double size = 0;
      for (std::size_t i = 0; i < rows.padded(); ++i) {
        const double u = 2 * rows.u(column(k))[i] * rows.u(RowLayout::kResidual)[i];
        const double v = 2 * rows.v(column(k))[i] * rows.v(RowLayout::kResidual)[i];
        found += u + v;
        size += std::abs(u) + std::abs(v);
      }
      const double numeric = (cost(k, step(k)) - cost(k, -step(k))) / (2 * step(k));
      EXPECT_NEAR(found, numeric, 1e-5 * (1 + size)) << published.name << ", unknown " << k;
    }
  }
}

// The pixels of the grid that have a ray, and these, are what unproject() says of each by itself.
void expect_rays_of(const Camera& camera) {
  constexpr int kColumns = 33;
  constexpr int kRows = 25;
  const PixelRays found = grid_rays(camera, kColumns, kRows);
  std::size_t at = 0;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Pixel pixel = {i % kColumns * (kSize.width - 1.0) / (kColumns - 1),
                         i / kColumns * (kSize.height - 1.0) / (kRows - 1)};
    const auto ray = camera.unproject(pixel);
    if (!ray) continue;
    ASSERT_LT(at, found.at.size());
    EXPECT_EQ(found.at[at].u, pixel.u);
    EXPECT_EQ(found.at[at].v, pixel.v);
    EXPECT_LT((found.rays[at].normalized() - *ray).norm(), 1e-9) << pixel.u << " " << pixel.v;
    ++at;
  }
  EXPECT_EQ(at, found.at.size());
}

// A camera that is known has no columns; all others stay what they are.
TEST_P(Rows, OfAKnownCameraLackItsColumnsAlone) {
  ViewRows all(layout_);
  const RowSums sums = fill({}, all);
  RowLayout known = layout_;
  known.is_known = true;
  ASSERT_EQ(known.columns(), 7 + 1 + kModes);
  ViewRows some(known);
  const RowSums without = fill({}, some);
  EXPECT_TRUE(without.valid);
  EXPECT_EQ(without.cost, sums.cost);
  const int more = layout_.columns() - known.columns();
  for (int column = 0; column < known.columns(); ++column) {
    const int of_all = column < RowLayout::kFirstShared ? column : column + more;
    for (std::size_t i = 0; i < all.padded(); ++i) {
      EXPECT_NEAR(some.u(column)[i], all.u(of_all)[i], 1e-9 * (1 + std::abs(all.u(of_all)[i])));
      EXPECT_NEAR(some.v(column)[i], all.v(of_all)[i], 1e-9 * (1 + std::abs(all.v(of_all)[i])));
    }
  }
}

TEST_P(Rows, GridRaysLeadToTheirPixels) {
  Random random(11);
  for (int i = 0; i < 5; ++i) {
    expect_rays_of(scenes::random_camera(GetParam(), random, kSize));
  }
}

// k1 = -0.3 alone folds back 1.05 focal lengths off the axis, at .70 of them in the picture: 315
// px, and the corners are at 400.
TEST(GridRays, LeaveOutWhatHasNone) {
  expect_rays_of(Camera::make("brown4", kSize, {450, 450, 319.5, 239.5, -0.3, 0, 0, 0}).value());
}

}  // namespace
}  // namespace calvin
