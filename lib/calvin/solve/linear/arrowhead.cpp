// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums of the normal equations, block by block, and the elimination of the small blocks.

#include "calvin/solve/linear/arrowhead.hpp"

#include <algorithm>

#include "calvin/solve/linear/cholesky.hpp"
#include "calvin/solve/linear/products.hpp"

namespace calvin {

namespace {

std::size_t square(int n) { return static_cast<std::size_t>(n) * static_cast<std::size_t>(n); }

// Numbers of a block by itself, rounded up so that what follows it in memory is aligned.
std::size_t own_size(const ArrowLayout& layout) {
  return (square(layout.block) + kLanes - 1) / kLanes * kLanes;
}

std::size_t cross_size(const ArrowLayout& layout) {
  return static_cast<std::size_t>(layout.block) * layout.stride();
}

std::size_t shared_size(const ArrowLayout& layout) { return layout.stride() * layout.stride(); }

}  // namespace

ArrowEquations::ArrowEquations(const ArrowLayout& layout)
    : layout_(layout),
      blocks_(aligned_array(layout.blocks * (own_size(layout) + cross_size(layout)))),
      shared_(aligned_array(shared_size(layout))),
      filled_(layout.blocks) {
  clear();
}

void ArrowEquations::clear() {
  std::fill_n(shared_.get(), shared_size(layout_), 0.0);
  std::fill(filled_.begin(), filled_.end(), false);
}

const double* ArrowEquations::own(std::size_t block) const {
  return &blocks_[block * (own_size(layout_) + cross_size(layout_))];
}

const double* ArrowEquations::cross(std::size_t block) const {
  return own(block) + own_size(layout_);
}

double ArrowEquations::shared(int i, int j) const {
  const auto row = static_cast<std::size_t>(std::max(i, j)) + 1;
  return shared_[row * layout_.stride() + static_cast<std::size_t>(std::min(i, j)) + 1];
}

double ArrowEquations::shared_gradient(int i) const {
  return shared_[(static_cast<std::size_t>(i) + 1) * layout_.stride()];
}

void ArrowEquations::add(std::size_t block, const double* products, std::size_t stride) {
  const auto n = static_cast<std::size_t>(layout_.block);
  double* own = &blocks_[block * (own_size(layout_) + cross_size(layout_))];
  double* cross = own + own_size(layout_);
  if (!filled_[block]) std::fill_n(own, own_size(layout_) + cross_size(layout_), 0.0);
  filled_[block] = true;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) own[i * n + j] += products[i * stride + j];
  }
  for (std::size_t c = 0; c < layout_.row(); ++c) {
    const double* line = products + (n + c) * stride;
    for (std::size_t i = 0; i < n; ++i) cross[i * layout_.stride() + c] += line[i];
    double* shared = &shared_[c * layout_.stride()];
    for (std::size_t j = 0; j <= c; ++j) shared[j] += line[n + j];
  }
}

void ArrowEquations::add_prior(int unknown, double information, double gradient) {
  const auto at = static_cast<std::size_t>(unknown) + 1;
  shared_[at * layout_.stride()] += gradient;
  shared_[at * layout_.stride() + at] += information;
}

ArrowElimination::ArrowElimination(const ArrowLayout& layout)
    : layout_(layout),
      whitened_(aligned_array(layout.blocks * cross_size(layout))),
      schur_(aligned_array(shared_size(layout))),
      factors_(layout.blocks * square(layout.block)) {}

bool ArrowElimination::eliminate(const ArrowEquations& equations, double lambda) {
  std::copy_n(equations.shared(), shared_size(layout_), schur_.get());
  for (std::size_t b = 0; b < layout_.blocks; ++b) {
    double* factor = &factors_[b * square(layout_.block)];
    if (!cholesky(equations.own(b), layout_.block, lambda, factor)) return false;
    double* whitened = &whitened_[b * cross_size(layout_)];
    std::copy_n(equations.cross(b), cross_size(layout_), whitened);
    solve_lower_rows(factor, layout_.block, whitened, layout_.stride(), layout_.stride());
    subtract_products(whitened, layout_.block, layout_.stride(), layout_.stride(), schur_.get());
  }
  return true;
}

Eigen::MatrixXd ArrowElimination::schur() const {
  Eigen::MatrixXd s(layout_.shared, layout_.shared);
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    const double* row = &schur_[static_cast<std::size_t>(i + 1) * layout_.stride() + 1];
    for (Eigen::Index j = 0; j <= i; ++j) s(i, j) = s(j, i) = row[j];
  }
  return s;
}

Eigen::VectorXd ArrowElimination::reduced_gradient() const {
  Eigen::VectorXd g(layout_.shared);
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    g[i] = schur_[static_cast<std::size_t>(i + 1) * layout_.stride()];
  }
  return g;
}

void ArrowElimination::block_step(std::size_t block, const Eigen::VectorXd& shared_step,
                                  double* step) const {
  const double* w = &whitened_[block * cross_size(layout_)];
  for (int i = 0; i < layout_.block; ++i, w += layout_.stride()) {
    double sum = -w[0];
    for (Eigen::Index k = 0; k < shared_step.size(); ++k) sum -= w[k + 1] * shared_step[k];
    step[i] = sum;
  }
  solve_upper(&factors_[block * square(layout_.block)], layout_.block, step);
}

}  // namespace calvin
