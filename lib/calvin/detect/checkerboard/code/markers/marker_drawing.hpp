// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A marker as blur lets it be seen: how much of each pixel has another colour than the square
// that it is in.
#pragma once

#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/code/lattice_square.hpp"

namespace calvin::detect {

// The cells of a marker in a square, in rows; those that have the square's own colour are ground.
struct MarkerCells {
  int side = 0;    // of the marker, in cells
  float cell = 0;  // side of a cell, in parts of the square's
  std::vector<bool> is_ground;
};

// A part of an image. Keeps its memory.
class MarkerDrawing {
 public:
  // Draws what an image of a size sees of a marker; edges have a blur of `width` px, 1 sigma, that
  // of pixels included.
  void draw(ImageSize image, const LatticeSquare& square, const MarkerCells& cells, float width);

  // The part's place in the image, whole px.
  [[nodiscard]] int left() const { return left_; }
  [[nodiscard]] int top() const { return top_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  // Of a row of the part: the share of each pixel, 0..1.
  [[nodiscard]] const float* row(int y) const { return shares_.data() + y * width_; }

 private:
  void take_part(ImageSize image, const LatticeSquare& square, float reach);
  void draw_cell(const LatticeSquare& square, float s, float t, float cell);
  void blur(float sigma);
  void blur_rows();
  void blur_columns();

  int left_ = 0;
  int top_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<float> shares_;
  std::vector<float> kernel_;
  std::vector<float> line_;
  std::vector<float> blurred_;
};

}  // namespace calvin::detect
