// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the least squares works on: known points and where one frame shows them. Internal.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// One view, structure of arrays. The points lie in the plane z = 0 of the board frame.
struct PointSet {
  std::size_t index = 0;  // of the view it was made from
  std::uint64_t timestamp = kNoTimestamp;
  std::vector<int> ids;
  std::vector<Eigen::Vector3d> points;  // m, board frame
  std::vector<Pixel> uv;                // px
  std::vector<double> weight;           // 1 / sigma; 0: left out

  [[nodiscard]] std::size_t size() const noexcept { return points.size(); }
  [[nodiscard]] std::size_t used() const noexcept;
};

// The corners of one checked view.
[[nodiscard]] PointSet to_points(const Board& board, const Observation& observation);

// Scales all weights alike, to a median of 1, so that weighted residuals are in px.
void normalise_weights(std::span<PointSet> views);

// Whether the points span a plane: at least 4, not all on one line.
[[nodiscard]] bool spans_plane(const PointSet& view);

// solve() from points on. Views are moved in; Solution::calibration lacks camera and board text.
[[nodiscard]] Result<Solution> solve_points(std::vector<PointSet> views, ImageSize image_size,
                                            const SolveOptions& options,
                                            const std::stop_token& stop = {});

}  // namespace calvin
