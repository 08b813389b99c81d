// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What an image shows around the corners that were found in it.
#pragma once

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// As large as the fit of a corner needs, which goes with the squares in the image. A patch at the
// border of the image lies within it. None where the image is smaller than one.
[[nodiscard]] std::shared_ptr<const CornerPatches> cut_patches(const ImageView& image,
                                                               const Observation& observation,
                                                               const Board& board);

// The pixels of one of them.
[[nodiscard]] ImageView patch_view(const CornerPatches& patches, std::size_t corner);

}  // namespace calvin
