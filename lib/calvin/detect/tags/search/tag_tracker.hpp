// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the tags of a sheet will be in the next frame of a video.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/sheet/tag_sheet.hpp"

namespace calvin::detect {

// Follows the tags of a sheet, each corner at its own speed. Keeps its memory.
class TagTracker {
 public:
  // Takes the tags as they lay in an image at `timestamp` ns (or kNoTimestamp).
  void remember(std::span<const SheetTag> tags, ImageSize size, std::uint64_t timestamp);

  // Those that will be in the image with their middles; none for an image of another size, and
  // where frames are too far apart.
  [[nodiscard]] std::vector<PlacedQuad> predict(ImageSize size, std::uint64_t timestamp) const;

 private:
  std::vector<PlacedQuad> last_;
  std::vector<PlacedQuad> before_;
  ImageSize size_;
  std::uint64_t last_time_ = kNoTimestamp;
  std::uint64_t before_time_ = kNoTimestamp;
};

}  // namespace calvin::detect
