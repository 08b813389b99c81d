// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The source coordinates of the middles of runs at one row of the map's nodes, for every
// instruction set.

#include "calvin/remap/map/run_middles.hpp"
#include "calvin/core/vector_targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/map/run_middles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Interpolates between four nodes; node(0) to node(3) give them for a vector of runs.
template <class D, class N>
HWY_INLINE void expand_between(D d, const RunColumns& runs, int run, const NodeLine& line, N node,
                               float* to) {
  const auto part = [&](int c) HWY_ATTR { return hn::LoadU(d, runs.weights[c] + run); };
  // Differences to the second node are small: coordinates far from the origin keep their last bits.
  const auto second = node(1);
  const auto between =
      second + hn::MulAdd(part(0), node(0) - second,
                          hn::MulAdd(part(1), node(2) - second, part(2) * (node(3) - second)));
  hn::StoreU(between * hn::Set(d, line.scale) - hn::Set(d, line.offset), d, to);
}

// Expands a vector of runs, or a single run.
template <class D>
HWY_INLINE void expand_at(D d, const RunColumns& runs, int run, const NodeLine& line, float* to) {
  const hn::RebindToSigned<D> ints;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(D()));
  const std::int32_t* columns = runs.column + run;
  const std::int32_t first = columns[0];
  const auto column = hn::LoadU(ints, columns);
  // Where one vector holds all nodes, a permutation of it is quicker than gathering them.
  if (columns[kVector - 1] - first + 4 <= kVector && first + kVector <= line.count) {
    const auto nodes = hn::LoadU(d, line.nodes + first);
    const auto node = [&](int c) HWY_ATTR {
      const auto which = column - hn::Set(ints, first - c);
      return hn::TableLookupLanes(nodes, hn::IndicesFromVec(d, which));
    };
    expand_between(d, runs, run, line, node, to);
  } else {
    const auto node = [&](int c) HWY_ATTR { return hn::GatherIndex(d, line.nodes + c, column); };
    expand_between(d, runs, run, line, node, to);
  }
}

void expand_row(const RunColumns& runs, int first, int count, const NodeLine& line, float* to) {
  const hn::CappedTag<float, 16> vector;
  const hn::CappedTag<float, 1> single;
  constexpr int kVector = static_cast<int>(hn::MaxLanes(vector));
  int j = 0;
  for (; j + kVector <= count; j += kVector) expand_at(vector, runs, first + j, line, to + j);
  for (; j < count; ++j) expand_at(single, runs, first + j, line, to + j);
}

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(expand_row);

void expand_runs(const RunColumns& runs, int first, int count, const NodeLine& line,
                 float* to) noexcept {
  HWY_DYNAMIC_DISPATCH(expand_row)(runs, first, count, line, to);
}

}  // namespace calvin::remap
#endif
