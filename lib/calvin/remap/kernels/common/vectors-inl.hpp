// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The vector types of the bilinear and gather kernels: as many lanes, of 128 bits each, as the
// machine has. Compiled once per target of Highway: include it after hwy/foreach_target.h.
#if defined(CALVIN_REMAP_VECTORS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_REMAP_VECTORS_INL_HPP
#undef CALVIN_REMAP_VECTORS_INL_HPP
#else
#define CALVIN_REMAP_VECTORS_INL_HPP
#endif

#include <cstddef>
#include <cstdint>

#include "calvin/core/vector_targets.hpp"
// After vector_targets.hpp.
#include <hwy/highway.h>

#if HWY_HAVE_SCALABLE
#error "Include calvin/core/vector_targets.hpp before the headers of Highway."
#endif

#if HWY_TARGET != HWY_SCALAR

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBytes = HWY_LANES(std::uint8_t);  // of a vector
constexpr int kLanes = kBytes / 16;                      // of a vector

using Bytes = hn::FixedTag<std::uint8_t, kBytes>;
using Words = hn::FixedTag<std::uint16_t, kBytes / 2>;
using Signed = hn::FixedTag<std::int16_t, kBytes / 2>;
using Ints = hn::FixedTag<std::int32_t, kBytes / 4>;
using Floats = hn::FixedTag<float, kBytes / 4>;
using Pairs = hn::Vec<Bytes>;
using Numbers = hn::Vec<Signed>;

// Prefetches a cache line of the source that is read some rows later: into the second cache, since
// the nearest one is full of what the rows of a band share.
HWY_INLINE void fetch_ahead(const std::uint8_t* line) {
#if HWY_COMPILER_GCC || HWY_COMPILER_CLANG
  __builtin_prefetch(line, 0, 2);
#else
  hwy::Prefetch(line);
#endif
}

// The distance from the middle of a run to its ends, in halves of a sample.
constexpr int reach(int pixels) { return pixels - 1; }

// Whether one instruction permutes all bytes of a vector: then the samples of a run need not lie
// within 16 bytes.
constexpr bool kMovesAllBytes = HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3_DL;

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
#endif
