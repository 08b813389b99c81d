// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Spreads points of a marker's cells over the pixels around them, and blurs what that makes.

#include "calvin/detect/checkerboard/code/markers/marker_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace calvin::detect {

namespace {

constexpr float kBlurReach = 3.2F;  // of the blur, beyond which nothing of it is seen

void add(float share, const float* a, const float* b, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] += share * (a[i] + b[i]);
}

}  // namespace

void MarkerDrawing::draw(ImageSize image, const LatticeSquare& square, const MarkerCells& cells,
                         float width) {
  constexpr float kShared =
      1.0F / 6 - 1.0F / 48;       // px^2: the blur of points that pixels have shared
  constexpr float kLeast = 0.1F;  // px^2
  const float sigma = std::sqrt(std::max(width * width - kShared, kLeast));
  take_part(image, square, kBlurReach * sigma + 2);
  const float first = 0.5F * (1 - static_cast<float>(cells.side - 1) * cells.cell);
  for (int row = 0; row < cells.side; ++row) {
    for (int col = 0; col < cells.side; ++col) {
      if (cells.is_ground[static_cast<std::size_t>(row * cells.side + col)]) continue;
      draw_cell(square, first + cells.cell * static_cast<float>(col),
                first + cells.cell * static_cast<float>(row), cells.cell);
    }
  }
  blur(sigma);
}

void MarkerDrawing::take_part(ImageSize image, const LatticeSquare& square, float reach) {
  Box box;
  for (const float s : {0.0F, 0.5F, 1.0F}) {
    for (const float t : {0.0F, 0.5F, 1.0F}) {
      const Direction p = square.place(s, t);
      box.add(p.x, p.y);
    }
  }
  // As far as the image may see it: places beyond the corners are only expected, and may be far
  // off.
  const auto within = [reach](float at, int size) {
    return static_cast<int>(
        std::clamp(std::isfinite(at) ? at : 0.0F, -reach, static_cast<float>(size) + reach));
  };
  left_ = within(std::floor(box.left - reach), image.width);
  top_ = within(std::floor(box.top - reach), image.height);
  width_ = within(std::ceil(box.right + reach), image.width) + 1 - left_;
  height_ = within(std::ceil(box.bottom + reach), image.height) + 1 - top_;
  shares_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0F);
}

// Points less than a pixel apart, each shared by the four pixels around it.
void MarkerDrawing::draw_cell(const LatticeSquare& square, float s, float t, float cell) {
  constexpr float kPerPixel = 2;
  constexpr int kMostSteps = 24;
  const float area = square.area(s, t, cell);
  const float across = std::min(kPerPixel * std::sqrt(area), static_cast<float>(kMostSteps));
  if (!std::isfinite(area)) return;
  const int steps = std::max(static_cast<int>(std::ceil(across)), 2);
  const float share = area / static_cast<float>(steps * steps);
  const auto offset = [&](int i) {
    return cell * static_cast<float>(2 * i + 1 - steps) / static_cast<float>(2 * steps);
  };
  const auto last_x = static_cast<float>(width_ - 1);
  const auto last_y = static_cast<float>(height_ - 1);
  for (int i = 0; i < steps; ++i) {
    for (int k = 0; k < steps; ++k) {
      const Direction p = square.place(s + offset(k), t + offset(i));
      const float x = p.x - static_cast<float>(left_);
      const float y = p.y - static_cast<float>(top_);
      if (!(x >= 0 && y >= 0 && x < last_x && y < last_y)) continue;
      const int col = static_cast<int>(x);
      const int row = static_cast<int>(y);
      const float right = x - static_cast<float>(col);
      const float down = y - static_cast<float>(row);
      float* at = shares_.data() + row * width_ + col;
      at[0] += share * (1 - right) * (1 - down);
      at[1] += share * right * (1 - down);
      at[width_] += share * (1 - right) * down;
      at[width_ + 1] += share * right * down;
    }
  }
}

void MarkerDrawing::blur(float sigma) {
  const int reach = static_cast<int>(std::ceil(kBlurReach * sigma));
  kernel_.resize(static_cast<std::size_t>(reach + 1));
  float sum = 0;
  for (int i = 0; i <= reach; ++i) {
    const float x = static_cast<float>(i) / sigma;
    sum += (i == 0 ? 1 : 2) * (kernel_[static_cast<std::size_t>(i)] = std::exp(-0.5F * x * x));
  }
  for (float& k : kernel_) k /= sum;
  kernel_[0] /= 2;  // its pixel is on both sides
  blur_rows();
  blur_columns();
}

// The loops over a row are without conditions, for the compiler to make vectors of them.
void MarkerDrawing::blur_rows() {
  const auto width = static_cast<std::size_t>(width_);
  const std::size_t reach = kernel_.size() - 1;
  line_.assign(width + 2 * reach, 0.0F);
  const float* middle = line_.data() + reach;
  for (int y = 0; y < height_; ++y) {
    float* row = shares_.data() + y * width_;
    std::copy_n(row, width, line_.data() + reach);
    std::fill_n(row, width, 0.0F);
    for (std::size_t k = 0; k <= reach; ++k) add(kernel_[k], middle - k, middle + k, width, row);
  }
}

void MarkerDrawing::blur_columns() {
  const auto width = static_cast<std::size_t>(width_);
  const int reach = static_cast<int>(kernel_.size()) - 1;
  blurred_.assign(shares_.size(), 0.0F);
  line_.assign(width, 0.0F);
  const auto row = [&](int y) {
    return y >= 0 && y < height_ ? shares_.data() + y * width_ : line_.data();
  };
  for (int y = 0; y < height_; ++y) {
    for (int k = 0; k <= reach; ++k) {
      add(kernel_[static_cast<std::size_t>(k)], row(y - k), row(y + k), width,
          blurred_.data() + y * width_);
    }
  }
  shares_.swap(blurred_);
}

}  // namespace calvin::detect
