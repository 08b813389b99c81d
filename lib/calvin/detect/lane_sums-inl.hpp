// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The sums over the lanes of many vectors: four vectors are folded into one, which takes half the
// work of summing each. Included once for each of Highway's targets.
#if defined(CALVIN_DETECT_LANE_SUMS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_DETECT_LANE_SUMS_INL
#undef CALVIN_DETECT_LANE_SUMS_INL
#else
#define CALVIN_DETECT_LANE_SUMS_INL
#endif

#include <cstddef>
#include <cstdint>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace calvin::detect::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
// Those of four vectors of floats.
template <class D, class V>
HWY_INLINE void sums_of_four(D d, const V* v, float* out) {
  const hn::RepartitionToWide<hn::RebindToUnsigned<D>> pairs;
  const hn::CappedTag<float, 4> block;
  // In each block of four lanes: what is in two of them of one vector, and of the next.
  const V low = hn::Add(hn::InterleaveLower(d, v[0], v[1]), hn::InterleaveUpper(d, v[0], v[1]));
  const V high = hn::Add(hn::InterleaveLower(d, v[2], v[3]), hn::InterleaveUpper(d, v[2], v[3]));
  const auto a = hn::BitCast(pairs, low);
  const auto b = hn::BitCast(pairs, high);
  const V folded = hn::Add(hn::BitCast(d, hn::InterleaveLower(pairs, a, b)),
                           hn::BitCast(d, hn::InterleaveUpper(pairs, a, b)));
  HWY_ALIGN float lanes[hn::MaxLanes(d)];
  hn::Store(folded, d, lanes);
  auto sum = hn::Load(block, lanes);
  for (std::size_t k = 4; k < hn::Lanes(d); k += 4) sum = hn::Add(sum, hn::Load(block, lanes + k));
  hn::StoreU(sum, block, out);
}
#endif

// Those of `count` vectors of floats.
template <class D, class V>
HWY_INLINE void sums_of_lanes(D d, const V* v, int count, float* out) {
  int i = 0;
#if HWY_TARGET != HWY_SCALAR
  for (; i + 4 <= count; i += 4) sums_of_four(d, v + i, out + i);
#endif
  for (; i < count; ++i) out[i] = hn::GetLane(hn::SumOfLanes(d, v[i]));
}

}  // namespace calvin::detect::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CALVIN_DETECT_LANE_SUMS_INL
