// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pixels around the corners that were found in an image.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// Cuts patches as large as the fit of a corner needs, which depends on the size of the squares in
// the image. A patch at the border of the image lies within it. Null where the image is smaller
// than one patch.
[[nodiscard]] std::shared_ptr<const CornerPatches> cut_patches(const ImageView& image,
                                                               const Observation& observation,
                                                               const Board& board);

// The pixels of the patch of one corner.
[[nodiscard]] ImageView patch_view(const CornerPatches& patches, std::size_t corner);

}  // namespace calvin
