// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Numbers for tiles, and their spans put where they belong.

#include "calvin/draw/overlay_tile.hpp"

#include <algorithm>
#include <atomic>

namespace calvin {

std::uint64_t next_tile_serial() noexcept {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

OverlayTile whole_tile(const OverlayTile& tile) {
  if (tile.spans.empty()) return tile;
  OverlayTile whole{tile.x, tile.y, tile.width, tile.height, {}, {}, tile.serial};
  const auto width = static_cast<std::size_t>(tile.width);
  whole.pixels.resize(4 * width * static_cast<std::size_t>(tile.height));
  for (const TileSpan& span : tile.spans) {
    const std::size_t to =
        static_cast<std::size_t>(span.row) * width + static_cast<std::size_t>(span.first);
    std::copy_n(tile.pixels.data() + 4 * span.at, 4 * span.count, whole.pixels.data() + 4 * to);
  }
  return whole;
}

}  // namespace calvin
