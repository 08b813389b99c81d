// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The loops over the pixels of lines, circles and boxes. Private to draw/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calvin/draw/overlay_tile.hpp"

namespace calvin {

// A tile while it is painted: what shapes show in planes of B G R A, premultiplied, and one of how
// dark it is under them, 0..255. Most of a tile stays empty: it is known which blocks of a row are
// not.
class TilePlanes {
 public:
  static constexpr int kBlock = 16;  // pixels
  static constexpr std::size_t kDark = 4;
  static constexpr std::size_t kPlanes = 5;

  // A transparent tile of so many px. What was painted before was merged.
  void begin(int width, int height);
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] int blocks() const noexcept { return blocks_; }  // of a row

  // A block in each of the planes.
  [[nodiscard]] std::array<std::uint8_t*, kPlanes> block(int number, int y) noexcept {
    const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_);
    std::uint8_t* first =
        bytes_.data() + (row + static_cast<std::size_t>(number)) * kPlanes * kBlock;
    return {first, first + kBlock, first + 2 * kBlock, first + 3 * kBlock, first + 4 * kBlock};
  }
  // Whole blocks, but for the end of a row, in which something was painted since begin(); forgets
  // that it was.
  void take_painted(std::vector<TileSpan>& spans);
  // Whether something was painted in it since begin().
  [[nodiscard]] std::uint8_t& is_painted(int number, int y) noexcept {
    return painted_[static_cast<std::size_t>(y) * static_cast<std::size_t>(blocks_) +
                    static_cast<std::size_t>(number)];
  }

 private:
  int width_ = 0;
  int height_ = 0;
  int blocks_ = 0;
  std::vector<std::uint8_t> bytes_;  // 0 where nothing is painted
  std::vector<std::uint8_t> painted_;
};

// B G R A of 0..255, not premultiplied.
struct Ink {
  std::array<std::uint8_t, 4> bgra{};
};

// All points of a tile that are `half` px or less from a segment, or from the circle of `radius`
// about its start where its length is 0. Px of the tile, the centre of its first pixel at (0, 0).
struct Stroke {
  float x = 0;
  float y = 0;
  float along_x = 0;  // the direction, of length 1 or 0
  float along_y = 0;
  float length = 0;
  float radius = 0;
  float half = 0;
  float halo = 0;  // px of dark around them
};

// Px of the tile between its edges.
struct InkedBox {
  float left = 0;
  float top = 0;
  float right = 0;
  float bottom = 0;
};

// The share of a pixel that is covered is taken from the distance of its centre.
void paint_stroke(const Stroke& stroke, const Ink& ink, TilePlanes& planes) noexcept;
void paint_box(const InkedBox& box, const Ink& ink, TilePlanes& planes) noexcept;

// The shapes over the dark as 32-bit ARGB, premultiplied, span after span as take_painted() has
// them; leaves the planes empty.
void merge_planes(TilePlanes& planes, std::span<const TileSpan> spans, std::uint8_t* argb) noexcept;

}  // namespace calvin
