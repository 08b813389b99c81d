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
std::size_t own_size(int block) { return (square(block) + kLanes - 1) / kLanes * kLanes; }

std::size_t cross_size(const ArrowLayout& layout, int block) {
  return static_cast<std::size_t>(block) * layout.stride();
}

// Where a block begins in memory that has this many numbers for each pose and for each point.
std::size_t begin_of(const ArrowLayout& layout, std::size_t block, std::size_t pose,
                     std::size_t point) {
  return block < layout.poses ? block * pose : layout.poses * pose + (block - layout.poses) * point;
}

std::size_t own_begin(const ArrowLayout& layout, std::size_t block) {
  return begin_of(layout, block,
                  own_size(ArrowLayout::kPose) + cross_size(layout, ArrowLayout::kPose),
                  own_size(ArrowLayout::kPoint) + cross_size(layout, ArrowLayout::kPoint));
}

std::size_t cross_begin(const ArrowLayout& layout, std::size_t block) {
  return begin_of(layout, block, cross_size(layout, ArrowLayout::kPose),
                  cross_size(layout, ArrowLayout::kPoint));
}

std::size_t factor_begin(const ArrowLayout& layout, std::size_t block) {
  return begin_of(layout, block, square(ArrowLayout::kPose), square(ArrowLayout::kPoint));
}

std::size_t shared_size(const ArrowLayout& layout) { return layout.stride() * layout.stride(); }

// Adds numbers that stand side by side to a run of places; what follows them.
const double* add_run(const double* from, ParameterRange run, double* to) {
  to += run.first;
  for (int i = 0; i < run.count; ++i) to[i] += from[i];
  return from + run.count;
}

}  // namespace

ArrowColumns::ArrowColumns(std::initializer_list<ParameterRange> ranges) {
  runs_.push_back({0, 1});
  for (const ParameterRange& range : ranges) {
    count_ += range.count;
    const ParameterRange run = range.after(1);
    if (run.first == runs_.back().end()) {
      runs_.back().count += run.count;
    } else if (!run.empty()) {
      runs_.push_back(run);
    }
  }
}

ArrowEquations::ArrowEquations(const ArrowLayout& layout)
    : layout_(layout),
      blocks_(aligned_array(own_begin(layout, layout.blocks()))),
      shared_(aligned_array(shared_size(layout))),
      filled_(layout.blocks()) {
  clear();
}

void ArrowEquations::clear() {
  std::fill_n(shared_.get(), shared_size(layout_), 0.0);
  std::fill(filled_.begin(), filled_.end(), false);
}

const double* ArrowEquations::own(std::size_t block) const {
  return &blocks_[own_begin(layout_, block)];
}

const double* ArrowEquations::cross(std::size_t block) const {
  return own(block) + own_size(layout_.size(block));
}

double ArrowEquations::shared(int i, int j) const {
  const auto row = static_cast<std::size_t>(std::max(i, j)) + 1;
  return shared_[row * layout_.stride() + static_cast<std::size_t>(std::min(i, j)) + 1];
}

double ArrowEquations::shared_gradient(int i) const {
  return shared_[(static_cast<std::size_t>(i) + 1) * layout_.stride()];
}

void ArrowEquations::add(std::size_t block, const ArrowColumns& columns, const double* products,
                         std::size_t stride) {
  const auto n = static_cast<std::size_t>(layout_.size(block));
  const std::size_t own_count = own_size(layout_.size(block));
  double* own = &blocks_[own_begin(layout_, block)];
  double* cross = own + own_count;
  if (!filled_[block]) std::fill_n(own, own_count + n * layout_.stride(), 0.0);
  filled_[block] = true;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) own[i * n + j] += products[i * stride + j];
  }
  const double* line = products + n * stride;
  const auto runs = columns.runs();
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (int c = runs[r].first; c < runs[r].end(); ++c, line += stride) {
      const auto place = static_cast<std::size_t>(c);
      for (std::size_t i = 0; i < n; ++i) cross[i * layout_.stride() + place] += line[i];
      double* shared = &shared_[place * layout_.stride()];
      const double* from = line + n;
      for (const ParameterRange& before : runs.first(r)) from = add_run(from, before, shared);
      add_run(from, {runs[r].first, c + 1 - runs[r].first}, shared);
    }
  }
}

void ArrowEquations::add_prior(int unknown, double information, double gradient) {
  const auto at = static_cast<std::size_t>(unknown) + 1;
  shared_[at * layout_.stride()] += gradient;
  shared_[at * layout_.stride() + at] += information;
}

ArrowElimination::ArrowElimination(const ArrowLayout& layout)
    : layout_(layout),
      whitened_(aligned_array(cross_begin(layout, layout.blocks()))),
      schur_(aligned_array(shared_size(layout))),
      factors_(factor_begin(layout, layout.blocks())) {}

bool ArrowElimination::eliminate(const ArrowEquations& equations, double lambda) {
  std::copy_n(equations.shared(), shared_size(layout_), schur_.get());
  for (std::size_t b = 0; b < layout_.blocks(); ++b) {
    const int n = layout_.size(b);
    double* factor = &factors_[factor_begin(layout_, b)];
    if (!equations.filled(b) || !cholesky(equations.own(b), n, lambda, factor)) return false;
    double* whitened = &whitened_[cross_begin(layout_, b)];
    std::copy_n(equations.cross(b), cross_size(layout_, n), whitened);
    solve_lower_rows(factor, n, whitened, layout_.stride(), layout_.row());
    subtract_products(whitened, n, layout_.stride(), layout_.row(), schur_.get());
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
  const int n = layout_.size(block);
  const double* w = &whitened_[cross_begin(layout_, block)];
  for (int i = 0; i < n; ++i, w += layout_.stride()) {
    double sum = -w[0];
    for (Eigen::Index k = 0; k < shared_step.size(); ++k) sum -= w[k + 1] * shared_step[k];
    step[i] = sum;
  }
  solve_upper(&factors_[factor_begin(layout_, block)], n, step);
}

}  // namespace calvin
