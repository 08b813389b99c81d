// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tiles of an overlay in the bytes of a video format: a tile that stays is converted once, and
// blended onto every frame on which it is seen. Private to draw/ and the elements.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/draw/overlay_tile.hpp"

namespace calvin {

// Where the 8-bit samples of one component are: that of pixel (x, y) is in row y >> y_shift of the
// plane, at byte offset + step * (x >> x_shift). It is the sample of the first of the pixels that
// share it.
struct SampleLayout {
  int plane = 0;
  int offset = 0;
  int step = 1;
  int x_shift = 0;
  int y_shift = 0;

  [[nodiscard]] bool operator==(const SampleLayout&) const = default;
};

// R G B, or Y U V in limited range by BT.709, or Y alone. Bytes of a plane that no component has
// stay as they are; there is no alpha.
struct PixelLayout {
  std::array<SampleLayout, 3> components{};
  int count = 3;  // of the components
  bool is_rgb = false;
  ImageSize size;  // px, of the frame

  [[nodiscard]] bool operator==(const PixelLayout&) const = default;
};

struct FramePlanes {
  std::array<std::uint8_t*, 3> data{};
  std::array<std::ptrdiff_t, 3> stride{};  // bytes
};

// A tile at a place of a frame. A byte of the frame becomes add + keep / 255 * itself.
struct TileStamp {
  // `count` bytes in a row of a plane, whose `add` and `keep` begin at `first`.
  struct Run {
    int plane = 0;
    int row = 0;
    int byte = 0;  // the first one in the row
    int count = 0;
    std::size_t first = 0;
  };
  std::vector<Run> runs;
  std::vector<std::uint8_t> add;
  std::vector<std::uint8_t> keep;
};

// Of the tile with its top left pixel at (left, top), where it may be partly or wholly outside the
// frame.
[[nodiscard]] TileStamp stamp_of(const OverlayTile& tile, int left, int top,
                                 const PixelLayout& layout);

// The stamps of a video's tiles, kept from the second frame on that shows them: what follows a
// board is seen on one alone. One thread at a time.
class TileStamps {
 public:
  // Before each frame: forgets what the last one did not show.
  void begin_frame(const PixelLayout& layout);
  // A tile as stamp_of() has it onto a frame of the layout.
  void blend(const OverlayTile& tile, int left, int top, const FramePlanes& frame);

 private:
  struct Entry {
    int left = 0;
    int top = 0;
    bool shown = false;
    std::optional<TileStamp> stamp;
  };

  PixelLayout layout_;
  std::unordered_map<std::uint64_t, Entry> entries_;  // by the serial of the tile
  TileStamp row_;                                     // of a tile that is not kept
};

}  // namespace calvin
