// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The arrowhead problem: one block of unknowns shared by all (cameras, a rig, the shape of the
// board), and many small blocks that know nothing of each other (the pose of a board: 6, a free
// point: 3). Internal.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "calvin/solve/linear/aligned.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"

namespace calvin {

// The sizes of an arrowhead problem, and how its matrices are stored: rows are `stride` apart, a
// multiple of the widest vector.
struct ArrowLayout {
  static constexpr int kPose = 6;
  static constexpr int kPoint = 3;

  int shared = 0;          // unknowns of the shared block
  std::size_t poses = 0;   // small blocks of 6 unknowns
  std::size_t points = 0;  // small blocks of 3, whose numbers follow those of the poses

  [[nodiscard]] std::size_t blocks() const { return poses + points; }
  // The unknowns of a small block.
  [[nodiscard]] int size(std::size_t block) const { return block < poses ? kPose : kPoint; }
  // A row holds the gradient and then a value for each shared unknown.
  [[nodiscard]] std::size_t row() const { return static_cast<std::size_t>(shared) + 1; }
  [[nodiscard]] std::size_t stride() const { return (row() + kLanes - 1) / kLanes * kLanes; }
};

// The shared unknowns that a residual depends on, in rising order.
class ArrowColumns {
 public:
  // The ranges rise and do not overlap; some may be empty.
  ArrowColumns(std::initializer_list<ParameterRange> ranges);

  [[nodiscard]] int count() const { return count_; }
  // The runs of places in a row of the shared block: the gradient, then the unknowns.
  [[nodiscard]] std::span<const ParameterRange> runs() const { return runs_; }

 private:
  std::vector<ParameterRange> runs_;
  int count_ = 0;
};

// The normal equations J^T J, with J^T r as one more row, never J itself.
class ArrowEquations {
 public:
  explicit ArrowEquations(const ArrowLayout& layout);

  void clear();

  // Adds the products of the columns of some residuals: the lower triangle of a matrix over the
  // unknowns of one small block, then the residual, then the shared unknowns `columns`. No other
  // unknown is touched.
  void add(std::size_t block, const ArrowColumns& columns, const double* products,
           std::size_t stride);
  // Adds to the shared block alone: information and gradient of one unknown.
  void add_prior(int unknown, double information, double gradient);

  [[nodiscard]] const ArrowLayout& layout() const { return layout_; }
  // Whether add() was called for the block since clear(): else it holds nothing.
  [[nodiscard]] bool filled(std::size_t block) const { return filled_[block]; }
  // The block by itself, lower triangle, row-major, layout().size(block) wide.
  [[nodiscard]] const double* own(std::size_t block) const;
  // [gradient | by the shared unknowns], layout().size(block) rows of stride().
  [[nodiscard]] const double* cross(std::size_t block) const;
  // [gradient | matrix] of the shared unknowns, lower triangle; the first row is r^T r alone.
  [[nodiscard]] const double* shared() const { return shared_.get(); }
  [[nodiscard]] double shared(int i, int j) const;
  [[nodiscard]] double shared_gradient(int i) const;

 private:
  ArrowLayout layout_;
  AlignedArray blocks_;
  AlignedArray shared_;
  std::vector<bool> filled_;  // per block
};

// Eliminates each small block by its Cholesky factor. What is left is a system over the shared
// unknowns alone (the Schur complement), so that the cost of a step grows with the number of blocks
// and not faster.
class ArrowElimination {
 public:
  explicit ArrowElimination(const ArrowLayout& layout);

  // Every diagonal element of a block is multiplied by 1 + lambda first. False where a block is not
  // positive definite, as one that nothing was added to.
  [[nodiscard]] bool eliminate(const ArrowEquations& equations, double lambda);

  // The Schur complement and gradient of the last elimination; the shared block is not damped.
  [[nodiscard]] Eigen::MatrixXd schur() const;
  [[nodiscard]] Eigen::VectorXd reduced_gradient() const;
  // r^T r where every block takes the step that suits it best.
  [[nodiscard]] double reduced_cost() const { return schur_[0]; }

  // The step of a block that goes with one of the shared unknowns.
  void block_step(std::size_t block, const Eigen::VectorXd& shared_step, double* step) const;

 private:
  ArrowLayout layout_;
  AlignedArray whitened_;        // L^-1 [gradient | cross] of each block
  AlignedArray schur_;           // as ArrowEquations::shared()
  std::vector<double> factors_;  // L of each block
};

}  // namespace calvin
