// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the places in a square are that lies between four corners of a lattice.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/corners/corner.hpp"
#include "calvin/detect/checkerboard/corners/grey_at.hpp"
#include "calvin/detect/checkerboard/lattice.hpp"

namespace calvin::detect {

// Its sides are bent as the lines of nodes are that they are part of, by perspective and by the
// lens.
class LatticeSquare {
 public:
  // The one whose upper left corner is the node of `cell`. Absent where fewer than two of its
  // corners are there, and the others are not expected.
  [[nodiscard]] static std::optional<LatticeSquare> at(const Lattice& lattice, Cell cell);

  // grey levels, of its corners
  [[nodiscard]] float contrast() const { return contrast_; }

  // px, of (s, t), 0..1 from its upper left corner along the row and down.
  [[nodiscard]] Direction place(float s, float t) const {
    return {coordinate(&Direction::x, s, t), coordinate(&Direction::y, s, t)};
  }

  // px^2, of a smaller square of side `side` about such a place.
  [[nodiscard]] float area(float s, float t, float side) const {
    const float half = 0.5F * side;
    const Direction left = place(s - half, t);
    const Direction right = place(s + half, t);
    const Direction top = place(s, t - half);
    const Direction bottom = place(s, t + half);
    const Direction across = {right.x - left.x, right.y - left.y};
    return std::abs(cross(across, {bottom.x - top.x, bottom.y - top.y}));
  }

  // The grey level there; absent outside of the image.
  [[nodiscard]] std::optional<float> grey(const ImageView& image, float s, float t) const {
    const Direction at = place(s, t);
    return grey_at(image, at.x, at.y);
  }

 private:
  [[nodiscard]] float coordinate(float Direction::*of, float s, float t) const {
    // std::lerp() is exact at its ends, for which it takes several times as long.
    const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
    const float along = mix(along_bend_[0].*of, along_bend_[1].*of, t);
    const float down = mix(down_bend_[0].*of, down_bend_[1].*of, s);
    return mix(mix(corners_[0].*of, corners_[1].*of, s), mix(corners_[2].*of, corners_[3].*of, s),
               t) -
           0.5F * (s * (1 - s) * along + t * (1 - t) * down);
  }

  std::array<Direction, 4> corners_{};
  std::array<Direction, 2> along_bend_{};  // of the upper and of the lower side
  std::array<Direction, 2> down_bend_{};   // of the left and of the right side
  float contrast_ = 0;
};

}  // namespace calvin::detect
