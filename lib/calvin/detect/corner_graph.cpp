// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/detect/corner_graph.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calvin::detect {

namespace {

constexpr float kCell = 16;         // px, side of a cell
constexpr float kLeastStep = 4.5F;  // px between neighbours
constexpr float kCone = 0.3F;       // tangent of how far off the edge a neighbour may lie
constexpr float kAlong = 1 + kCone * kCone;
constexpr float kOffEdge = 2.5F;   // how much a px off the edge counts more than one along it
constexpr float kTurn = 0.39F;     // sine of how far an edge may turn on the way
constexpr int kMostLookedAt = 48;  // a board's neighbours are among the first of them
constexpr float kContrast = 2.9F;  // ratio of the contrasts
constexpr float kLonger = 2;       // than the link on the other side: then it skips corners

int cell_of(float x) { return static_cast<int>(x / kCell); }

int pixel(const ImageView& image, float x, float y) {
  const int u = std::clamp(static_cast<int>(x + 0.5F), 0, image.width - 1);
  const int v = std::clamp(static_cast<int>(y + 0.5F), 0, image.height - 1);
  return image.at(u, v);
}

// Whether one edge joins two corners, bright on the same side all the way: on a floor of tiles, or
// in a fabric, a corner three squares further on has the right colours too. `way` as in kWays.
bool is_joined(const ImageView& image, const Corner& from, const Corner& to, std::size_t way) {
  constexpr float kAside = 0.25F;  // of the way
  constexpr float kLeastAside = 1.2F;
  constexpr float kMostAside = 3;  // px: the squares across may be narrow
  constexpr float kLeast = 0.12F;  // of the corners' contrast
  constexpr float kEvery = 3;      // px
  constexpr float kInner = 0.6F;   // of the way; close to the corners the ring has looked
  constexpr int kForgiven = 8;     // of so many samples one
  const Direction step = {to.x - from.x, to.y - from.y};
  const float length = std::hypot(step.x, step.y);
  const float aside = std::clamp(kAside * length, kLeastAside, kMostAside) / length;
  // Both ways along the rising edge it is bright from +x towards +y.
  const float side = way < 2 ? aside : -aside;
  const Direction across = {-side * step.y, side * step.x};
  const float least = kLeast * std::min(from.contrast, to.contrast);
  // As close together as the sides of the smallest squares are long; from the middle outwards,
  // which is where they tell soonest. A speck on the edge is forgiven.
  const int samples = std::max(3, static_cast<int>(length / kEvery));
  int misses = samples / kForgiven;
  for (int i = 0; i < samples; ++i) {
    const float off = static_cast<float>((i + 1) / 2) / static_cast<float>(samples);
    const float share = 0.5F + kInner * ((i & 1) != 0 ? off : -off);
    const float x = from.x + share * step.x;
    const float y = from.y + share * step.y;
    const int bright = pixel(image, x + across.x, y + across.y);
    const int dark = pixel(image, x - across.x, y - across.y);
    if (static_cast<float>(bright - dark) < least && misses-- == 0) return false;
  }
  return true;
}

}  // namespace

void CornerGraph::sort_into_cells(std::span<const Corner> corners, ImageSize size) {
  cells_across_ = cell_of(static_cast<float>(size.width)) + 1;
  cells_down_ = cell_of(static_cast<float>(size.height)) + 1;
  const auto cell = [&](const Corner& c) {
    return static_cast<std::size_t>(cell_of(c.y) * cells_across_ + cell_of(c.x));
  };
  cell_begin_.assign(static_cast<std::size_t>(cells_across_ * cells_down_) + 1, 0);
  for (const Corner& c : corners) ++cell_begin_[cell(c) + 1];
  for (std::size_t i = 1; i < cell_begin_.size(); ++i) cell_begin_[i] += cell_begin_[i - 1];
  in_cells_.resize(corners.size());
  sorted_.resize(corners.size());
  // Each begin moves to the cell's end, which is where the next one begins.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto at = static_cast<std::size_t>(cell_begin_[cell(corners[i])]++);
    in_cells_[at] = static_cast<int>(i);
    sorted_[at] = corners[i];
  }
  for (std::size_t i = cell_begin_.size() - 1; i > 0; --i) cell_begin_[i] = cell_begin_[i - 1];
  cell_begin_[0] = 0;
}

std::array<int, kWays> CornerGraph::nearest(const Corner& from, float reach) const {
  std::array<int, kWays> best = {kNoCorner, kNoCorner, kNoCorner, kNoCorner};
  std::array<float, kWays> cost;
  cost.fill(std::numeric_limits<float>::infinity());

  int looked_at = 0;
  const auto look_at = [&](int other) {
    const Corner& to = sorted_[static_cast<std::size_t>(other)];
    const Direction step = {to.x - from.x, to.y - from.y};
    const float square = dot(step, step);
    const float on_rising = dot(step, from.rising);
    const float on_falling = dot(step, from.falling);
    // Most lie along neither edge, and the corner itself does not.
    if (kAlong * std::max(on_rising * on_rising, on_falling * on_falling) <= square) return;
    if (to.contrast * kContrast < from.contrast || to.contrast > kContrast * from.contrast) return;
    for (std::size_t line = 0; line < 2; ++line) {
      const Direction edge = line == 0 ? from.rising : from.falling;
      const float on = line == 0 ? on_rising : on_falling;
      const float along = std::abs(on);
      const float off = std::abs(cross(step, edge));
      if (off > kCone * along || along < kLeastStep || along > reach) continue;
      const std::size_t way = 2 * line + (on < 0 ? 1 : 0);
      const float c = along + kOffEdge * off;
      if (c >= cost[way]) continue;
      const float across = cross(line == 0 ? to.falling : to.rising, step);
      if (across * across > kTurn * kTurn * square) continue;
      cost[way] = c;
      best[way] = other;
    }
  };
  const auto look_in_cells = [&](int row, int first, int last) {
    if (row < 0 || row >= cells_down_) return;
    first = std::max(first, 0);
    last = std::min(last, cells_across_ - 1);
    if (first > last) return;
    const auto begin = static_cast<std::size_t>(row * cells_across_);
    const int end = cell_begin_[begin + static_cast<std::size_t>(last) + 1];
    const int start = cell_begin_[begin + static_cast<std::size_t>(first)];
    looked_at += end - start;
    for (int i = start; i < end; ++i) look_at(i);
  };
  // One further off than these is no neighbour: there is a nearer one, or it skips some.
  const auto farthest = [&] {
    float most = 0;
    for (std::size_t way = 0; way < kWays; ++way) {
      most = std::max(most, std::min(cost[way], kLonger * cost[way ^ 1]));
    }
    return most;
  };
  // Squares of cells around the corner's own, until nothing nearer can come.
  const int col = cell_of(from.x);
  const int row = cell_of(from.y);
  const int rings = static_cast<int>(std::ceil(reach / kCell));
  for (int r = 0; r <= rings; ++r) {
    if (looked_at > kMostLookedAt || farthest() < static_cast<float>(r - 1) * kCell) break;
    look_in_cells(row - r, col - r, col + r);
    if (r == 0) continue;
    look_in_cells(row + r, col - r, col + r);
    for (int y = row - r + 1; y < row + r; ++y) {
      look_in_cells(y, col - r, col - r);
      look_in_cells(y, col + r, col + r);
    }
  }
  for (int& other : best) {
    if (other != kNoCorner) other = in_cells_[static_cast<std::size_t>(other)];
  }
  return best;
}

// Whether a link is far longer than that of its corner's other side: then it skips some.
bool CornerGraph::skips(std::span<const Corner> corners, int from, int to) const {
  const Corner& a = corners[static_cast<std::size_t>(from)];
  const auto length = [&](int other) {
    const Corner& b = corners[static_cast<std::size_t>(other)];
    return std::hypot(a.x - b.x, a.y - b.y);
  };
  const auto& ways = nearest_[static_cast<std::size_t>(from)];
  const auto way = static_cast<std::size_t>(std::find(ways.begin(), ways.end(), to) - ways.begin());
  const int opposite = way < ways.size() ? ways[way ^ 1] : kNoCorner;
  return opposite != kNoCorner && length(to) > kLonger * length(opposite);
}

void CornerGraph::build(const ImageView& image, std::span<const Corner> corners, float reach) {
  sort_into_cells(corners, image.size());
  nearest_.resize(corners.size());
  links_.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    nearest_[static_cast<std::size_t>(in_cells_[i])] = nearest(sorted_[i], reach);
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t w = 0; w < kWays; ++w) {
      const int other = nearest_[i][w];
      const auto sees_back = [&] {
        const auto& back = nearest_[static_cast<std::size_t>(other)];
        return std::find(back.begin(), back.end(), static_cast<int>(i)) != back.end();
      };
      links_[i][w] =
          other != kNoCorner && sees_back() && !skips(corners, static_cast<int>(i), other) &&
                  !skips(corners, other, static_cast<int>(i)) &&
                  is_joined(image, corners[i], corners[static_cast<std::size_t>(other)], w)
              ? other
              : kNoCorner;
    }
  }
}

}  // namespace calvin::detect
