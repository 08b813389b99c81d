// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of one view as arrays that vector code can walk. Internal.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <Eigen/Core>
#include "calvin/solve/linear/aligned.hpp"

#include "calvin/solve/residuals/board_shape.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {

// The corners in use of a view, which are those with a weight. Every array has padded() values;
// values from count() on repeat the first corner with the weight 0.
class ViewPoints {
 public:
  // The arrays of the printed board are shared with `other` where that shows the same points.
  ViewPoints(const PointSet& view, const BoardShape& shape, const ViewPoints* other = nullptr);

  // Puts the corners of ids i at points[i]: they are of no board, and their arrays of no other
  // view.
  void place(const std::vector<Eigen::Vector3d>& points);
  // Component k of those, to be written.
  [[nodiscard]] double* place(std::size_t k) { return &printed_->arrays[k * padded_]; }

  [[nodiscard]] std::size_t count() const { return printed_->ids.size(); }
  [[nodiscard]] const std::vector<int>& ids() const { return printed_->ids; }
  [[nodiscard]] std::size_t padded() const { return padded_; }
  [[nodiscard]] std::size_t modes() const { return modes_; }

  // Component k (x y z, m, board frame) of the corners on the board as printed, and of mode m.
  [[nodiscard]] const double* board(std::size_t k) const { return &printed_->arrays[k * padded_]; }
  [[nodiscard]] const double* mode(std::size_t m, std::size_t k) const {
    return board(3 + 3 * m + k);
  }
  [[nodiscard]] const double* u() const { return &seen_[0]; }  // px
  [[nodiscard]] const double* v() const { return &seen_[padded_]; }
  [[nodiscard]] const double* weight() const { return &seen_[2 * padded_]; }
  // RowMotion of the corners: by_readout.u, by_readout.v, rate; null where nothing moves.
  [[nodiscard]] const double* motion(std::size_t k) const {
    return moves_ ? &seen_[(3 + k) * padded_] : nullptr;
  }

 private:
  struct Printed {
    std::vector<int> ids;
    AlignedArray arrays;  // x y z, then those of every mode

    // Whether these are the arrays of the corners in use of `view`.
    [[nodiscard]] bool shows(const PointSet& view, std::size_t padded) const;
  };
  [[nodiscard]] Printed printed(const PointSet& view, const BoardShape& shape) const;

  std::size_t padded_ = 0;
  std::size_t modes_ = 0;
  bool moves_ = false;
  AlignedArray seen_;                 // u v weight, then the motion
  std::shared_ptr<Printed> printed_;  // views that share it never change it
};

}  // namespace calvin
