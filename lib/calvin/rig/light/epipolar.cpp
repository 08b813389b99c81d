// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Samples of eight instants, and homographies of four, by how many others agree.

#include "calvin/rig/light/epipolar.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Geometry>

#include "calvin/core/image.hpp"
#include "calvin/geometry/homography.hpp"

namespace calvin::rig {

namespace {

constexpr int kSpaceSamples = 150;  // with a third of the instants wrong, 99.7 % find a good one
constexpr int kPlaneSamples = 60;   // of four
constexpr std::size_t kLinearPoints = 8;  // that determine F linearly

struct Pair {
  Eigen::Vector3d a;
  Eigen::Vector3d b;
  double scale_a = 1;  // px
  double scale_b = 1;
};

std::vector<Pair> pairs_of(const Track& a, const Track& b,
                           const std::vector<std::size_t>& instants) {
  std::vector<Pair> pairs;
  pairs.reserve(instants.size());
  for (const std::size_t i : instants) {
    pairs.push_back({a[i]->at.homogeneous(), b[i]->at.homogeneous(), a[i]->scale, b[i]->scale});
  }
  return pairs;
}

// The similarity that takes points to centroid 0 and a mean distance of sqrt(2).
Eigen::Matrix3d normalisation(const std::vector<Pair>& pairs, std::span<const std::size_t> which,
                              Eigen::Vector3d Pair::*side) {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  for (const std::size_t i : which) center += (pairs[i].*side).head<2>();
  center /= static_cast<double>(which.size());
  double distance = 0;
  for (const std::size_t i : which) distance += ((pairs[i].*side).head<2>() - center).norm();
  const double scale = std::sqrt(2.0) * static_cast<double>(which.size()) / distance;
  Eigen::Matrix3d t = Eigen::Matrix3d::Identity();
  t(0, 0) = t(1, 1) = scale;
  t.topRightCorner<2, 1>() = -scale * center;
  return t;
}

Eigen::Matrix3d eight_points(const std::vector<Pair>& pairs, std::span<const std::size_t> which) {
  const Eigen::Matrix3d from = normalisation(pairs, which, &Pair::a);
  const Eigen::Matrix3d to = normalisation(pairs, which, &Pair::b);
  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  for (const std::size_t i : which) {
    const Eigen::Vector3d p = from * pairs[i].a;
    const Eigen::Vector3d q = to * pairs[i].b;
    Eigen::Matrix<double, 9, 1> row;
    row << q.x() * p, q.y() * p, p;
    m += row * row.transpose();
  }
  const Eigen::VectorXd f = least_direction(m);
  Eigen::Matrix3d fundamental;
  fundamental << f[0], f[1], f[2], f[3], f[4], f[5], f[6], f[7], f[8];
  // The nearest matrix of rank 2.
  const Eigen::Vector3d epipole = least_direction(fundamental.transpose() * fundamental);
  fundamental -= fundamental * epipole * epipole.transpose();
  fundamental = to.transpose() * fundamental * from;
  return fundamental / fundamental.norm();
}

// px^2
double sampson(const Eigen::Matrix3d& f, const Pair& pair) {
  const Eigen::Vector3d line_b = f * pair.a;
  const Eigen::Vector3d line_a = f.transpose() * pair.b;
  const double off = pair.b.dot(line_b);
  const double slope = line_b.head<2>().squaredNorm() / (pair.scale_b * pair.scale_b) +
                       line_a.head<2>().squaredNorm() / (pair.scale_a * pair.scale_a);
  return off * off / slope;
}

struct Support {
  double cost = 0;  // px^2, what is beyond the limit counts as the limit
  std::vector<std::size_t> agree;
};

Support support(const std::vector<Pair>& pairs, const Eigen::Matrix3d& f, double limit) {
  Support result;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double squared = sampson(f, pairs[i]);
    if (squared <= limit * limit) result.agree.push_back(i);
    result.cost += squared <= limit * limit ? squared : limit * limit;
  }
  return result;
}

// Fits again to what agrees while that lowers the cost.
void polish(const std::vector<Pair>& pairs, double limit, Eigen::Matrix3d& f, Support& now) {
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds && now.agree.size() > kLinearPoints; ++round) {
    const Eigen::Matrix3d next = eight_points(pairs, now.agree);
    Support better = support(pairs, next, limit);
    if (!(better.cost < now.cost)) return;
    f = next;
    now = std::move(better);
  }
}

double planar_share(const std::vector<Pair>& pairs, const std::vector<std::size_t>& agree,
                    double limit) {
  Picker picker;
  std::size_t most = 0;
  for (int sample = 0; sample < kPlaneSamples; ++sample) {
    std::vector<Pixel> from;
    std::vector<Pixel> to;
    for (const std::size_t k : picker.pick(4, agree.size())) {
      from.push_back({pairs[agree[k]].a.x(), pairs[agree[k]].a.y()});
      to.push_back({pairs[agree[k]].b.x(), pairs[agree[k]].b.y()});
    }
    const auto h = fit_homography(from, to);
    if (!h) continue;
    const auto count = std::ranges::count_if(agree, [&](std::size_t i) {
      const Eigen::Vector3d at = *h * pairs[i].a;
      return pairs[i].scale_b * (at.hnormalized() - pairs[i].b.head<2>()).norm() <= 2 * limit;
    });
    most = std::max(most, static_cast<std::size_t>(count));
  }
  return static_cast<double>(most) / static_cast<double>(agree.size());
}

}  // namespace

std::optional<EpipolarGeometry> find_epipolar_geometry(const Tracks& tracks, std::size_t a,
                                                       std::size_t b, double limit) {
  const std::vector<std::size_t> common = common_instants(tracks[a], tracks[b]);
  if (common.size() < kFewestCommon) return std::nullopt;
  const std::vector<Pair> pairs = pairs_of(tracks[a], tracks[b], common);
  Picker picker;
  std::optional<EpipolarGeometry> best;
  Support of_best;
  for (int sample = 0; sample < kSpaceSamples; ++sample) {
    Eigen::Matrix3d f = eight_points(pairs, picker.pick(kLinearPoints, pairs.size()));
    if (!f.allFinite()) continue;
    Support now = support(pairs, f, limit);
    if (best && !(now.cost < of_best.cost)) continue;
    polish(pairs, limit, f, now);
    best = EpipolarGeometry{a, b, f, {}, 0};
    of_best = std::move(now);
  }
  if (!best || of_best.agree.size() < kFewestCommon) return std::nullopt;
  for (const std::size_t k : of_best.agree) best->instants.push_back(common[k]);
  best->planar = planar_share(pairs, of_best.agree, limit);
  return best;
}

}  // namespace calvin::rig
