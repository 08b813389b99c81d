// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The products of rows, turned from the frame of a camera to that of its rig or of a free point.

#include "calvin/solve/residuals/row_plan.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "calvin/solve/linear/products.hpp"

namespace calvin {

namespace {

constexpr int kPose = RowLayout::kPose;
constexpr int kPoint = ArrowLayout::kPoint;
constexpr int kTranslation = 3;  // the first column of a pose's translation

using Matrix6d = Eigen::Matrix<double, 6, 6>;

std::size_t padded(int columns) {
  return (static_cast<std::size_t>(columns) + kLanes - 1) / kLanes * kLanes;
}

// A motion d of the board in the rig, as in retract(), moves what the camera sees as the motion
// adjoint * d in the camera's frame does: [turn 0; lever turn].
struct Adjoint {
  Eigen::Matrix3d turn;
  Eigen::Matrix3d lever;

  explicit Adjoint(const SE3& camera_from_rig) : turn(camera_from_rig.rotation) {
    const Eigen::Vector3d& t = camera_from_rig.translation;
    for (int k = 0; k < 3; ++k) lever.col(k) = t.cross(turn.col(k));
  }

  // m adjoint, by rows of m.
  template <typename Rows>
  [[nodiscard]] auto after(const Rows& m) const {
    Eigen::Matrix<double, Rows::RowsAtCompileTime, 6> product;
    product.template rightCols<3>().noalias() = m.template rightCols<3>() * turn;
    product.template leftCols<3>().noalias() = m.template leftCols<3>() * turn;
    product.template leftCols<3>().noalias() += m.template rightCols<3>() * lever;
    return product;
  }

  // The lower triangle of adjoint^T m, for an m that makes it symmetric.
  [[nodiscard]] Matrix6d transposed_before(const Matrix6d& m) const {
    Matrix6d product;
    product.bottomRows<3>().noalias() = turn.transpose() * m.bottomRows<3>();
    product.topLeftCorner<3, 3>().noalias() = turn.transpose() * m.topLeftCorner<3, 3>();
    product.topLeftCorner<3, 3>().noalias() += lever.transpose() * m.bottomLeftCorner<3, 3>();
    return product;
  }
};

}  // namespace

RowPlan::RowPlan(const ParameterTable& table, std::size_t camera, std::optional<std::size_t> board)
    : table_(&table),
      camera_(camera),
      board_(board),
      fill_(fill_rows_of(table.model(camera))),
      rows_(row_layout(table, camera, board)),
      columns_({table.camera(camera), table.readout(camera), table.rig_pose(camera),
                board ? table.board(*board) : ParameterRange()}),
      stride_(padded(rows_.layout().columns() + rig_columns())),
      products_(aligned_array(stride_ * stride_)) {
  if (board) return;
  rigged_ = aligned_array(stride_ * stride_);
  point_ = aligned_array(stride_ * kLanes);
  std::fill_n(point_.get(), stride_ * kLanes, 0.0);
}

void RowPlan::set(const std::vector<double>& shared) {
  at_ = row_point(*table_, camera_, board_, shared);
}

RowSums RowPlan::fill(const ViewPoints& view, const SE3& pose, const Loss& loss) {
  rows_.resize(view.padded());
  return fill_(view, at_, pose, loss, rows_, RowContent::kAll);
}

void RowPlan::add_pose(std::size_t block, const SE3* camera_from_rig, ArrowEquations& equations) {
  column_products(rows_.data(), 2 * rows_.padded(), rows_.layout().columns(), products_.get(),
                  stride_);
  if (camera_from_rig == nullptr) {
    equations.add(block, columns_, products_.get(), stride_);
    return;
  }
  through_rig(*camera_from_rig);
  equations.add(block, columns_, rigged_.get(), stride_);
}

// The rows have the derivatives by a motion in the camera's frame. Those by the place of the camera
// in the rig are the same ones, those by the pose of the board in the rig are the adjoint's times
// them; so that products are all that has to be turned.
void RowPlan::through_rig(const SE3& camera_from_rig) {
  if (!rigged_) rigged_ = aligned_array(stride_ * stride_);
  const Adjoint adjoint(camera_from_rig);
  Matrix6d own;
  for (int i = 0; i < kPose; ++i) {
    for (int j = 0; j <= i; ++j) {
      own(i, j) = own(j, i) = products_[static_cast<std::size_t>(i) * stride_ + j];
    }
  }
  const Matrix6d by_turn = adjoint.after(own);
  const Matrix6d turned = adjoint.transposed_before(by_turn);
  const int rig = rig_columns();
  const int first_rig = rows_.layout().first_mode();
  const auto out = [this](int i, int j) -> double& {
    return rigged_[static_cast<std::size_t>(i) * stride_ + j];
  };
  for (int i = 0; i < kPose; ++i) {
    for (int j = 0; j <= i; ++j) out(i, j) = turned(i, j);
  }
  for (int row = kPose; row < rows_.layout().columns(); ++row) {
    const double* line = &products_[static_cast<std::size_t>(row) * stride_];
    const Eigen::Map<const Eigen::Matrix<double, 1, 6>> by_motion(line);
    const int to = row < first_rig ? row : row + rig;
    Eigen::Map<Eigen::Matrix<double, 1, 6>>(&out(to, 0)) = adjoint.after(by_motion);
    for (int j = kPose; j <= row; ++j) out(to, j < first_rig ? j : j + rig) = line[j];
    for (int k = 0; k < rig; ++k) {
      (row < first_rig ? out(first_rig + k, row) : out(to, first_rig + k)) = line[k];
    }
  }
  for (int k = 0; k < rig; ++k) {
    for (int j = 0; j < kPose; ++j) out(first_rig + k, j) = by_turn(k, j);
    for (int j = 0; j <= k; ++j) out(first_rig + k, first_rig + j) = own(k, j);
  }
}

void RowPlan::add_point(std::size_t block, std::size_t at, const SE3& camera_from_world,
                        ArrowEquations& equations) {
  int column = 0;
  const auto put = [&](double u, double v) {
    double* to = &point_[static_cast<std::size_t>(column++) * kLanes];
    to[0] = u;
    to[1] = v;
  };
  for (int k = 0; k < kPoint; ++k) {
    double u = 0;
    double v = 0;
    for (int i = 0; i < kPoint; ++i) {
      u += rows_.u(kTranslation + i)[at] * camera_from_world.rotation(i, k);
      v += rows_.v(kTranslation + i)[at] * camera_from_world.rotation(i, k);
    }
    put(u, v);
  }
  for (int c = kPose; c < rows_.layout().columns(); ++c) put(rows_.u(c)[at], rows_.v(c)[at]);
  for (int c = 0; c < rig_columns(); ++c) put(rows_.u(c)[at], rows_.v(c)[at]);
  column_products(point_.get(), kLanes, column, rigged_.get(), stride_);
  equations.add(block, columns_, rigged_.get(), stride_);
}

std::size_t plan_for(RowPlans& plans, const ParameterTable& table, std::size_t camera,
                     std::optional<std::size_t> board) {
  const auto known = std::find_if(plans.begin(), plans.end(),
                                  [&](const RowPlan& plan) { return plan.is(camera, board); });
  const auto number = static_cast<std::size_t>(known - plans.begin());
  if (known == plans.end()) plans.emplace_back(table, camera, board);
  return number;
}

}  // namespace calvin
