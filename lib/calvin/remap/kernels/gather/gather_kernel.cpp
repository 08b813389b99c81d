// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bilinear resampling of runs that the bilinear kernels do not take, for every instruction set:
// along lines of any slope, and across the borders of the source. Each pixel is gathered from its
// own address, together with its right neighbour. A vector has one pixel of each of as many runs as
// it has 32-bit numbers, so that it can take the numbers of runs as they are.

#include "calvin/remap/kernels/gather/gather_kernel.hpp"
#include "calvin/core/vector_targets.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "calvin/remap/kernels/gather/gather_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#include "calvin/remap/kernels/gather/transpose-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::remap::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR

bool gather_of_layout(PixelLayout /*layout*/, const GatherTask& /*task*/,
                      const std::int32_t* /*runs*/, int count, const std::uint8_t* /*source*/,
                      std::uint8_t* /*output*/, bool* left) {
  std::fill_n(left, count, true);
  return true;
}

#else

// ---- Source coordinates.

using Middles = std::array<hn::Vec<Ints>, 2 * kMargin + 1>;

// The middles of a vector of runs and of two neighbours on either side; `in_turn`: the runs are
// consecutive.
HWY_INLINE Middles middles_of(const std::int32_t* middles, const std::int32_t* runs, bool in_turn) {
  const Ints d;
  const auto which = hn::Load(d, runs);
  Middles result;
  for (std::size_t k = 0; k < result.size(); ++k) {
    result[k] =
        in_turn ? hn::LoadU(d, middles + runs[0] + k) : hn::GatherIndex(d, middles + k, which);
  }
  return result;
}

// Parabolas as RunParabola, one per run, counted from `base`, the whole sample before the run's
// middle: single precision suffices near the source. The ends of the axis are counted likewise.
struct Curves {
  hn::Vec<Ints> base;
  hn::Vec<Floats> rest;
  hn::Vec<Floats> slope;
  hn::Vec<Floats> bend;
  hn::Vec<Floats> low;  // as AxisEnds
  hn::Vec<Floats> high;
  hn::Vec<Floats> first;
  hn::Vec<Floats> last;
};

HWY_INLINE Curves curves_at(const Middles& middles, const AxisEnds& ends) {
  constexpr float kUnit = 1.0F / (1 << kCoordBits);
  const Ints d;
  const Floats floats;
  const auto middle = middles[kMargin];
  const auto before = middle - middles[kMargin - 1];
  const auto after = middles[kMargin + 1] - middle;
  const auto across = hn::ConvertTo(floats, before + after);
  const auto third = hn::ConvertTo(floats, middles[4] - middles[0]) - across - across;
  const auto part = hn::And(middle, hn::Set(d, (1 << kCoordBits) - 1));
  const auto base = hn::ShiftRight<kCoordBits>(middle);
  const auto from_base = [&](float coord) HWY_ATTR {
    return hn::Set(floats, coord) - hn::ConvertTo(floats, base);
  };
  return {base,
          hn::ConvertTo(floats, part) * hn::Set(floats, kUnit),
          hn::NegMulAdd(third, hn::Set(floats, kThirdPart / 256.0F), across) *
              hn::Set(floats, kUnit / (2 * kPixels)),
          hn::ConvertTo(floats, after - before) * hn::Set(floats, kUnit / (2 * kPixels * kPixels)),
          from_base(ends.low),
          from_base(ends.high),
          from_base(ends.first),
          from_base(static_cast<float>(ends.last))};
}

// Larger coordinates, in 1/2^14 of a sample, may have differences that do not fit into 32 bits.
constexpr std::int32_t kFarthest = 1 << 29;

// Which of the runs have such coordinates.
HWY_INLINE hn::Mask<Unsigned> too_far(const Middles& middles) {
  auto farthest = hn::Zero(Unsigned());
  for (const auto& middle : middles) {
    farthest = hn::Max(farthest, hn::BitCast(Unsigned(), hn::Abs(middle)));
  }
  const auto limit = hn::Set(Unsigned(), static_cast<std::uint32_t>(kFarthest));
  return hn::Ne(hn::Min(farthest, limit), farthest);
}

// Whether all pixels of all runs have neighbours, even without the last `spare` samples of the
// axis.
HWY_INLINE bool are_inside(const Curves& curves, float spare) {
  const Floats d;
  constexpr float kEnd = reach(kPixels) / 2.0F;
  constexpr float kRounding = 1.0F / 1024;
  const auto most =
      hn::MulAdd(hn::Set(d, kEnd), hn::Abs(curves.slope),
                 hn::MulAdd(hn::Set(d, kEnd * kEnd), hn::Abs(curves.bend), hn::Set(d, kRounding)));
  const auto below = hn::Lt(curves.rest - most, curves.first);
  const auto above = hn::Gt(curves.rest + most, curves.last - hn::Set(d, spare));
  return hn::AllFalse(d, hn::Or(below, above));
}

// Source coordinates along one axis: a sample, and the weight of its right or lower neighbour,
// 0..1.
struct Coords {
  hn::Vec<Unsigned> whole;
  hn::Vec<Floats> rest;
};
HWY_INLINE Coords coords_of(const Curves& curves, hn::Vec<Floats> at, hn::Vec<Floats> down,
                            bool nearest) {
  const auto rest = at - down;
  return {hn::BitCast(Unsigned(), small_ints(down) + curves.base),
          nearest ? hn::Round(rest) : rest};
}

// ---- Runs.

// A vector of runs.
struct Block {
  alignas(64) std::int32_t runs[kRuns];
  alignas(64) std::int32_t ahead[2 * kRuns];  // offsets of the pixels that are prefetched
  Curves x;
  Curves y;
  bool in_turn;                // the runs are consecutive
  bool inside;                 // are_inside(), along both axes
  hn::Mask<Unsigned> unclear;  // runs that this kernel cannot take
};

// Pixels of each run that are prefetched while the block before is blended.
template <class M>
constexpr int kAhead = M::kStep > 2 ? 2 : 1;

// Finds the pixels to prefetch: in the middle of each run, or in the middles of its halves.
template <class M>
HWY_INLINE void look_ahead(const SourcePlane& source_plane, const GatherTask& task, Block& block) {
  const Ints d;
  for (int i = 0; i < kAhead<M>; ++i) {
    const auto t = hn::Set(Floats(), kAhead<M> == 1 ? 0.0F : static_cast<float>(4 * i - 2));
    const auto whole = [&](const Curves& c) HWY_ATTR {
      return c.base + small_ints(hn::MulAdd(t, hn::MulAdd(t, c.bend, c.slope), c.rest));
    };
    const auto offset =
        whole(block.y) * hn::Set(d, task.stride) + whole(block.x) * hn::Set(d, M::kStep);
    const auto held = hn::Min(hn::BitCast(Unsigned(), offset), source_plane.last_offset);
    hn::Store(hn::BitCast(d, held), d, block.ahead + i * kRuns);
  }
}

// Fills in a block with the first of `count` runs.
template <class M>
HWY_INLINE void prepare(const SourcePlane& source_plane, const GatherTask& task,
                        const std::int32_t* runs, int count, Block& block) {
  const Ints d;
  block.in_turn = false;
  if (count >= kRuns) {
    hn::Store(hn::LoadU(d, runs), d, block.runs);
    block.in_turn = runs[kRuns - 1] - runs[0] == kRuns - 1;
  } else {
    for (int r = 0; r < kRuns; ++r) block.runs[r] = runs[std::min(r, count - 1)];
  }
  const Middles x = middles_of(task.row.x, block.runs, block.in_turn);
  const Middles y = middles_of(task.row.y, block.runs, block.in_turn);
  block.x = curves_at(x, task.x_ends);
  block.y = curves_at(y, task.y_ends);
  block.unclear = hn::Or(too_far(x), too_far(y));
  // In the last two rows a pixel may be read beyond the end of the plane.
  block.inside = are_inside(block.x, 1) && are_inside(block.y, 2);
  look_ahead<M>(source_plane, task, block);
}

template <class M>
HWY_INLINE hn::Vec<Unsigned> offset_of(const SourcePlane& source_plane, const Coords& x,
                                       const Coords& y) {
  const Unsigned d;
  return y.whole * hn::Set(d, static_cast<std::uint32_t>(source_plane.stride)) +
         x.whole * hn::Set(d, M::kStep);
}

// The pixels of a block, the first ones of all runs first, located before the first of them is
// loaded: that keeps the memory busy.
struct BlockPixels {
  static constexpr int kCount = kPixels * kRuns;
  alignas(64) std::int32_t offset[kCount];
  alignas(64) float right[kCount];  // the neighbours' weights
  alignas(64) float below[kCount];
  alignas(64) std::uint32_t shown[kCount];  // all bits where the source shows something, else none
};

HWY_INLINE void store_coords(hn::Vec<Unsigned> offset, const Coords& x, const Coords& y, int first,
                             BlockPixels& pixels) {
  hn::Store(hn::BitCast(Ints(), offset), Ints(), pixels.offset + first);
  hn::Store(x.rest, Floats(), pixels.right + first);
  hn::Store(y.rest, Floats(), pixels.below + first);
}

// Locates a vector of pixels, one of each run, where all runs are inside the source.
template <class M>
HWY_INLINE void locate_inside(const SourcePlane& source_plane, const GatherTask& task,
                              hn::Vec<Floats> x_at, hn::Vec<Floats> y_at, const Block& block,
                              int first, BlockPixels& pixels) {
  const Coords x = coords_of(block.x, x_at, hn::Floor(x_at), task.nearest);
  const Coords y = coords_of(block.y, y_at, hn::Floor(y_at), task.nearest);
  store_coords(offset_of<M>(source_plane, x, y), x, y, first, pixels);
}

// Locates a vector of pixels anywhere.
template <class M>
HWY_INLINE void locate_any(const SourcePlane& source_plane, const GatherTask& task,
                           hn::Vec<Floats> x_at, hn::Vec<Floats> y_at, Block& block, int first,
                           BlockPixels& pixels) {
  const Floats d;
  const auto note = [&](hn::Mask<Floats> noted) HWY_ATTR {
    block.unclear = hn::Or(block.unclear, hn::RebindMask(Unsigned(), noted));
  };
  const auto held = [&](const Curves& curves, hn::Vec<Floats> at, bool uneven) HWY_ATTR {
    const auto coord = hn::Min(hn::Max(at, curves.first), curves.last);
    const auto down = hn::Min(hn::Floor(coord), curves.last - hn::Set(d, 1));
    if (uneven) note(hn::Gt(at, curves.last));
    return coords_of(curves, coord, down, task.nearest);
  };
  const Coords x = held(block.x, x_at, task.x_ends.uneven);
  const Coords y = held(block.y, y_at, task.y_ends.uneven);
  const auto offset = offset_of<M>(source_plane, x, y);
  const auto read = hn::Min(offset, source_plane.last_offset);
  block.unclear = hn::Or(block.unclear, hn::Ne(offset, read));
  store_coords(read, x, y, first, pixels);
  const auto within = [&](const Curves& curves, hn::Vec<Floats> at) HWY_ATTR {
    return hn::And(hn::Ge(at, curves.low), hn::Le(at, curves.high));
  };
  const auto inside = hn::And(within(block.x, x_at), within(block.y, y_at));
  if (task.mirrors) note(hn::Not(inside));
  hn::Store(hn::VecFromMask(Unsigned(), hn::RebindMask(Unsigned(), inside)), Unsigned(),
            pixels.shown + first);
}

template <class M>
HWY_INLINE void locate_block(const SourcePlane& source_plane, const GatherTask& task, Block& block,
                             BlockPixels& pixels) {
  const Floats d;
  for (int i = 0; i < kPixels; ++i) {
    const auto t = hn::Set(d, static_cast<float>(2 * i - reach(kPixels)) / 2);
    const auto at = [&](const Curves& curves) HWY_ATTR {
      return hn::MulAdd(t, hn::MulAdd(t, curves.bend, curves.slope), curves.rest);
    };
    if (block.inside) {
      locate_inside<M>(source_plane, task, at(block.x), at(block.y), block, i * kRuns, pixels);
    } else {
      locate_any<M>(source_plane, task, at(block.x), at(block.y), block, i * kRuns, pixels);
    }
  }
}

// Blends all pixels of a block, and prefetches some of the next one's.
template <class M>
HWY_INLINE void blend_block(const SourcePlane& source_plane, const GatherTask& task, Block& block,
                            const Block& next, std::int32_t* to) {
  BlockPixels pixels;
  locate_block<M>(source_plane, task, block, pixels);
  const bool fills = task.fills && !block.inside;
  const auto fill = hn::Set(Unsigned(), task.fill);
  alignas(64) std::int32_t made[BlockPixels::kCount];
  for (int i = 0; i < kPixels; ++i) {
    const int first = i * kRuns;
    constexpr int kAll = kAhead<M> * kRuns;
    for (int a = i * kAll / kPixels; a < (i + 1) * kAll / kPixels; ++a) {
      hwy::Prefetch(source_plane.source + next.ahead[a]);
      hwy::Prefetch(source_plane.second_row + next.ahead[a]);
    }
    auto here = hn::BitCast(Unsigned(), M::pixels(source_plane, pixels.offset + first,
                                                  hn::Load(Floats(), pixels.right + first),
                                                  hn::Load(Floats(), pixels.below + first)));
    if (fills) {
      const auto shown = hn::Load(Unsigned(), pixels.shown + first);
      here = hn::Or(hn::And(shown, here), hn::AndNot(shown, fill));
    }
    hn::Store(hn::BitCast(Ints(), here), Ints(), made + first);
  }
  transpose_block<M>(made, to);
}

// Copies the first `count` runs of a block to the output.
template <class M>
HWY_INLINE void put_block(const std::int32_t* words, const Block& block, int count,
                          std::uint8_t* output) {
  constexpr std::ptrdiff_t kBytesOfRun = kPixels * M::kStep;
  if constexpr (M::kStep <= 2 && !M::kStrided) {
    if (block.in_turn) {
      std::memcpy(output + block.runs[0] * kBytesOfRun, words, kRuns * kBytesOfRun);
      return;
    }
  }
  for (int r = 0; r < count; ++r) put_run<M>(words, r, output + block.runs[r] * kBytesOfRun);
}

// Notes which of the first `count` runs of a block are left; returns whether there are any.
HWY_INLINE bool note_left(const Block& block, int count, bool* left) {
  if (HWY_LIKELY(hn::AllFalse(Unsigned(), block.unclear))) return false;
  alignas(64) std::uint32_t is_left[kRuns];
  hn::Store(hn::VecFromMask(Unsigned(), block.unclear), Unsigned(), is_left);
  for (int r = 0; r < count; ++r) left[r] = is_left[r] != 0;
  return true;
}

template <class M>
bool gather_runs_of(const GatherTask& task, const std::int32_t* runs, int count,
                    const std::uint8_t* source, std::uint8_t* output, bool* left) {
  const std::int32_t last = (task.y_ends.count - 2) * task.stride +
                            (task.x_ends.count - 1) * M::kStep + M::kOwn - M::kFetch;
  std::fill_n(left, count, last < 0);
  if (last < 0 || count == 0) return last < 0;
  const SourcePlane source_plane = {
      .source = source,
      .second_row = source + task.stride,
      .stride = task.stride,
      .last_offset = hn::Set(Unsigned(), static_cast<std::uint32_t>(last)),
      .blender = {},
      .format = task.format,
  };
  bool any = false;
  alignas(64) std::int32_t words[kPixels * kRuns];
  std::array<Block, 2> blocks;
  prepare<M>(source_plane, task, runs, count, blocks[0]);
  for (int begin = 0, turn = 0; begin < count; begin += kRuns, turn = 1 - turn) {
    const int here = std::min(kRuns, count - begin);
    Block& block = blocks[turn];
    Block& next = blocks[1 - turn];
    const int more = count - begin - here;
    if (more > 0) prepare<M>(source_plane, task, runs + begin + here, more, next);
    blend_block<M>(source_plane, task, block, more > 0 ? next : block, words);
    put_block<M>(words, block, here, output);
    any = note_left(block, here, left + begin) || any;
  }
  return any;
}

bool gather_of_layout(PixelLayout layout, const GatherTask& task, const std::int32_t* runs,
                      int count, const std::uint8_t* source, std::uint8_t* output, bool* left) {
  const auto of = [&](auto memory) {
    return gather_runs_of<decltype(memory)>(task, runs, count, source, output, left);
  };
  switch (layout) {
    case PixelLayout::kOne:
      return of(GatherBytes<1, 1>());
    case PixelLayout::kTwo:
      return of(GatherBytes<2, 1>());
    case PixelLayout::kThree:
      return of(GatherBytes<3, 1>());
    case PixelLayout::kFour:
      return of(GatherBytes<4, 1>());
    case PixelLayout::kOneStrided:
      return of(GatherBytes<1, 2>());
    case PixelLayout::kTwoStrided:
      return of(GatherBytes<2, 2>());
    case PixelLayout::kOneWord:
      return of(GatherWords<1>());
    case PixelLayout::kTwoWords:
      return of(GatherWords<2>());
    default:
      std::fill_n(left, count, true);
      return true;
  }
}

#endif

}  // namespace calvin::remap::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace calvin::remap {

HWY_EXPORT(gather_of_layout);

bool gather_runs(PixelLayout layout, const GatherTask& task, const std::int32_t* runs, int count,
                 const std::uint8_t* source, std::uint8_t* output, bool* left) noexcept {
  return HWY_DYNAMIC_DISPATCH(gather_of_layout)(layout, task, runs, count, source, output, left);
}

}  // namespace calvin::remap
#endif
