// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How much single views tell about a camera, without solving them: to choose views, and where to
// hold a board.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/options.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

// The information of a view is the inverse of the covariance that its corners give to the
// parameters of the camera, its pose unknown: the Schur complement of the pose in the normal
// equations (B. Triggs, P. McLauchlan, R. Hartley, A. Fitzgibbon, Bundle Adjustment - A Modern
// Synthesis, 2000, section 6.1). It adds over views. n x n, over the directions in which a solve
// with the given options moves the camera; noise is that of the sigmas of the corners alone.
class ViewScorer {
 public:
  // About `camera`, which may be a guess. `options`: what is estimated; the model is the camera's.
  // kInvalidArgument for options that no solve takes.
  [[nodiscard]] static Result<ViewScorer> make(const Camera& camera, const SolveOptions& options);

  // Absent where the view is broken, a corner has no projection from there, or the corners do not
  // determine the pose.
  [[nodiscard]] std::optional<Eigen::MatrixXd> information(const View& view,
                                                           const SE3& camera_from_board) const;
  // What is known before any view: the order of magnitude of each parameter.
  [[nodiscard]] const Eigen::MatrixXd& prior() const noexcept { return prior_; }

  // px^2: the variance of a projection per coordinate, the mean over the picture, the best common
  // rotation of the camera taken out; `information` is the prior and that of some views.
  [[nodiscard]] double variance(const Eigen::MatrixXd& information) const;

 private:
  ViewScorer() = default;

  std::optional<Camera> camera_;
  Eigen::MatrixXd basis_;  // intrinsics x directions
  Eigen::MatrixXd prior_;  // directions x directions
  // F^T for the weight F F^T, px^2, whose trace with the covariance is variance().
  Eigen::MatrixXd weight_root_;
};

// Which `count` of some views, by their information, make the variance small together: each in turn
// the one that lowers it most, then each is exchanged for a better one while there is any (V. V.
// Fedorov, Theory of Optimal Experiments, 1972, chapter 3). In rising order; all where there are no
// more than `count`.
[[nodiscard]] std::vector<std::size_t> most_informative(const ViewScorer& scorer,
                                                        std::span<const Eigen::MatrixXd> views,
                                                        std::size_t count);

}  // namespace calvin
