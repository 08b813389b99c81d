// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Parabolas of rows and columns, the centre between them, and powers of the radius.

#include "calvin/solve/start/parabolas.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestLines = 8;

// A point on a line: px along the picture's axis next to the line, and across it.
using Places = std::vector<Eigen::Vector2d>;

// across = a along^2 + b along + c
struct Parabola {
  double a = 0;
  double b = 0;
  double c = 0;  // px
};

Parabola fit(const Places& places, double along0, double across0) {
  constexpr double kUnit = 1000;  // px
  Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& p : places) {
    const double t = (p.x() - along0) / kUnit;
    const Eigen::Vector3d by(t * t, t, 1);
    m += by * by.transpose();
    right += (p.y() - across0) * by;
  }
  const Eigen::Vector3d x = solve_symmetric(m, right);
  return {x[0] / (kUnit * kUnit), x[1] / kUnit, x[2]};
}

std::vector<Parabola> fit_all(const std::vector<Places>& lines, double along0, double across0) {
  std::vector<Parabola> all;
  for (const Places& places : lines) all.push_back(fit(places, along0, across0));
  return all;
}

// Rows and columns in their order on the board, those that lie along x in the picture first.
struct GridLines {
  std::vector<Places> across;
  std::vector<Places> down;
};

// Without the points that are too far from the parabola through all of them.
Places kept(const Places& places) {
  constexpr double kMost = 2.5;  // px
  const Parabola p = fit(places, 0, 0);
  Places near;
  for (const Eigen::Vector2d& at : places) {
    const double off = at.y() - (p.a * at.x() + p.b) * at.x() - p.c;
    if (std::abs(off) < kMost) near.push_back(at);
  }
  return near;
}

// Lines with far fewer points than the longest one are left out.
std::vector<Places> whole(const std::map<double, std::vector<Pixel>>& lines, bool along_x) {
  constexpr double kLeastShare = 0.65;
  std::size_t most = 0;
  for (const auto& [at, points] : lines) most = std::max(most, points.size());
  std::vector<Places> all;
  for (const auto& [at, points] : lines) {
    if (static_cast<double>(points.size()) < kLeastShare * static_cast<double>(most)) continue;
    Places places;
    for (const Pixel& p : points) {
      places.push_back(along_x ? Eigen::Vector2d(p.u, p.v) : Eigen::Vector2d(p.v, p.u));
    }
    all.push_back(kept(places));
  }
  return all;
}

GridLines lines_of(const PointSet& view) {
  std::map<double, std::vector<Pixel>> rows;
  std::map<double, std::vector<Pixel>> columns;
  for (std::size_t i = 0; i < view.size(); ++i) {
    if (!(view.weight[i] > 0)) continue;
    rows[view.points[i].y()].push_back(view.uv[i]);
    columns[view.points[i].x()].push_back(view.uv[i]);
  }
  const auto longest =
      std::ranges::max_element(rows, {}, [](const auto& row) { return row.second.size(); });
  const Pixel& first = longest->second.front();
  const Pixel& last = longest->second.back();
  const bool upright = std::abs(last.u - first.u) >= std::abs(last.v - first.v);
  return {whole(upright ? rows : columns, true), whole(upright ? columns : rows, false)};
}

// The straight line between the two parabolas where the curvature changes its sign first.
std::optional<Parabola> straight_line(const std::vector<Parabola>& lines) {
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const Parabola& p = lines[i - 1];
    const Parabola& q = lines[i];
    if ((p.a > 0) != (q.a > 0)) return Parabola{0, (p.b + q.b) / 2, (p.c + q.c) / 2};
  }
  return std::nullopt;
}

// Where lines would cross the other axis through the centre without distortion, px.
std::vector<double> even_intercepts(const std::vector<Parabola>& lines) {
  constexpr std::ptrdiff_t kAbout = 3;  // lines on either side of the centre
  const auto count = static_cast<std::ptrdiff_t>(lines.size());
  const auto nearest =
      std::ranges::min_element(lines, {}, [](const Parabola& p) { return std::abs(p.c); });
  const auto middle = nearest - lines.begin();
  const auto first = std::max<std::ptrdiff_t>(0, middle - kAbout);
  const auto last = std::min(count - 1, middle + kAbout);
  const auto at = [&](std::ptrdiff_t i) { return lines[static_cast<std::size_t>(i)].c; };
  const double step = (at(last) - at(first)) / static_cast<double>(last - first);
  std::vector<double> all;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    all.push_back(at(middle) + static_cast<double>(i - middle) * step);
  }
  return all;
}

// Equations for the factors: of each point how much farther from the axis its line is seen there
// than it would be, F, and the radius that it would have, r / F.
class FactorEquations {
 public:
  explicit FactorEquations(double unit) : unit_(unit) {}

  void add(const std::vector<Places>& lines, double along0, double across0) {
    const auto parabolas = fit_all(lines, along0, across0);
    const auto even = even_intercepts(parabolas);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (const Eigen::Vector2d& p : lines[i]) {
        const double along = p.x() - along0;
        const double factor = (parabolas[i].a * along * along + parabolas[i].c) / even[i];
        const double r = std::hypot(along, p.y() - across0) / factor / unit_;
        if (!std::isfinite(r) || !(factor > 0)) continue;
        Eigen::Matrix<double, kCount, 1> by;
        for (int k = 0; k < kCount; ++k) by[k] = std::pow(r, k);
        m_ += by * by.transpose();
        right_ += factor * by;
      }
    }
  }

  [[nodiscard]] std::vector<double> solve() const {
    const Eigen::VectorXd x = solve_symmetric(m_, right_);
    std::vector<double> factors;
    for (int k = 0; k < kCount; ++k) factors.push_back(x[k] / std::pow(unit_, k));
    return factors;
  }

 private:
  static constexpr int kCount = 5;
  double unit_;  // px
  Eigen::Matrix<double, kCount, kCount> m_ = Eigen::Matrix<double, kCount, kCount>::Zero();
  Eigen::Matrix<double, kCount, 1> right_ = Eigen::Matrix<double, kCount, 1>::Zero();
};

tl::unexpected<Error> refused(const char* why) {
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("The steps of discorpy find no distortion: {}.", why));
}

}  // namespace

double PowersOfRadius::seen(double r) const {
  double sum = 0;
  for (std::size_t k = factors.size(); k-- > 0;) sum = sum * r + factors[k];
  return r * sum;
}

Result<PowersOfRadius> distortion_by_parabolas(const PointSet& view, ImageSize size) {
  const GridLines lines = lines_of(view);
  if (lines.across.size() < kFewestLines || lines.down.size() < kFewestLines) {
    return refused("they need eight rows and eight columns of a grid");
  }
  const auto row = straight_line(fit_all(lines.across, 0, 0));
  const auto column = straight_line(fit_all(lines.down, 0, 0));
  if (!row || !column) {
    return refused("all rows or columns are bent to one side; leave out --no-refine");
  }
  PowersOfRadius found;
  const double share = 1 / (1 - row->b * column->b);
  found.center = {share * (column->c + column->b * row->c), share * (row->c + row->b * column->c)};
  FactorEquations equations(std::hypot(size.width, size.height) / 2);
  equations.add(lines.across, found.center.u, found.center.v);
  equations.add(lines.down, found.center.v, found.center.u);
  found.factors = equations.solve();
  if (!std::isfinite(found.seen(1)) || !(found.factors[0] > 0)) {
    return refused("rows and columns are not as far from each other as those of a grid are");
  }
  return found;
}

}  // namespace calvin
