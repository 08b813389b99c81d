// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of one view as arrays that vector code can walk. Internal.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include "calvin/solve/aligned.hpp"

#include "calvin/solve/points.hpp"

namespace calvin {

// Arrays end on a multiple of this, so that the widest vectors need no remainder.
inline constexpr std::size_t kLanes = 8;

// How the shape of a board may differ from the printed one: the point with id i moves by
// coefficient[m] * displacement[i * modes + m], in m.
struct BoardShape {
  std::size_t modes = 0;
  std::vector<Eigen::Vector3d> displacement;
};

// The corners in use of a view: those with a weight. Every array has padded() values; what is
// beyond count() repeats the first corner and weighs nothing.
class ViewPoints {
 public:
  ViewPoints(const PointSet& view, const BoardShape& shape);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::size_t padded() const { return padded_; }
  [[nodiscard]] std::size_t modes() const { return modes_; }

  // Component k (x y z, m, board frame) of the corners on the board as printed, and of mode m.
  [[nodiscard]] const double* board(std::size_t k) const { return array(k); }
  [[nodiscard]] const double* mode(std::size_t m, std::size_t k) const {
    return array(6 + 3 * m + k);
  }
  [[nodiscard]] const double* u() const { return array(3); }  // px
  [[nodiscard]] const double* v() const { return array(4); }
  [[nodiscard]] const double* weight() const { return array(5); }

 private:
  [[nodiscard]] const double* array(std::size_t i) const { return &data_[i * padded_]; }

  std::size_t count_ = 0;
  std::size_t padded_ = 0;
  std::size_t modes_ = 0;
  AlignedArray data_;
};

}  // namespace calvin
