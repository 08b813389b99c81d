// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where the discs of a sheet will be in the next frame of a video.
#pragma once

#include <cstdint>
#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/detect/circles/disc_lattice.hpp"

namespace calvin::detect {

// Follows the discs of a sheet, each at its own speed. Keeps its memory.
class DiscTracker {
 public:
  // Takes the discs as they lay in an image at `timestamp` ns (or kNoTimestamp).
  void remember(const DiscLattice& discs, ImageSize size, std::uint64_t timestamp);

  // Absent for an image of another size, and where frames are too far apart.
  [[nodiscard]] std::optional<DiscLattice> predict(ImageSize size, std::uint64_t timestamp) const;

 private:
  DiscLattice last_{0};
  DiscLattice before_{0};
  ImageSize size_;
  std::uint64_t last_time_ = kNoTimestamp;
  std::uint64_t before_time_ = kNoTimestamp;
};

}  // namespace calvin::detect
