// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Corners sorted into cells of the image, and the nearest one along each edge among them.

#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/detect/checkerboard/neighbour_search.cpp"
#include <hwy/foreach_target.h>
// The order matters: Highway includes this file again for each target from the line above.
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calvin/detect/checkerboard/neighbour_search.hpp"

#ifndef CALVIN_DETECT_NEIGHBOUR_SEARCH_LIMITS
#define CALVIN_DETECT_NEIGHBOUR_SEARCH_LIMITS
namespace calvin::detect {
inline constexpr float kCell = 16;         // px, side of a cell
inline constexpr float kLeastStep = 4.5F;  // px between neighbours
inline constexpr float kCone = 0.3F;       // tangent of how far off the edge a neighbour may lie
inline constexpr float kOffEdge = 2.5F;  // how much a px off the edge counts more than one along it
inline constexpr float kTurn = 0.39F;    // sine of how far an edge may turn on the way
inline constexpr int kMostScanned = 48;  // a board's neighbours are among the first of them
inline constexpr float kContrast = 2.9F;  // largest ratio of the contrasts of neighbours
inline constexpr int kLongestVector = 8;
inline int cell_of(float x) { return static_cast<int>(x / kCell); }
}  // namespace calvin::detect
#endif

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The nearest corners of one corner, by lanes of vectors.
class Nearest {
 public:
  Nearest(const CornerCells& cells, int self, const NeighbourRules& rules)
      : cells_(cells),
        x_(cells.x[self]),
        y_(cells.y[self]),
        edges_{{cells.rising_x[self], cells.rising_y[self]},
               {cells.falling_x[self], cells.falling_y[self]}},
        contrast_(cells.contrast[self]),
        reach_(rules.reach),
        parallel_(rules.parallel),
        longest_link_(rules.longest_link) {
    for (int way = 0; way < kWays; ++way) {
      for (int lane = 0; lane < kLongestVector; ++lane) {
        cost_[way][lane] = std::numeric_limits<float>::infinity();
        best_[way][lane] = kNoCorner;
      }
    }
  }

  // Squares of cells around the corner's own, until nothing nearer can come.
  std::array<int, kWays> find() {
    const int col = cell_of(x_);
    const int row = cell_of(y_);
    for (int y = row - 1; y <= row + 1; ++y) scan_cells(y, col - 1, col + 1);
    const int rings = static_cast<int>(std::ceil(reach_ / kCell));
    for (int r = 2; r <= rings; ++r) {
      if (scanned_ > kMostScanned || farthest() < static_cast<float>(r - 1) * kCell) break;
      scan_cells(row - r, col - r, col + r);
      scan_cells(row + r, col - r, col + r);
      for (int y = row - r + 1; y < row + r; ++y) {
        scan_cells(y, col - r, col - r);
        scan_cells(y, col + r, col + r);
      }
    }
    std::array<int, kWays> nearest{};
    for (std::size_t way = 0; way < kWays; ++way) {
      const float* const cost = cost_[way];
      const auto lane = std::min_element(cost, cost + kLongestVector) - cost;
      const int other = best_[way][lane];
      nearest[way] = other == kNoCorner ? kNoCorner : cells_.index[other];
    }
    return nearest;
  }

 private:
  using D = hn::CappedTag<float, kLongestVector>;
  using Integers = hn::RebindToSigned<D>;

  void scan_cells(int row, int first, int last) {
    if (row < 0 || row >= cells_.down) return;
    first = std::max(first, 0);
    last = std::min(last, cells_.across - 1);
    if (first > last) return;
    const int* const begin = cells_.begin + row * cells_.across;
    const int end = begin[last + 1];
    scanned_ += end - begin[first];
    const auto lanes = static_cast<int>(hn::Lanes(D()));
    for (int i = begin[first]; i < end; i += lanes) scan(i, end);
  }

  // The corners from `i` on, as many as a vector has lanes.
  void scan(int i, int end) {
    const D d;
    const auto set = [&](float v) { return hn::Set(d, v); };
    const auto at = [&](const float* of) { return hn::LoadU(d, of + i); };
    const auto sx = hn::Sub(at(cells_.x), set(x_));
    const auto sy = hn::Sub(at(cells_.y), set(y_));
    const auto square = hn::MulAdd(sx, sx, hn::Mul(sy, sy));
    const auto contrast = at(cells_.contrast);
    const auto like = hn::And(hn::And(hn::Ge(hn::Mul(contrast, set(kContrast)), set(contrast_)),
                                      hn::Le(contrast, set(kContrast * contrast_))),
                              hn::FirstN(d, static_cast<std::size_t>(end - i)));
    for (int line = 0; line < 2; ++line) {
      const auto ex = set(edges_[line][0]);
      const auto ey = set(edges_[line][1]);
      const auto on = hn::MulAdd(sx, ex, hn::Mul(sy, ey));
      const auto along = hn::Abs(on);
      const auto off = hn::Abs(hn::Sub(hn::Mul(sx, ey), hn::Mul(sy, ex)));
      auto good = hn::And(hn::And(like, hn::Le(off, hn::Mul(along, set(kCone)))),
                          hn::And(hn::Ge(along, set(kLeastStep)), hn::Le(along, set(reach_))));
      if (hn::AllFalse(d, good)) continue;
      if (parallel_) good = hn::And(good, is_parallel(i, line));
      // The edge that arrives there is the other one.
      const auto to_x = at(line == 0 ? cells_.falling_x : cells_.rising_x);
      const auto to_y = at(line == 0 ? cells_.falling_y : cells_.rising_y);
      const auto across = hn::Sub(hn::Mul(to_x, sy), hn::Mul(to_y, sx));
      good = hn::And(good, hn::Le(hn::Mul(across, across), hn::Mul(set(kTurn * kTurn), square)));
      const auto cost = hn::MulAdd(off, set(kOffEdge), along);
      const auto against = hn::Lt(on, hn::Zero(d));
      take(hn::AndNot(against, good), cost, i, 2 * line);
      take(hn::And(against, good), cost, i, 2 * line + 1);
    }
  }

  // Whether the edge that crosses an edge of ours is parallel to the one that crosses it there.
  [[nodiscard]] hn::Mask<D> is_parallel(int i, int line) const {
    constexpr float kMostTurn = 0.5F;  // sine of the angle between them
    const D d;
    const auto to_x = hn::LoadU(d, (line == 0 ? cells_.rising_x : cells_.falling_x) + i);
    const auto to_y = hn::LoadU(d, (line == 0 ? cells_.rising_y : cells_.falling_y) + i);
    const auto across = hn::Sub(hn::Mul(hn::Set(d, edges_[1 - line][0]), to_y),
                                hn::Mul(hn::Set(d, edges_[1 - line][1]), to_x));
    return hn::Le(hn::Abs(across), hn::Set(d, kMostTurn));
  }

  template <typename Mask, typename V>
  void take(Mask good, V cost, int i, int way) {
    const D d;
    const Integers integers;
    const auto before = hn::Load(d, cost_[way]);
    const auto better = hn::And(good, hn::Lt(cost, before));
    hn::Store(hn::IfThenElse(better, cost, before), d, cost_[way]);
    hn::Store(hn::IfThenElse(hn::RebindMask(integers, better), hn::Iota(integers, i),
                             hn::Load(integers, best_[way])),
              integers, best_[way]);
  }

  // A corner further off than this is no neighbour: a nearer one was found, or it skips corners.
  [[nodiscard]] float farthest() const {
    float least[kWays];
    for (int way = 0; way < kWays; ++way) {
      least[way] = *std::min_element(cost_[way], cost_[way] + kLongestVector);
    }
    float most = 0;
    for (int way = 0; way < kWays; ++way) {
      most = std::max(most, std::min(least[way], longest_link_ * least[way ^ 1]));
    }
    return most;
  }

  const CornerCells& cells_;
  float x_;
  float y_;
  float edges_[2][2];
  float contrast_;
  float reach_;
  bool parallel_;
  float longest_link_;
  int scanned_ = 0;
  alignas(64) float cost_[kWays][kLongestVector];
  alignas(64) int best_[kWays][kLongestVector];  // in the order of the cells
};

void find_nearest(const CornerCells& cells, const NeighbourRules& rules,
                  std::array<int, kWays>* nearest) {
  for (int i = 0; i < cells.count; ++i) {
    nearest[cells.index[i]] = Nearest(cells, i, rules).find();
  }
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace calvin::detect {

HWY_EXPORT(find_nearest);

CornerCells NeighbourSearch::sort_into_cells(std::span<const Corner> corners, ImageSize size) {
  CornerCells cells;
  cells.across = cell_of(static_cast<float>(size.width)) + 1;
  cells.down = cell_of(static_cast<float>(size.height)) + 1;
  cells.count = static_cast<int>(corners.size());
  const auto cell = [&](const Corner& c) {
    return static_cast<std::size_t>(cell_of(c.y) * cells.across + cell_of(c.x));
  };
  begin_.assign(static_cast<std::size_t>(cells.across * cells.down) + 1, 0);
  for (const Corner& c : corners) ++begin_[cell(c) + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  index_.resize(corners.size());
  // The last vector may read beyond the last corner.
  const std::size_t pitch = corners.size() + kLongestVector;
  constexpr std::size_t kNumbers = 7;
  numbers_.resize(kNumbers * pitch);
  float* column[kNumbers];
  for (std::size_t k = 0; k < kNumbers; ++k) column[k] = numbers_.data() + k * pitch;
  // Each begin moves to the cell's end, which is where the next one begins.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Corner& c = corners[i];
    const auto at = static_cast<std::size_t>(begin_[cell(c)]++);
    index_[at] = static_cast<int>(i);
    const float numbers[kNumbers] = {c.x,         c.y,         c.rising.x, c.rising.y,
                                     c.falling.x, c.falling.y, c.contrast};
    for (std::size_t k = 0; k < kNumbers; ++k) column[k][at] = numbers[k];
  }
  for (std::size_t i = begin_.size() - 1; i > 0; --i) begin_[i] = begin_[i - 1];
  begin_[0] = 0;
  cells.begin = begin_.data();
  cells.index = index_.data();
  cells.x = column[0];
  cells.y = column[1];
  cells.rising_x = column[2];
  cells.rising_y = column[3];
  cells.falling_x = column[4];
  cells.falling_y = column[5];
  cells.contrast = column[6];
  return cells;
}

void NeighbourSearch::run(std::span<const Corner> corners, ImageSize size,
                          const NeighbourRules& rules,
                          std::vector<std::array<int, kWays>>& nearest) {
  nearest.resize(corners.size());
  HWY_DYNAMIC_DISPATCH(find_nearest)
  (sort_into_cells(corners, size), rules, nearest.data());
}

}  // namespace calvin::detect

#endif  // HWY_ONCE
