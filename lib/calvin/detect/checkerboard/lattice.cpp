// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Nodes in a flat array, predictions from neighbours, and the removal of nodes that break them.

#include "calvin/detect/checkerboard/lattice.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::detect {

namespace {

constexpr float kShortestSpacing =
    3;  // px; smaller ones count as this, for places are rounded to pixels

// Places are px: their squares do not overflow, which std::hypot() takes time to avoid.
template <typename To>
float distance(const Node& a, const To& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
}

// The weights of nodes at the places pa, pb and pd of a line, for what is expected at its place 0:
// by a straight line through the first two of them, or by the mean of that and the parabola through
// all. Two that are close together tell little of one far from them: then by the parabola alone.
struct Extrapolation {
  float a;
  float b;
  float d = 0;

  constexpr Extrapolation(float pa, float pb) : a(1 + pa / (pb - pa)), b(-pa / (pb - pa)) {}
  constexpr Extrapolation(float pa, float pb, float pd) : Extrapolation(pa, pb) {
    const float straight = pb - pa < pa ? 0 : 0.5F;
    const float bent = 1 - straight;
    a = straight * a + bent * pb * pd / ((pa - pb) * (pa - pd));
    b = straight * b + bent * pa * pd / ((pb - pa) * (pb - pd));
    d = bent * pa * pb / ((pd - pa) * (pd - pb));
  }
};

}  // namespace

// Weighted sums of predicted places, and of the spacings of the nodes that predict them.
struct Lattice::Votes {
  float x = 0;
  float y = 0;
  float spacing = 0;
  float weight = 0;

  void add(float px, float py, float between, float w = 1) {
    x += w * px;
    y += w * py;
    spacing += w * between;
    weight += w;
  }
};

Lattice::Lattice(int reach, const Surroundings& surroundings)
    : reach_(reach),
      surroundings_(surroundings),
      nodes_(static_cast<std::size_t>((2 * reach + 1) * (2 * reach + 1))) {}

void Lattice::clear() {
  for (int row = touched_.first.row; row <= touched_.last.row; ++row) {
    for (int col = touched_.first.col; col <= touched_.last.col; ++col) {
      Node& node = nodes_[index({col, row})];
      node.used = node.refused = false;
    }
  }
  touched_ = {};
  count_ = 0;
}

void Lattice::put(Cell c, const Node& node) {
  Node& to = nodes_[index(c)];
  count_ += to.used ? 0 : 1;
  to = node;
  to.used = true;
  to.refused = false;
  if (touched_.cols() <= 0) {
    touched_ = {c, c};
  } else {
    touched_.first = {std::min(touched_.first.col, c.col), std::min(touched_.first.row, c.row)};
    touched_.last = {std::max(touched_.last.col, c.col), std::max(touched_.last.row, c.row)};
  }
}

void Lattice::remove(Cell c) {
  Node& node = nodes_[index(c)];
  count_ -= node.used ? 1 : 0;
  node.used = false;
}

void Lattice::refuse(Cell c) {
  remove(c);
  nodes_[index(c)].refused = true;
}

bool Lattice::was_refused(Cell c, const Expected& at) const {
  constexpr float kSamePlace = 0.1F;  // of the spacing
  const Node& node = nodes_[index(c)];
  return node.refused && distance(node, at) < kSamePlace * at.spacing;
}

CellRange Lattice::extent() const {
  CellRange e;
  for (int row = touched_.first.row; row <= touched_.last.row; ++row) {
    for (int col = touched_.first.col; col <= touched_.last.col; ++col) {
      if (!nodes_[index({col, row})].used) continue;
      if (e.cols() <= 0) {
        e = {{col, row}, {col, row}};
        continue;
      }
      e.first = {std::min(e.first.col, col), e.first.row};
      e.last = {std::max(e.last.col, col), row};
    }
  }
  return e;
}

int Lattice::neighbours(Cell c) const {
  return static_cast<int>(
      std::count_if(kAround.begin(), kAround.end(), [&](Cell step) { return has(c + step); }));
}

// Extrapolates the next nodes of a line.
void Lattice::add_extrapolation(Cell c, Cell step, Votes& votes) const {
  const Node& a = at(c + step);
  const Node& b = at(c + 2 * step);
  const float pa = length(c, step);
  const float ab = length(c + step, step);
  const float between = distance(a, b) / ab;
  constexpr Extrapolation kEvenOfTwo(1, 2);
  constexpr Extrapolation kEvenOfThree(1, 2, 3);
  if (!has(c + 3 * step)) {
    const Extrapolation by = has_even_steps() ? kEvenOfTwo : Extrapolation(pa, pa + ab);
    const float weight = ab < pa ? ab * ab / (pa * pa) : 1;
    votes.add(by.a * a.x + by.b * b.x, by.a * a.y + by.b * b.y, between, weight);
    return;
  }
  const Node& d = at(c + 3 * step);
  const float bd = length(c + 2 * step, step);
  const Extrapolation by =
      has_even_steps() ? kEvenOfThree : Extrapolation(pa, pa + ab, pa + ab + bd);
  votes.add(by.a * a.x + by.b * b.x + by.d * d.x, by.a * a.y + by.b * b.y + by.d * d.y, between);
}

std::optional<Expected> Lattice::expect(Cell c) const {
  Votes votes;
  for (const Cell step : kAround) {
    if (!has(c + step)) continue;
    const Node& a = at(c + step);
    if (has(c + 2 * step)) add_extrapolation(c, step, votes);
    const float pa = length(c, step);
    if (step.col + step.row > 0 && has(c - step)) {
      const Node& b = at(c - step);
      const float pb = length(c, -1 * step);
      const float of_a = pb / (pa + pb);
      const float of_b = pa / (pa + pb);
      votes.add(of_a * a.x + of_b * b.x, of_a * a.y + of_b * b.y, distance(a, b) / (pa + pb), 2);
    }
    // A parallelogram with the next way around.
    const Cell aside = {-step.row, step.col};
    if (has(c + aside) && has(c + step + aside)) {
      const Node& p = at(c + aside);
      const Node& q = at(c + step + aside);
      votes.add(a.x + p.x - q.x, a.y + p.y - q.y,
                0.5F * (distance(a, q) / length(c, aside) + distance(p, q) / pa));
    }
  }
  if (votes.weight == 0) return std::nullopt;
  return Expected{votes.x / votes.weight, votes.y / votes.weight,
                  surroundings_.gap * votes.spacing / votes.weight};
}

float Lattice::misfit(Cell c) const {
  const auto expected = expect(c);
  if (!expected) return 0;
  return distance(at(c), *expected) / std::max(expected->spacing, kShortestSpacing);
}

void Lattice::prune(float share) {
  // A stray node spoils what is expected of its neighbours: of several side by side the worst goes
  // first.
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    for_each([&](Cell c, const Node& /*node*/) { at(c).misfit = misfit(c); });
    bool removed = false;
    for_each([&](Cell c, const Node& node) {
      if (!(node.misfit > share)) return;
      for (int row = -1; row <= 1; ++row) {
        for (int col = -1; col <= 1; ++col) {
          const Cell other = c + Cell{col, row};
          if (has(other) && at(other).misfit > node.misfit) return;
        }
      }
      remove(c);
      removed = true;
    });
    if (!removed) break;
  }
  // Across the border of an image, where the corners of two tags are close together, only one may
  // be left to the other and to its line.
  const int least = has_even_steps() ? 2 : 1;
  for (bool again = true; again;) {
    again = false;
    for_each([&](Cell c, const Node& /*node*/) {
      if (neighbours(c) >= least) return;
      remove(c);
      again = true;
    });
  }
}

}  // namespace calvin::detect
