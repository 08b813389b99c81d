// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Observation: what was seen of one board in one frame.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"

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

// Another way to name the control points of a board, as good as the one that was given. The labels
// of a grid are turned about z by quarter turns, in the sense of the board frame (x towards y),
// then shifted by columns and rows. All zero: the labels stay as they are.
struct Relabelling {
  int quarter_turns = 0;  // 0..3
  int cols = 0;
  int rows = 0;

  friend bool operator==(const Relabelling&, const Relabelling&) = default;
};

// "rotate180", "shift(2,0)", or both as in "rotate90 shift(0,-1)"; empty where nothing changes.
[[nodiscard]] CALVIN_API std::string to_text(const Relabelling& relabelling);

// What to_text() printed; absent for any other text.
[[nodiscard]] CALVIN_API std::optional<Relabelling> parse_relabelling(std::string_view text);

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
  // px/s, how fast each point moved in the image, one frame's time taken for another's; empty: not
  // known. What a camera that reads row after row shows of a moving board is mended by it.
  std::vector<Pixel> velocity;

  // The labellings that are as good as the given one: empty where the board tells its own
  // orientation.
  std::vector<Relabelling> ambiguous;

  double blur = 0;  // px, 1 sigma of the board's edges in this frame; 0: not known

  std::shared_ptr<const CornerPatches> patches;  // absent where nobody kept them

  [[nodiscard]] bool found() const noexcept { return !ids.empty(); }
};

}  // namespace calvin
