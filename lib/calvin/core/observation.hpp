// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Observation: what was seen of one board in one frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/relabelling.hpp"

namespace calvin {

inline constexpr std::uint64_t kNoTimestamp = std::numeric_limits<std::uint64_t>::max();

// What an image shows around each corner of an observation, so that they can be looked at again
// when the image is gone.
struct CornerPatches {
  int side = 0;                            // px
  std::vector<std::array<int, 2>> origin;  // the first pixel of each patch, in the image
  // side x side grey levels of each patch, row by row, one patch after the other.
  std::shared_ptr<const std::uint8_t[]> pixels;
};

// The control points of one board that were found in one frame. Structure of arrays: ids, uv and
// sigma have the same length. A board that was not found has none.
struct Observation {
  std::string camera;                      // a name; empty where there is one camera only
  std::string board;                       // the board text, e.g. "checkerboard:9x6:25mm"
  std::uint64_t timestamp = kNoTimestamp;  // ns, of the frame it was found on
  ImageSize image_size;                    // of the frame that `uv` refers to
  std::vector<int> ids;                    // index of the control point in Board::points()
  std::vector<Pixel> uv;                   // px
  std::vector<double> sigma;               // px, 1 sigma per coordinate of each point

  // The labellings that are as good as the given one: empty where the board tells its own
  // orientation.
  std::vector<Relabelling> ambiguous;

  double blur = 0;  // px, 1 sigma of the board's edges in this frame; 0: not known

  std::shared_ptr<const CornerPatches> patches;  // absent where nobody kept them

  [[nodiscard]] bool found() const noexcept { return !ids.empty(); }
};

}  // namespace calvin
