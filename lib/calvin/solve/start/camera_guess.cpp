// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Focal lengths and poses from homographies: Zhang's closed form, and a grid of focal lengths.

#include "calvin/solve/start/camera_guess.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "calvin/geometry/symmetric.hpp"
#include "calvin/solve/start/plane_pose.hpp"
#include "calvin/solve/start/projection_matrix.hpp"

namespace calvin {

namespace {

// The range of focal lengths of cameras, in image widths.
constexpr double kShortest = 0.1;
constexpr double kLongest = 30;

bool possible(const Guess& g, ImageSize size) {
  const auto focal = [size](double f) {
    return f > kShortest * size.width && f < kLongest * size.width;
  };
  return focal(g[0]) && focal(g[1]) && std::max(g[0], g[1]) < 2 * std::min(g[0], g[1]) &&
         g[2] > 0 && g[2] < size.width && g[3] > 0 && g[3] < size.height;
}

// Zhang 2000, section 3.1 and appendix B, with zero skew: the image of the absolute conic
// b = (B11, B22, B13, B23, B33) is orthogonal to two rows per view.
std::optional<Guess> zhang(std::span<const Eigen::Matrix3d> homographies) {
  Eigen::Matrix<double, 5, 5> m = Eigen::Matrix<double, 5, 5>::Zero();
  for (const Eigen::Matrix3d& h : homographies) {
    const auto row = [&h](int i, int j) {
      Eigen::Matrix<double, 5, 1> v;
      v << h(0, i) * h(0, j), h(1, i) * h(1, j), h(0, i) * h(2, j) + h(2, i) * h(0, j),
          h(1, i) * h(2, j) + h(2, i) * h(1, j), h(2, i) * h(2, j);
      return v;
    };
    const double norm = h.col(0).head<2>().squaredNorm() + h.col(1).head<2>().squaredNorm();
    const Eigen::Matrix<double, 5, 1> orthogonal = row(0, 1) / norm;
    const Eigen::Matrix<double, 5, 1> equal = (row(0, 0) - row(1, 1)) / norm;
    m += orthogonal * orthogonal.transpose() + equal * equal.transpose();
  }
  const auto eigen = symmetric_eigen(m);
  if (!eigen) return std::nullopt;
  Eigen::Matrix<double, 5, 1> b = eigen->vectors.col(0);
  if (b[0] < 0) b = -b;
  const double lambda = b[4] - b[2] * b[2] / b[0] - b[3] * b[3] / b[1];
  if (!(b[0] > 0) || !(b[1] > 0) || !(lambda > 0)) return std::nullopt;
  return Guess{std::sqrt(lambda / b[0]), std::sqrt(lambda / b[1]), -b[2] / b[0], -b[3] / b[1]};
}

// a / b = f^2 for the two orthogonal pairs of directions of a board seen in one view (J.-Y.
// Bouguet, Camera Calibration Toolbox; the vanishing points of the sides and of the diagonals).
struct FocalEquation {
  double a = 0;
  double b = 0;
  [[nodiscard]] std::optional<double> focal() const {
    if (!(a * b > 0)) return std::nullopt;
    return std::sqrt(a / b);
  }
};

FocalEquation focal_equation(const Eigen::Matrix3d& h) {
  FocalEquation sum;
  const auto add = [&sum](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    const double norm = p.norm() * q.norm();
    const double a = (p[0] * q[0] + p[1] * q[1]) / norm;
    const double b = -p[2] * q[2] / norm;
    sum.a += a * b;
    sum.b += b * b;
  };
  add(h.col(0), h.col(1));
  add((h.col(0) + h.col(1)) / 2, (h.col(0) - h.col(1)) / 2);
  return sum;
}

// A camera one image width before the image, whose axis meets the centre, as one in px.
std::optional<Guess> in_pixels(const Guess& unit, ImageSize size) {
  const Pixel center = image_center(size);
  const double width = size.width;
  const Guess g = {unit[0] * width, unit[1] * width, unit[2] * width + center.u,
                   unit[3] * width + center.v};
  return possible(g, size) ? std::optional(g) : std::nullopt;
}

}  // namespace

std::vector<Eigen::Vector3d> unit_rays(const PointSet& view, ImageSize size) {
  const Pixel center = image_center(size);
  std::vector<Eigen::Vector3d> rays;
  rays.reserve(view.size());
  for (const Pixel& p : view.uv) {
    rays.push_back(Eigen::Vector3d((p.u - center.u) / size.width, (p.v - center.v) / size.width, 1)
                       .normalized());
  }
  return rays;
}

std::optional<Eigen::Matrix3d> view_homography(const PointSet& view, ImageSize size) {
  if (board_from_plane(view)) return std::nullopt;
  return plane_homography(view.points, unit_rays(view, size));
}

std::optional<Guess> guess_in_space(const PointSet& view, ImageSize size) {
  if (!spans_space(view)) return std::nullopt;
  const auto p = projection_matrix(view.points, unit_rays(view, size));
  const auto camera = p ? decompose(*p) : std::nullopt;
  if (!camera) return std::nullopt;
  const Eigen::Matrix3d& k = camera->k;
  return in_pixels({k(0, 0), k(1, 1), k(0, 2), k(1, 2)}, size);
}

std::optional<SE3> pose_by_guess(const Eigen::Matrix3d& homography, const Guess& guess,
                                 ImageSize size) {
  const Pixel center = image_center(size);
  Eigen::Matrix3d plane = Eigen::Matrix3d::Identity();
  plane(0, 0) = size.width / guess[0];
  plane(1, 1) = size.width / guess[1];
  plane(0, 2) = (center.u - guess[2]) / guess[0];
  plane(1, 2) = (center.v - guess[3]) / guess[1];
  return pose_from_homography(plane * homography);
}

std::vector<Guess> closed_form_guesses(std::span<const Eigen::Matrix3d> homographies,
                                       ImageSize size) {
  std::vector<Guess> guesses;
  const auto offer = [&](const Guess& unit) {
    if (const auto g = in_pixels(unit, size)) guesses.push_back(*g);
  };
  if (homographies.size() >= 3) {
    if (const auto guess = zhang(homographies)) offer(*guess);
  }
  FocalEquation all;
  std::vector<double> single;
  for (const Eigen::Matrix3d& h : homographies) {
    const FocalEquation equation = focal_equation(h);
    all.a += equation.a;
    all.b += equation.b;
    if (const auto f = equation.focal()) single.push_back(*f);
  }
  if (const auto f = all.focal()) offer({*f, *f, 0, 0});
  if (!single.empty()) {
    const auto middle = single.begin() + static_cast<std::ptrdiff_t>(single.size() / 2);
    std::nth_element(single.begin(), middle, single.end());
    offer({*middle, *middle, 0, 0});
  }
  return guesses;
}

std::vector<Guess> focal_grid(ImageSize size, bool perspective) {
  const Pixel center = image_center(size);
  std::vector<Guess> guesses;
  for (const double widths : {0.16, 0.2, 0.25, 0.32, 0.42, 0.6, 0.9, 1.4, 2.2, 4.0, 8.0}) {
    if (perspective && widths < 0.3) continue;
    const double f = widths * size.width;
    guesses.push_back({f, f, center.u, center.v});
  }
  return guesses;
}

}  // namespace calvin
