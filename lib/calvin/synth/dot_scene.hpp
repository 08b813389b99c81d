// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board of dots as a scene: pixels at the rim of a dot are sampled on a fine grid. Internal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calvin/synth/pixel_polygon.hpp"
#include "calvin/synth/scene_levels.hpp"
#include "calvin/target/point_board.hpp"

namespace calvin::synth {

class DotScene {
 public:
  // A point of the board plane, m; not finite where a ray does not meet it.
  struct Place {
    double x;
    double y;
  };

  DotScene(const PointBoard& board, const SceneLevels& levels)
      : board_(board), outline_(board.outline()), levels_(levels) {}

  [[nodiscard]] static double unit() { return 1; }
  [[nodiscard]] static Place nothing() {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
  [[nodiscard]] static Place place_at(double x, double y) { return {x, y}; }

  // `corners` returns the PixelCorners of the pixel that sees these places.
  template <typename Corners>
  [[nodiscard]] double mean(const Corners& corners, const std::array<Place, 4>& seen) const {
    double reach = 0;  // of the pixel on the board
    for (const Place& p : seen) {
      reach = std::max(reach, std::hypot(p.x - seen[0].x, p.y - seen[0].y));
      if (!std::isfinite(p.x) || !std::isfinite(p.y)) return levels_.background;
    }
    return is_near_an_edge(seen[0], reach) ? sampled(corners()) : value(seen[0]);
  }

 private:
  static constexpr int kSamples = 16;  // along each side of a pixel

  [[nodiscard]] static double distance_to_rim(const PointBoard::Dot& dot, const Place& p) {
    return std::hypot(p.x - dot.x, p.y - dot.y) - dot.diameter / 2;
  }
  // How far a place is inside the outline; negative outside.
  [[nodiscard]] double inside(const Place& p) const {
    return std::min(
        {p.x - outline_.left, outline_.right - p.x, p.y - outline_.top, outline_.bottom - p.y});
  }
  [[nodiscard]] bool is_near_an_edge(const Place& p, double reach) const {
    if (inside(p) < -reach) return false;
    if (inside(p) <= reach) return true;
    return std::any_of(board_.dots().begin(), board_.dots().end(), [&](const PointBoard::Dot& dot) {
      return std::abs(distance_to_rim(dot, p)) <= reach;
    });
  }
  [[nodiscard]] double value(const Place& p) const {
    if (inside(p) < 0) return levels_.background;
    const bool is_dark =
        std::any_of(board_.dots().begin(), board_.dots().end(),
                    [&](const PointBoard::Dot& dot) { return distance_to_rim(dot, p) < 0; });
    return is_dark ? levels_.dark : levels_.light;
  }
  [[nodiscard]] double sampled(const PixelCorners& corners) const {
    double sum = 0;
    for (int j = 0; j < kSamples; ++j) {
      for (int i = 0; i < kSamples; ++i) {
        sum += value(place_in(corners, (i + 0.5) / kSamples, (j + 0.5) / kSamples));
      }
    }
    return sum / (kSamples * kSamples);
  }
  // What the place (u, v) in a pixel shows, 0..1 from its upper left corner. The corners are in the
  // order upper left, upper right, lower right, lower left.
  [[nodiscard]] static Place place_in(const PixelCorners& corners, double u, double v) {
    const auto blend = [&](double Vertex::*coordinate) {
      const double above = std::lerp(corners[0].*coordinate, corners[1].*coordinate, u);
      const double below = std::lerp(corners[3].*coordinate, corners[2].*coordinate, u);
      return std::lerp(above, below, v);
    };
    const double w = blend(&Vertex::w);
    return {blend(&Vertex::x) / w, blend(&Vertex::y) / w};
  }

  const PointBoard& board_;
  BoardArea outline_;
  SceneLevels levels_;
};

}  // namespace calvin::synth
