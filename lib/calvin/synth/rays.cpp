// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Interpolates rays bicubically between the nodes of a coarse grid; where nodes have no ray, each
// pixel is unprojected.

#include "calvin/synth/rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace calvin::synth {

namespace {

constexpr int kStep = 8;                // px between exact rays
constexpr double kSmoothEnough = 1e-4;  // px

using Weights = std::array<double, 4>;

// Lagrange's weights of the nodes -1, 0, 1, 2 at t.
Weights cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

// Second derivatives of the same.
Weights cubic_bends(double t) { return {1 - t, 3 * t - 2, 1 - 3 * t, t}; }

// Lines between the corners of a pixel leave, in the mean over it, a part of what the rays bend
// from one pixel to the next: they would put every bent edge to its hollow side. It is 1/12 where
// the edge runs along the pixels and 1/8 where it runs across their corners, 5/48 in the mean over
// all directions. The corners are moved by as much.
constexpr double kOfBend = 5.0 / 48;

class Interpolator {
 public:
  explicit Interpolator(const Camera& camera)
      : camera_(camera),
        columns_(camera.image_size().width + 1),
        rows_(camera.image_size().height + 1),
        coarse_columns_((columns_ + kStep - 1) / kStep + 3),
        coarse_rows_((rows_ + kStep - 1) / kStep + 3),
        rays_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) * 3) {
    for (int i = 0; i < kStep; ++i) {
      const double t = static_cast<double>(i) / kStep;
      Weights w = cubic_weights(t);
      if (i == kStep / 2) half_ = w;
      const Weights bends = cubic_bends(t);
      for (std::size_t k = 0; k < 4; ++k) w[k] -= kOfBend / (kStep * kStep) * bends[k];
      weights_[static_cast<std::size_t>(i)] = w;
    }
    coarse_.reserve(static_cast<std::size_t>(coarse_columns_) *
                    static_cast<std::size_t>(coarse_rows_));
    for (int j = -1; j < coarse_rows_ - 1; ++j) {
      for (int i = -1; i < coarse_columns_ - 1; ++i) coarse_.push_back(exact(i * kStep, j * kStep));
    }
  }

  std::vector<float> run() {
    for (int j = 0; j < rows_; j += kStep) {
      for (int i = 0; i < columns_; i += kStep) fill_cell(i, j);
    }
    return std::move(rays_);
  }

 private:
  Eigen::Vector3d exact(int i, int j) const {
    return camera_.unproject({i - 0.5, j - 0.5}).value_or(Eigen::Vector3d::Zero());
  }

  // Where rays are missing around it, as it is.
  Eigen::Vector3d corner(int i, int j) const {
    Eigen::Vector3d ray = exact(i, j);
    if (ray.isZero()) return ray;
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();
    for (const auto& [u, v] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Eigen::Vector3d next = exact(i + u, j + v);
      if (next.isZero()) return ray;
      bend += next - ray;
    }
    return ray - kOfBend * bend;
  }

  // The 4 x 4 exact rays around a cell whose first node is (i, j).
  using Patch = std::array<std::array<Eigen::Vector3d, 4>, 4>;
  bool patch(int i, int j, Patch& nodes) const {
    const auto first = static_cast<std::size_t>((j / kStep) * coarse_columns_ + i / kStep);
    for (std::size_t b = 0; b < 4; ++b) {
      for (std::size_t a = 0; a < 4; ++a) {
        nodes[b][a] = coarse_[first + b * static_cast<std::size_t>(coarse_columns_) + a];
        if (nodes[b][a].isZero()) return false;
      }
    }
    return true;
  }

  static Eigen::Vector3d combine(const std::array<Eigen::Vector3d, 4>& nodes, const Weights& w) {
    return w[0] * nodes[0] + w[1] * nodes[1] + w[2] * nodes[2] + w[3] * nodes[3];
  }
  static std::array<Eigen::Vector3d, 4> combine_rows(const Patch& nodes, const Weights& w) {
    std::array<Eigen::Vector3d, 4> row;
    for (std::size_t a = 0; a < 4; ++a) {
      row[a] = w[0] * nodes[0][a] + w[1] * nodes[1][a] + w[2] * nodes[2][a] + w[3] * nodes[3][a];
    }
    return row;
  }

  bool is_smooth(const Patch& nodes, int i, int j) const {
    const Eigen::Vector3d error =
        combine(combine_rows(nodes, half_), half_) - exact(i + kStep / 2, j + kStep / 2);
    return error.norm() * std::max(camera_.fx(), camera_.fy()) < kSmoothEnough;
  }

  void fill_cell(int i, int j) {
    Patch nodes;
    const bool smooth = patch(i, j, nodes) && is_smooth(nodes, i, j);
    for (int b = 0; b < std::min(kStep, rows_ - j); ++b) {
      std::array<Eigen::Vector3d, 4> row;
      if (smooth) row = combine_rows(nodes, weights_[static_cast<std::size_t>(b)]);
      float* out = rays_.data() + 3 * (static_cast<std::ptrdiff_t>(j + b) * columns_ + i);
      for (int a = 0; a < std::min(kStep, columns_ - i); ++a, out += 3) {
        const Eigen::Vector3d ray =
            smooth ? combine(row, weights_[static_cast<std::size_t>(a)]) : corner(i + a, j + b);
        for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(ray[k]);
      }
    }
  }

  const Camera& camera_;
  int columns_;
  int rows_;
  int coarse_columns_;
  int coarse_rows_;
  std::array<Weights, kStep> weights_;
  Weights half_;                         // of an exact ray halfway
  std::vector<Eigen::Vector3d> coarse_;  // from one step before the image to one step after
  std::vector<float> rays_;
};

}  // namespace

std::vector<float> pixel_corner_rays(const Camera& camera) { return Interpolator(camera).run(); }

}  // namespace calvin::synth
