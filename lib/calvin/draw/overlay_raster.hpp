// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shapes of the overlay as tiles. Private to draw/.
#pragma once

#include <memory>
#include <vector>

#include "calvin/draw/overlay_shapes.hpp"
#include "calvin/draw/stroke_kernels.hpp"

namespace calvin {

// For the frames of a video: what is as it was in the last one is not drawn again.
class OverlayRaster {
 public:
  OverlayRaster();
  ~OverlayRaster();
  OverlayRaster(const OverlayRaster&) = delete;
  OverlayRaster& operator=(const OverlayRaster&) = delete;

  // Tiles of the cells that shapes touch: neighbours in a row are one tile, cut to the shapes'
  // extent. Later shapes lie over earlier ones, every halo under every shape.
  void draw(ImageSize frame, const std::vector<Shape>& shapes);
  [[nodiscard]] const std::vector<OverlayTile>& tiles() const noexcept { return tiles_; }

 private:
  OverlayTile painted(const OverlayBox& box, const std::vector<Shape>& shapes);

  std::unique_ptr<class OverlayCells> cells_;
  TilePlanes planes_;
  std::vector<OverlayTile> tiles_;
  std::vector<std::vector<Shape>> painted_;  // what each of them shows
};

}  // namespace calvin
