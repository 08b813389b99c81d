// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The absolute dual quadric by weighted linear least squares, and a search over focal lengths.

#include "calvin/rig/light/space.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calvin/geometry/se3.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

constexpr int kUnknowns = 10;  // of a symmetric 4x4 matrix
using Row = Eigen::Matrix<double, kUnknowns, 1>;

// How far from true each supposition may be, in units of the focal length squared.
struct Suppositions {
  double focal = 9;     // f^2 - 1
  double aspect = 0.1;  // fx^2 - fy^2
  double skew = 0.02;
  double center = 0.1;
};
constexpr Suppositions kUnknownCamera = {};
constexpr double kFocalSpread = 0.5;  // of the logarithm of f
constexpr Suppositions kKnownCamera = {0.02, 0.02, 0.02, 0.02};

// p^T Q q by the ten numbers of Q.
Row form(const Eigen::Vector4d& p, const Eigen::Vector4d& q) {
  Row row;
  int k = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) row[k++] = i == j ? p[i] * q[i] : p[i] * q[j] + p[j] * q[i];
  }
  return row;
}

Eigen::Matrix4d quadric_of(const Eigen::VectorXd& x) {
  Eigen::Matrix4d quadric;
  int k = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) quadric(i, j) = quadric(j, i) = x[k++];
  }
  return quadric;
}

// The equations of one camera, each over how far from true it may be.
Eigen::Matrix<double, kUnknowns, kUnknowns> equations(const Matrix34& p, const Suppositions& may_be,
                                                      double unit) {
  const Eigen::Vector4d x = p.row(0);
  const Eigen::Vector4d y = p.row(1);
  const Eigen::Vector4d z = p.row(2);
  const std::pair<Row, double> all[] = {{form(x, x) - form(z, z), may_be.focal},
                                        {form(y, y) - form(z, z), may_be.focal},
                                        {form(x, x) - form(y, y), may_be.aspect},
                                        {form(x, y), may_be.skew},
                                        {form(x, z), may_be.center},
                                        {form(y, z), may_be.center}};
  Eigen::Matrix<double, kUnknowns, kUnknowns> m;
  m.setZero();
  for (const auto& [row, sigma] : all) {
    const Row weighted = row / (sigma * unit);
    m += weighted * weighted.transpose();
  }
  return m;
}

std::vector<Matrix34> scaled(std::vector<Matrix34> projections) {
  for (Matrix34& p : projections) p /= p.row(2).head<3>().norm();
  return projections;
}

// Q up to scale, its sign that of the images of most cameras.
Eigen::Matrix4d absolute_quadric(const std::vector<Matrix34>& projections,
                                 const std::vector<bool>& is_known) {
  constexpr int kRounds = 6;
  std::vector<double> unit(projections.size(), 1);
  Eigen::Matrix4d quadric = Eigen::Matrix4d::Zero();
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd m = Eigen::MatrixXd::Zero(kUnknowns, kUnknowns);
    for (std::size_t c = 0; c < projections.size(); ++c) {
      m += equations(projections[c], is_known[c] ? kKnownCamera : kUnknownCamera, unit[c]);
    }
    quadric = quadric_of(least_direction(m));
    double sum = 0;
    for (std::size_t c = 0; c < projections.size(); ++c) {
      const double own = projections[c].row(2) * quadric * projections[c].row(2).transpose();
      unit[c] = std::max(std::abs(own), 1e-6);
      sum += own;
    }
    if (sum < 0) quadric = -quadric;
  }
  return quadric;
}

// The map of space H with Q = H diag(1, 1, 1, 0) H^T, for the Q of rank 3 that is nearest. Absent
// where none is near.
std::optional<Eigen::Matrix4d> space_of(const Eigen::Matrix4d& quadric) {
  constexpr double kLeast = 1e-6;  // of the largest axis
  const auto eigen = symmetric_eigen(quadric);
  if (!eigen) return std::nullopt;
  const Eigen::Vector4d values = eigen->values;
  if (!(values[1] > kLeast * values[3])) return std::nullopt;
  Eigen::Matrix4d h;
  for (int k = 0; k < 3; ++k) h.col(k) = std::sqrt(values[k + 1]) * eigen->vectors.col(k + 1);
  h.col(3) = eigen->vectors.col(0);
  return h;
}

// The map of space that takes the first camera to [I | 0].
Eigen::Matrix4d to_canonical(const Matrix34& first) {
  Eigen::Matrix4d rows;
  rows.topRows<3>() = first;
  rows.row(3) = least_direction(first.transpose() * first).transpose();
  return rows.inverse();
}

// With the first camera [I | 0], of focal length `first`, and another one of focal length `focal`.
Eigen::Matrix4d space_with(const Matrix34& other, double first, double focal) {
  Matrix34 p = other;
  p.leftCols<2>() *= first;
  p.topRows<2>() /= focal;
  const Eigen::Vector3d t = p.col(3);
  const Eigen::Matrix3d m = rotation_between(t, Eigen::Vector3d::UnitX()) * p.leftCols<3>();
  const Eigen::Vector3d second = m.row(1);
  const Eigen::Vector3d third = m.row(2);
  const Eigen::Vector3d plane =
      (second.cross(third) / third.norm() - m.row(0).transpose()) / t.norm();
  Eigen::Matrix4d h = Eigen::Matrix4d::Identity();
  h(0, 0) = h(1, 1) = first;
  h.bottomLeftCorner<1, 3>() = plane.transpose();
  return h;
}

std::vector<double> focal_lengths(bool is_known) {
  constexpr double kLeast = 0.35;  // of half the sum of the sides: 110 degrees wide
  constexpr double kStep = 1.15;
  constexpr int kCount = 18;
  if (is_known) return {1};
  std::vector<double> all;
  for (int i = 0; i < kCount; ++i) all.push_back(kLeast * std::pow(kStep, i));
  return all;
}

// A map of space, how far cameras are after it from what is supposed of them, and the logarithms of
// their focal lengths.
struct Space {
  Eigen::Matrix4d map;
  double implausible = 0;
  std::vector<double> focal;
};

Space judged(const std::vector<Matrix34>& projections, const std::vector<bool>& is_known,
             const Eigen::Matrix4d& h) {
  constexpr double kMuch = 3;  // of a supposition, beyond which it is merely wrong
  Space space{h, 0, {}};
  const auto add = [&space](double off, double may_be) {
    const double ratio = off / may_be / kMuch;
    space.implausible += std::log1p(ratio * ratio);
  };
  for (std::size_t c = 0; c < projections.size(); ++c) {
    const Suppositions& may_be = is_known[c] ? kKnownCamera : kUnknownCamera;
    const Eigen::Matrix3d own = projections[c] * h.leftCols<3>();
    const Eigen::Matrix3d image = own * own.transpose() / own.row(2).squaredNorm();
    const double squared = 0.5 * (image(0, 0) + image(1, 1));
    space.focal.push_back(0.5 * std::log(squared));
    add(space.focal.back(), is_known[c] ? may_be.focal : kFocalSpread);
    add((image(0, 0) - image(1, 1)) / squared, may_be.aspect);
    add(image(0, 1) / squared, may_be.skew);
    add(image(0, 2), may_be.center);
    add(image(1, 2), may_be.center);
  }
  return space;
}

std::vector<Space> spaces_by_search(const std::vector<Matrix34>& projections,
                                    const std::vector<bool>& is_known) {
  std::vector<Space> all;
  const Eigen::Matrix4d canonical = to_canonical(projections.front());
  for (std::size_t c = 1; c < projections.size(); ++c) {
    const Matrix34 other = projections[c] * canonical;
    for (const double first : focal_lengths(is_known.front())) {
      for (const double focal : focal_lengths(is_known[c])) {
        all.push_back(judged(projections, is_known, canonical * space_with(other, first, focal)));
      }
    }
  }
  return all;
}

bool are_alike(const Space& a, const Space& b) {
  constexpr double kAlike = 0.2;  // of the logarithm of a focal length
  double apart = 0;
  for (std::size_t c = 0; c < a.focal.size(); ++c) {
    apart = std::max(apart, std::abs(a.focal[c] - b.focal[c]));
  }
  return apart < kAlike;
}

}  // namespace

std::vector<Eigen::Matrix4d> plausible_spaces(const std::vector<Matrix34>& projections,
                                              const std::vector<bool>& is_known, std::size_t most) {
  std::vector<Space> all = spaces_by_search(projections, is_known);
  if (const auto h = space_of(absolute_quadric(scaled(projections), is_known))) {
    all.push_back(judged(projections, is_known, *h));
  }
  std::erase_if(all, [](const Space& space) { return !std::isfinite(space.implausible); });
  std::ranges::stable_sort(all, {}, &Space::implausible);
  std::vector<Space> chosen;
  for (const Space& space : all) {
    const auto alike = [&](const Space& other) { return are_alike(space, other); };
    if (chosen.size() < most && std::ranges::none_of(chosen, alike)) chosen.push_back(space);
  }
  std::vector<Eigen::Matrix4d> maps;
  for (const Space& space : chosen) maps.push_back(space.map);
  return maps;
}

}  // namespace calvin::rig
