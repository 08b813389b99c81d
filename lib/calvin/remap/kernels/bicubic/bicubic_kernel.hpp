// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Bicubic and Lanczos resampling of runs.
#pragma once

#include <cstdint>

#include "calvin/remap/kernels/common/pixel_layout.hpp"
#include "calvin/remap/kernels/common/run_row.hpp"
#include "calvin/remap/kernels/common/source_bounds.hpp"

namespace calvin::remap {

// How a pixel lies in memory, whose components lie within 32 bits, and how many taps its filter
// has.
struct BicubicFormat {
  int taps = 4;  // along each axis; 4: bicubic, 6: Lanczos
  int components = 1;
  int component_bits = 8;  // from a component to the next
  int pixel_step = 1;      // bytes from a pixel to the next
  bool words = false;      // 16-bit samples
  WordFormat word;
  float largest = 255;  // value
  int spare = 3;        // columns at the right end whose 32 bits may reach beyond the row
};

// Resamples the `row.count` runs of eight samples except slow ones. Runs that reach beyond the
// source are marked as slow and not written. `output` is where the first sample of the chunk goes.
void blend_bicubic_runs(const BicubicFormat& format, const SourceBounds& bounds, RunRow& row,
                        const std::uint8_t* source, std::uint8_t* output) noexcept;

}  // namespace calvin::remap
