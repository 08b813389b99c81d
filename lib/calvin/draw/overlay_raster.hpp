// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The shapes of the overlay as tiles. Private to draw/.
#pragma once

#include <memory>
#include <vector>

#include "calvin/draw/overlay_shapes.hpp"
#include "calvin/draw/overlay_tile.hpp"
#include "calvin/draw/raster/stroke_kernels.hpp"

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
  struct Painted {
    OverlayTile tile;
    std::vector<Shape> shapes;
  };

  // A tile of the shapes `within_`: that of the last frame, if it had the same; none where no pixel
  // is touched.
  void add_tile(const OverlayBox& box);
  void paint_tile(const OverlayBox& box);
  // What is left of the last frame.
  void keep_spare();

  std::unique_ptr<class OverlayCells> cells_;
  TilePlanes planes_;
  std::vector<OverlayTile> tiles_;
  std::vector<std::vector<Shape>> shapes_;  // what each of them shows
  // Those of the last frame, but for what is in this one as well.
  std::vector<OverlayTile> before_;
  std::vector<std::vector<Shape>> shapes_before_;
  std::vector<Painted> spare_;  // for the room that they take: a board moves in each frame
  // While one tile is made.
  std::vector<std::size_t> numbers_;
  std::vector<Shape> within_;
};

}  // namespace calvin
