// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Arrays of numbers that vector code may load from. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace calvin {

// Arrays end on a multiple of this, so that the widest vectors need no remainder.
inline constexpr std::size_t kLanes = 8;

struct AlignedFree {
  void operator()(double* data) const { std::free(data); }
};
using AlignedArray = std::unique_ptr<double[], AlignedFree>;

// Not initialised, aligned to the widest vector.
[[nodiscard]] inline AlignedArray aligned_array(std::size_t count) {
  constexpr std::size_t kAlignment = 64;
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(double);
  void* data = std::aligned_alloc(kAlignment, (bytes + kAlignment - 1) / kAlignment * kAlignment);
  if (data == nullptr) throw std::bad_alloc();
  return AlignedArray(static_cast<double*>(data));
}

}  // namespace calvin
