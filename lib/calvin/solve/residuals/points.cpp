// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Observations as points with weights.

#include "calvin/solve/residuals/points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/points/id_index.hpp"

namespace calvin {

namespace {

// Absent where the detector says nothing of the corner, or nothing that can be.
std::optional<double> weight_of(const Observation& observation, std::size_t i) {
  if (i >= observation.sigma.size()) return std::nullopt;
  const double sigma = observation.sigma[i];
  if (!is_known_sigma(sigma)) return std::nullopt;
  return 1 / sigma;
}

// Of the points in use: how many, and how they are spread, m and m^2.
struct Scatter {
  std::size_t count = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d about_centroid = Eigen::Matrix3d::Zero();
};

// In one pass, from the first point in use: near the others, wherever the board frame lies.
Scatter scatter_of(const PointSet& view) {
  Scatter s;
  const auto used = [&view](std::size_t i) { return view.weight[i] > 0; };
  std::size_t i = 0;
  while (i < view.size() && !used(i)) ++i;
  if (i == view.size()) return s;
  const Eigen::Vector3d from = view.points[i];
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();  // yz, zx, xy
  for (; i < view.size(); ++i) {
    if (!used(i)) continue;
    const Eigen::Vector3d d = view.points[i] - from;
    s.centroid += d;
    squares += d.cwiseAbs2();
    products += Eigen::Vector3d(d.y() * d.z(), d.z() * d.x(), d.x() * d.y());
    ++s.count;
  }
  s.centroid /= static_cast<double>(s.count);
  s.about_centroid << squares[0], products[2], products[1],  //
      products[2], squares[1], products[0],                  //
      products[1], products[0], squares[2];
  s.about_centroid -= static_cast<double>(s.count) * s.centroid * s.centroid.transpose();
  s.centroid += from;
  return s;
}

}  // namespace

std::size_t PointSet::used() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(weight.begin(), weight.end(), [](double w) { return w > 0; }));
}

PointSet PointSet::without_corners() const {
  PointSet bare;
  bare.index = index;
  bare.board = board;
  bare.timestamp = timestamp;
  bare.sigma_known = sigma_known;
  bare.ambiguous = ambiguous;
  return bare;
}

void PointSet::reserve(std::size_t corners) {
  ids.reserve(corners);
  points.reserve(corners);
  uv.reserve(corners);
  weight.reserve(corners);
  motion.reserve(corners);
}

void PointSet::append(const PointSet& from, std::size_t i) {
  ids.push_back(from.ids[i]);
  points.push_back(from.points[i]);
  uv.push_back(from.uv[i]);
  weight.push_back(from.weight[i]);
  if (!from.motion.empty()) motion.push_back(from.motion[i]);
}

PointSet to_points(const Board& board, const std::vector<Eigen::Vector3d>& points,
                   const Observation& observation) {
  PointSet view;
  view.timestamp = observation.timestamp;
  view.ambiguous = !observation.ambiguous.empty();
  const IdIndex board_ids(board);
  view.uv = observation.uv;
  view.ids.resize(observation.ids.size());
  view.points.resize(view.ids.size());
  view.weight.resize(view.ids.size());
  for (std::size_t i = 0; i < view.ids.size(); ++i) {
    const std::size_t index = board_ids.of(observation.ids[i]).value();
    view.ids[i] = static_cast<int>(index);
    view.points[i] = points[index];
    const auto weight = weight_of(observation, i);
    view.weight[i] = weight.value_or(1);
    view.sigma_known = view.sigma_known && weight;
  }
  return view;
}

// A velocity is the difference between two frames, between whose rows as much time has passed as
// between the frames, but for what the corner has moved across the rows: `rate` mends that.
std::vector<RowMotion> row_motion(const Observation& observation, int height) {
  std::vector<RowMotion> motion;
  motion.reserve(observation.velocity.size());
  for (std::size_t i = 0; i < observation.velocity.size(); ++i) {
    const Pixel& speed = observation.velocity[i];
    const double delay = row_delay(observation.uv[i].v, height);
    motion.push_back({{speed.u * delay, speed.v * delay}, speed.v / std::max(height - 1, 1)});
  }
  return motion;
}

bool spans_plane(const PointSet& view) {
  const Scatter s = scatter_of(view);
  if (s.count < 4) return false;
  const Eigen::Matrix3d& m = s.about_centroid;
  // The sum of the products of two eigenvalues each: on one line it is zero.
  const double pairs = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1) + m(0, 0) * m(2, 2) -
                       m(0, 2) * m(0, 2) + m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2);
  return pairs > 1e-8 * m.trace() * m.trace();
}

bool spans_space(const PointSet& view) {
  constexpr std::size_t kLeast = 6;
  // Of the standard deviation along the longest axis. A sheet whose arch is a twentieth of its
  // length comes to .05.
  constexpr double kThick = 0.06;
  const auto is_high = [](const Eigen::Vector3d& p) { return p.z() != 0; };
  if (std::none_of(view.points.begin(), view.points.end(), is_high)) return false;
  const Scatter s = scatter_of(view);
  const auto eigen = s.count < kLeast ? std::nullopt : symmetric_eigen(s.about_centroid);
  return eigen && eigen->values[0] > kThick * kThick * eigen->values[2];
}

std::optional<SE3> board_from_plane(const PointSet& view) {
  constexpr double kFlat = 0.2;    // of the extent along z = 0, that a bent sheet reaches out of it
  constexpr double kExact = 1e-9;  // of its square: points of a plane, given with 5 digits
  const auto is_high = [](const Eigen::Vector3d& p) { return p.z() != 0; };
  if (std::none_of(view.points.begin(), view.points.end(), is_high)) return std::nullopt;
  const Scatter s = scatter_of(view);
  const Eigen::Matrix3d& m = s.about_centroid;
  const auto eigen = symmetric_eigen(m);
  if (!eigen) return std::nullopt;
  const double across = m(2, 2) + static_cast<double>(s.count) * s.centroid.z() * s.centroid.z();
  const bool is_about = across <= kFlat * kFlat * (m(0, 0) + m(1, 1));
  const bool is_exact = eigen->values[0] <= kExact * eigen->values[2];
  if (is_about && !is_exact) return std::nullopt;
  SE3 plane;
  plane.rotation = eigen->vectors.rowwise().reverse();
  if (plane.rotation.determinant() < 0) plane.rotation.col(2) *= -1;
  plane.translation = s.centroid;
  return plane;
}

}  // namespace calvin
