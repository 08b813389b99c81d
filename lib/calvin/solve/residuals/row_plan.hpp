// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How the rows of one camera before one board, or before free points, are filled, and to which
// columns of the shared unknowns their products are added. Internal.
#pragma once

#include <optional>
#include <vector>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/linear/aligned.hpp"
#include "calvin/solve/linear/arrowhead.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"
#include "calvin/solve/residuals/view_rows.hpp"

namespace calvin {

class RowPlan {
 public:
  // Without a board: free points.
  RowPlan(const ParameterTable& table, std::size_t camera, std::optional<std::size_t> board);

  [[nodiscard]] bool is(std::size_t camera, std::optional<std::size_t> board) const {
    return camera == camera_ && board == board_;
  }
  // Takes the values of the shared unknowns, which must stay where they are.
  void set(const std::vector<double>& shared);

  [[nodiscard]] ViewRows& rows() { return rows_; }

  // Fills the rows of a view. The pose is camera_from_board, or camera_from_world for free points.
  RowSums fill(const ViewPoints& view, const SE3& pose, const Loss& loss);
  // Adds what was filled to the small block of the pose. Where there is a rig, `camera_from_rig` is
  // the place of the camera in it, and the pose in the block is rig_from_board.
  void add_pose(std::size_t block, const SE3* camera_from_rig, ArrowEquations& equations);
  // Adds corner `at` of what was filled to the small block of its point.
  void add_point(std::size_t block, std::size_t at, const SE3& camera_from_world,
                 ArrowEquations& equations);

 private:
  [[nodiscard]] int rig_columns() const { return table_->rig_pose(camera_).count; }
  void through_rig(const SE3& camera_from_rig);

  const ParameterTable* table_;
  std::size_t camera_;
  std::optional<std::size_t> board_;
  FillRows fill_;
  ViewRows rows_;
  RowPoint at_;
  ArrowColumns columns_;
  std::size_t stride_;     // of products_
  AlignedArray products_;  // of the columns of rows_
  AlignedArray rigged_;    // the same with the columns of the rig, or those of one point
  AlignedArray point_;     // the columns of one point
};

using RowPlans = std::vector<RowPlan>;

// The number of the plan for this camera and board; a new one where there is none yet.
std::size_t plan_for(RowPlans& plans, const ParameterTable& table, std::size_t camera,
                     std::optional<std::size_t> board);

}  // namespace calvin
