// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares how light the bits of all markers are with those of a board.

#include "calvin/detect/checkerboard/code/blurred_markers.hpp"

#include <Eigen/Core>

#include "calvin/detect/checkerboard/code/marker_reader.hpp"

namespace calvin::detect {

namespace {

// Fewer markers may all lie in rows that another board has, too.
constexpr std::size_t kFewestBlurred = 6;

}  // namespace

void BlurredMarkers::take(const ImageView& image, const Lattice& lattice, const Code& code) {
  squares_.clear();
  weights_.clear();
  for (auto& places : turned_) places.clear();
  const MarkerShape* shape = code.markers();
  if (shape == nullptr) return;
  read(image, lattice, code);
  if (squares_.size() < kFewestBlurred) {
    squares_.clear();
    return;
  }
  weigh();
  for (std::size_t quarter = 0; quarter < turned_.size(); ++quarter) {
    for (const Cell c : squares_) {
      for (int i = 0; i < shape->side * shape->side; ++i) {
        turned_[quarter].push_back(code.turned({c, i}, static_cast<int>(quarter)));
      }
    }
  }
}

void BlurredMarkers::read(const ImageView& image, const Lattice& lattice, const Code& code) {
  const CellRange e = lattice.extent();
  for (int row = e.first.row; row < e.last.row; ++row) {
    for (int col = e.first.col; col < e.last.col; ++col) {
      const Cell c = {col, row};
      if (!code.may_hold_marker(lattice, c) || !is_whole_square(lattice, c)) continue;
      if (read_greys(image, lattice, c, *code.markers(), weights_)) squares_.push_back(c);
    }
  }
}

// What is common to all markers is taken off, as their rims' share of what is seen is; each marker
// has as much to say as any other one.
void BlurredMarkers::weigh() {
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<Rows> markers(weights_.data(), std::ssize(squares_),
                           static_cast<std::ptrdiff_t>(bits()));
  markers.colwise() -= markers.rowwise().mean().eval();
  markers.rowwise() -= markers.colwise().mean().eval();
  markers.rowwise().normalize();
}

BlurredMarkers::Sum BlurredMarkers::compare(const Code& code,
                                            const GridAlignment& alignment) const {
  Sum sum;
  const Cell shift = alignment.point({0, 0});
  const CodePlace* place = turned_[static_cast<std::size_t>(alignment.quarter)].data();
  const float* weight = weights_.data();
  for (std::size_t m = 0; m < squares_.size(); ++m) {
    double right = 0;
    bool is_on_board = true;
    for (std::size_t i = 0; i < bits(); ++i, ++place, ++weight) {
      const int expected = code.at({place->cell + shift, place->index});
      is_on_board = is_on_board && expected != 0;
      right += static_cast<double>(static_cast<float>(expected) * *weight);
    }
    if (!is_on_board) continue;
    ++sum.markers;
    sum.right += right;
    sum.squares += right * right;
  }
  return sum;
}

double BlurredMarkers::evidence(const Code& code, const GridAlignment& alignment) const {
  // The weights of a marker have squares that add up to 1: that is the variance of what random bits
  // are with them, and right ones differ no more among themselves. Right ones and others do.
  constexpr double kMostVariance = 2;
  if (squares_.empty()) return 0;
  const Sum sum = compare(code, alignment);
  if (!(sum.right > 0)) return 0;
  const double mean = sum.right / sum.markers;
  if (sum.squares / sum.markers - mean * mean > kMostVariance) return 0;
  return sum.right * sum.right / (2 * sum.markers);
}

}  // namespace calvin::detect
