// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where a board can be held before a camera.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// An upright box in the picture, px.
struct PictureBox {
  double left = 0;
  double right = 0;
  double top = 0;
  double bottom = 0;
};

class BoardPlacement {
 public:
  // Both must outlive the placement. `area`: what of the board is to be in the picture; the whole.
  BoardPlacement(const Board& board, const Camera& camera)
      : BoardPlacement(board, camera, board.outline()) {}
  BoardPlacement(const Board& board, const Camera& camera, const BoardArea& area)
      : board_(board), camera_(camera), area_(area) {}

  [[nodiscard]] const Camera& camera() const noexcept { return camera_; }
  [[nodiscard]] Pixel middle() const;
  // What is to be left free between the board and the border of the picture, px.
  [[nodiscard]] double margin() const;

  // camera_from_board with the middle of the board at that pixel, turned by `turn` (a rotation
  // vector, rad) from where it faces the camera; so far away that a board that faces the camera has
  // that `size`: the square root of its part of the picture. Absent where no ray leads to the
  // pixel.
  [[nodiscard]] std::optional<SE3> pose_at(Pixel at, double size,
                                           const Eigen::Vector3d& turn) const;

  // The outline of the area in the picture, all around: several points of each edge, since a lens
  // may bend it. Empty where a part of it has no projection.
  [[nodiscard]] std::vector<Pixel> outline(const SE3& camera_from_board) const;
  // Around the outline.
  [[nodiscard]] std::optional<PictureBox> box(const SE3& camera_from_board) const;
  // Whether all of the area is in the picture, half the margin from its border.
  [[nodiscard]] bool is_inside(const SE3& camera_from_board) const;

  // What the camera would see, every corner with that sigma (px). Absent where a corner has no
  // projection.
  [[nodiscard]] std::optional<View> view(const SE3& camera_from_board, double sigma) const;

 private:
  const Board& board_;
  const Camera& camera_;
  BoardArea area_;
};

}  // namespace calvin
