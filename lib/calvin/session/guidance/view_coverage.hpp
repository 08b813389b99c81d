// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How well a set of views spans what a camera can be shown.
#pragma once

#include <array>
#include <vector>

#include "calvin/session/guidance/hint.hpp"
#include "calvin/session/progress.hpp"
#include "calvin/solve/solve.hpp"

namespace calvin {

// Where one view shows its board.
struct BoardFootprint {
  Pixel center;     // of the corners, as a part of the image: 0 .. 1 across and down
  double x = 0;     // centre of the board, 0 (as far left as it fits) .. 1
  double y = 0;     // 0 (as far up as it fits) .. 1
  double size = 0;  // square root of its part of the image, 0..1
  double tilt = 0;  // 0: a rectangle .. 1: a corner 30 degrees off the right angle

  // Which edge is the nearest: by how much it looks longer than its opposite, -1..1.
  double left_nearer = 0;
  double top_nearer = 0;
  double aspect = 1;  // of its width to its height, over that of the board itself
};

// Spans like those that ROS's camera calibrator shows, and a hint at what is missing most.
class ViewCoverage {
 public:
  void add(const View& view);
  void clear() { *this = ViewCoverage(); }

  [[nodiscard]] double coverage() const;  // part of the image inside of any board, 0..1
  [[nodiscard]] CoverageMap map() const;  // which part
  [[nodiscard]] double x() const;
  [[nodiscard]] double y() const;
  [[nodiscard]] double size() const;
  [[nodiscard]] double tilt() const;
  [[nodiscard]] bool spans_all() const;

  // kGood where it spans all.
  [[nodiscard]] Hint hint() const;

 private:
  void add_nearer_edges(const BoardFootprint& p);

  static constexpr int kColumns = 16;
  static constexpr int kRows = 12;

  // Of a number that many footprints have; a stream of views may have no end.
  struct Range {
    double low = 1;
    double high = 0;

    void add(double value);
    [[nodiscard]] double share_of(double whole) const;  // 0..1, of the range to be spanned
  };

  bool empty_ = true;
  Range x_;
  Range y_;
  double largest_ = 0;
  double most_tilted_ = 0;
  // Whether each edge, as kEdges of the .cpp lists them, was nearer to the camera than the
  // opposite.
  std::array<bool, 4> seen_nearer_{};
  std::array<bool, static_cast<std::size_t>(kColumns* kRows)> covered_{};
};

// What is to be done to a board that is seen so for it to be seen like `wanted`: first moved,
// nearer or farther on the way, then tilted, then held.
[[nodiscard]] Hint hint_towards(const BoardFootprint& wanted, const BoardFootprint& now);

// Absent corners are extrapolated; a view without a homography has no footprint.
[[nodiscard]] Result<BoardFootprint> footprint_of(const View& view);

}  // namespace calvin
