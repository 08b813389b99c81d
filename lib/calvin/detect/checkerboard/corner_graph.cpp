// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Links between mutual neighbours, kept where the image shows the edge between them.

#include "calvin/detect/checkerboard/corner_graph.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::detect {

namespace {

int pixel(const ImageView& image, float x, float y) {
  // Places outside of the image are moved to its border.
  const float up_x = x + 0.5F;
  const float up_y = y + 0.5F;
  const int u = std::clamp(static_cast<int>(up_x), 0, image.width - 1);
  const int v = std::clamp(static_cast<int>(up_y), 0, image.height - 1);
  return image.at(u, v);
}

// Whether both edges of a corner run as those of its neighbour, with exchanged colours. Among small
// squares a ring may see four that are none: all that is reached through it would be turned.
bool are_parallel(const Corner& a, const Corner& b) {
  constexpr float kTurn = 0.5F;  // sine of the angle between them
  return std::abs(cross(a.rising, b.falling)) < kTurn &&
         std::abs(cross(a.falling, b.rising)) < kTurn;
}

// Whether one edge joins two corners, bright on the same side all the way: on a floor of tiles, or
// in a fabric, a corner three squares further on has the right colours too. `way` as in kWays.
bool is_joined(const ImageView& image, const Corner& from, const Corner& to, std::size_t way,
               const Surroundings& surroundings) {
  constexpr float kAside = 0.25F;  // of the way
  constexpr float kLeastAside = 1.2F;
  constexpr float kMostAside = 3;  // px: the squares across may be narrow
  constexpr float kLeast = 0.12F;  // of the corners' contrast, between the two sides of the edge
  constexpr float kEvery = 3;      // px
  constexpr float kInner = 0.3F;   // of the way; close to the corners the ring has looked
  constexpr float kMostBesideMarkers = 1.6F;  // px: what lies between them and the edge is narrower
  constexpr float kRim = 0.04F;               // of the way, around what is printed on the edge
  constexpr int kForgiven = 8;                // of so many samples one
  const Direction step = {to.x - from.x, to.y - from.y};
  const float length = std::sqrt(dot(step, step));
  const float most_aside = surroundings.has_markers() ? kMostBesideMarkers : kMostAside;
  const float aside = std::clamp(kAside * length, kLeastAside, most_aside) / length;
  // The middle of the edge may be that of a dot.
  const float middle = surroundings.along < 1 ? 0.5F - surroundings.along + kRim : 0;
  // Both ways along the rising edge it is bright from +x towards +y.
  const float side = way < 2 ? aside : -aside;
  const Direction across = {-side * step.y, side * step.x};
  const float least = kLeast * std::min(from.contrast, to.contrast);
  // Samples as close together as the smallest squares are long, from the middle outwards, where a
  // wrong link shows first. A speck on the edge is forgiven.
  const int samples = std::max(3, static_cast<int>(length / kEvery));
  int misses = samples / kForgiven;
  for (int i = 0; i < samples; ++i) {
    const int steps = (i + 1) / 2;
    const float off = static_cast<float>(steps) / static_cast<float>(samples);
    const float inner = middle + 2 * (kInner - middle) * off;
    const float share = 0.5F + ((i & 1) != 0 ? inner : -inner);
    const float x = from.x + share * step.x;
    const float y = from.y + share * step.y;
    const int bright = pixel(image, x + across.x, y + across.y);
    const int dark = pixel(image, x - across.x, y - across.y);
    if (static_cast<float>(bright - dark) < least && misses-- == 0) return false;
  }
  return true;
}

}  // namespace

// Whether a link is far longer than the one on the other side of its corner: then it skips corners.
bool CornerGraph::skips(std::span<const Corner> corners, int from, int to) const {
  const Corner& a = corners[static_cast<std::size_t>(from)];
  const auto square = [&](int other) {
    const Corner& b = corners[static_cast<std::size_t>(other)];
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
  };
  const auto& ways = nearest_[static_cast<std::size_t>(from)];
  const auto way = static_cast<std::size_t>(std::find(ways.begin(), ways.end(), to) - ways.begin());
  const int opposite = way < ways.size() ? ways[way ^ 1] : kNoCorner;
  return opposite != kNoCorner &&
         square(to) > rules_.longest_link * rules_.longest_link * square(opposite);
}

void CornerGraph::build(const ImageView& image, std::span<const Corner> corners, float reach,
                        const Surroundings& surroundings) {
  // Between two corners of squares, what markers have for corners may be nearer.
  rules_ = {reach, surroundings.has_markers(), kLongestLink * surroundings.step_ratio()};
  search_.run(corners, image.size(), rules_, nearest_);
  links_.assign(corners.size(), {kNoCorner, kNoCorner, kNoCorner, kNoCorner});
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int self = static_cast<int>(i);
    for (std::size_t w = 0; w < kWays; ++w) {
      // Each pair is looked at from its first corner.
      const int other = nearest_[i][w];
      if (other <= self) continue;
      const auto& back = nearest_[static_cast<std::size_t>(other)];
      const auto way =
          static_cast<std::size_t>(std::find(back.begin(), back.end(), self) - back.begin());
      const Corner& to = corners[static_cast<std::size_t>(other)];
      if (way == back.size() || skips(corners, self, other) || skips(corners, other, self) ||
          !are_parallel(corners[i], to) || !is_joined(image, corners[i], to, w, surroundings)) {
        continue;
      }
      links_[i][w] = other;
      links_[static_cast<std::size_t>(other)][way] = self;
    }
  }
}

std::array<float, 2> CornerGraph::step_ratios(std::span<const Corner> corners, int corner) const {
  const auto& links = neighbours(corner);
  const Corner& from = corners[static_cast<std::size_t>(corner)];
  std::array<float, 2> ratios{};
  for (std::size_t edge = 0; edge < 2; ++edge) {
    float length[2] = {1, 1};
    if (links[2 * edge] == kNoCorner || links[2 * edge + 1] == kNoCorner) continue;
    for (std::size_t back = 0; back < 2; ++back) {
      const Corner& to = corners[static_cast<std::size_t>(links[2 * edge + back])];
      length[back] = std::hypot(to.x - from.x, to.y - from.y);
    }
    ratios[edge] = std::log(length[0] / length[1]);
  }
  return {ratios[0], -ratios[1]};
}

}  // namespace calvin::detect
