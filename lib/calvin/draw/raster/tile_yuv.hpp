// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tiles of an overlay for video that is not RGB. Private to draw/ and the elements.
#pragma once

#include <cstdint>
#include <vector>

#include "calvin/draw/overlay_tile.hpp"

namespace calvin {

// A Y U V in memory, 8 bits each, not premultiplied, limited range by BT.709. libgstvideo makes the
// same of a tile, every transparent pixel included, which takes longer than blending it.
[[nodiscard]] std::vector<std::uint8_t> ayuv_of(const OverlayTile& tile);

}  // namespace calvin
