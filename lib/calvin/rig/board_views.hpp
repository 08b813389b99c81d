// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What one view says of where its board is before its camera: one pose, or several that are about
// as good. Internal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/result.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/rig/rig_views.hpp"
#include "calvin/solve/residuals/lens_points.hpp"
#include "calvin/solve/residuals/points.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin::rig {

struct BoardView {
  RigView of;
  std::size_t board = 0;  // equal for views of one board, or of one body of boards
  PointSet seen;          // weights of all views of the rig have the median 1
  double sigma = 1;       // px, of a corner with the weight 1
  std::shared_ptr<const ViewPoints> sample;  // of `seen`, some corners in use all over the board
  // other_from_own of board frames: the board by another labelling that is as good; the first one
  // is the identity. Of a body body_from_own.
  std::vector<SE3> labellings;
  // camera_from_board by the labelling of the observation: the best, and the other tilt of the
  // plane where that fits nearly as well.
  std::vector<SE3> poses;
  std::vector<Pixel> velocity;  // px/s, of the corners of `seen`; empty where it is not known
  std::size_t own_board = 0;    // equal for views of one board
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // of its points, m
};

// The motions of the board frame that go with Observation::ambiguous; the first one is the
// identity.
[[nodiscard]] std::vector<SE3> labellings_of(const View& view);

// Whether two motions of the frame of a board are one labelling.
[[nodiscard]] bool is_same_labelling(const SE3& one, const SE3& other);

// The views of all cameras, those first whose camera comes first; without views that determine no
// pose. `cameras` are those of the views, in their order. Errors are those of
// check_before_camera() in solve/view.hpp, and name the camera.
[[nodiscard]] Result<std::vector<BoardView>> board_views(const std::vector<RigCameraViews>& seen,
                                                         const std::vector<Camera>& cameras);

// Those that a joint fit starts from: of boards that stand still the views of instants alone, as
// pair_instants() has them, with poses that are near their optima.
[[nodiscard]] Result<std::vector<BoardView>> paired_board_views(
    const std::vector<RigCameraViews>& seen, const std::vector<Camera>& cameras,
    std::uint64_t tolerance, InstantsOf of);

// BoardView::sample, of what `seen` is now.
[[nodiscard]] std::shared_ptr<const ViewPoints> sample_of(const PointSet& seen);

// One of each camera, in their order.
[[nodiscard]] std::vector<CameraPoints> points_before(const std::vector<Camera>& cameras);

// The views of each instant, as numbers in `views`, which are in the order of board_views().
[[nodiscard]] std::vector<std::vector<std::size_t>> group_views(
    const Instants& instants, const std::vector<BoardView>& views);

// The root mean square of the weighted distances of the sample of corners from where they are
// expected, px: `camera_from_board` takes the board as `labelling` has it. Large where one has no
// projection.
[[nodiscard]] double misfit(const BoardView& view, const CameraPoints& camera,
                            const SE3& camera_from_board, const SE3& labelling);

}  // namespace calvin::rig
