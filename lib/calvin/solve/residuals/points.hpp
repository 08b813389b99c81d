// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The input of the least squares: known points, and where one frame shows them. Internal.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// What a readout does to a corner that moves: in a frame that is read in t s, from the first row to
// the last, the corner is seen where it was `delay` t after the middle row was read.
struct RowMotion {
  Pixel by_readout;  // px/s: the velocity times the delay in readouts, -1/2..1/2
  double rate = 0;   // 1/s: the velocity across the rows, in rows from the first to the last
};

// One view, structure of arrays. The points of a printed board lie about the plane z = 0 of the
// board frame, those of a PointBoard may lie in space.
struct PointSet {
  std::size_t index = 0;  // of the view it was made from
  std::size_t board = 0;  // equal for views of one board
  std::uint64_t timestamp = kNoTimestamp;
  std::vector<int> ids;                 // indices in Board::points(), which have no gaps
  std::vector<Eigen::Vector3d> points;  // m, board frame
  std::vector<Pixel> uv;                // px
  std::vector<double> weight;           // 1 / sigma; 0: left out
  std::vector<RowMotion> motion;        // empty: nothing moves
  bool sigma_known = true;              // every corner came with a sigma
  bool ambiguous = false;               // the board may be labelled otherwise

  [[nodiscard]] std::size_t size() const noexcept { return points.size(); }
  [[nodiscard]] std::size_t used() const noexcept;

  [[nodiscard]] PointSet without_corners() const;
  void reserve(std::size_t corners);
  void append(const PointSet& from, std::size_t i);  // one corner of another view
};

// The corners of one checked view of `board`, standing still, whose points, bent or as printed, are
// `points`.
[[nodiscard]] PointSet to_points(const Board& board, const std::vector<Eigen::Vector3d>& points,
                                 const Observation& observation);

// How the corners of an observation move by the readout of an image that many rows high; nothing
// where it has no velocities.
[[nodiscard]] std::vector<RowMotion> row_motion(const Observation& observation, int height);

// Whether the points in use span a plane: at least 4, not all on one line.
[[nodiscard]] bool spans_plane(const PointSet& view);

// Whether the points in use tell a camera by themselves: at least 6, which lie as far out of any
// plane as tells perspective from tilt. A bent board does not.
[[nodiscard]] bool spans_space(const PointSet& view);

// The plane next to the points in use, whose z = 0 it is, for points that lie in another plane than
// the z = 0 of their board. Absent for those that lie in it, or about it as those of a bent sheet.
[[nodiscard]] std::optional<SE3> board_from_plane(const PointSet& view);

}  // namespace calvin
