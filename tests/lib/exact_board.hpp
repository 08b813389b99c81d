// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures of a checkerboard that is seen head on, by a formula: the blurred pattern is a product
// of two blurred waves, of which each pixel takes the mean. It shares nothing with synth/.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::scenes {

struct ExactBoard {
  int cols = 9;
  int rows = 6;
  double square = 30;  // px
  double angle = 0;    // rad, of a row of corners to a row of pixels
  Pixel middle = {320, 240};
  double dark = 30;  // grey levels
  double light = 220;
  double blur = 1;  // px, 1 sigma, before the pixels; at least .05
  double noise = 0;
  // How far the picture is shifted about each corner, up to half way to the next, px; none where
  // there are fewer.
  std::vector<Pixel> shifts;

  // Where a corner is, its own shift included.
  [[nodiscard]] Pixel corner(std::size_t id) const {
    const Pixel at = corner_before_shift(id);
    const Pixel shift = id < shifts.size() ? shifts[id] : Pixel{};
    return {at.u + shift.u, at.v + shift.v};
  }

  [[nodiscard]] GrayImage picture(ImageSize size, std::mt19937_64& random) const {
    std::normal_distribution<double> normal(0, 1);
    GrayImage image(size.width, size.height);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const double grey = mean(x, y) + noise * normal(random);
        image.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::clamp(grey, 0.0, 255.0)));
      }
    }
    return image;
  }

 private:
  [[nodiscard]] Pixel corner_before_shift(std::size_t id) const {
    const auto count = static_cast<std::size_t>(cols);
    const double x = (static_cast<double>(id % count) - (cols - 1) / 2.0) * square;
    const double y = (static_cast<double>(id / count) - (rows - 1) / 2.0) * square;
    return {middle.u + std::cos(angle) * x - std::sin(angle) * y,
            middle.v + std::sin(angle) * x + std::cos(angle) * y};
  }

  // In squares from the first corner.
  [[nodiscard]] Pixel on_board(Pixel p) const {
    const double u = p.u - middle.u;
    const double v = p.v - middle.v;
    return {(std::cos(angle) * u + std::sin(angle) * v) / square + (cols - 1) / 2.0,
            (std::cos(angle) * v - std::sin(angle) * u) / square + (rows - 1) / 2.0};
  }

  // 1 and -1 by turns, from a line of corners to the next, blurred.
  [[nodiscard]] double wave(double at, int lines) const {
    const double scale = square / (blur * std::numbers::sqrt2);
    double value = 1;
    double step = -1;
    for (int line = 0; line < lines; ++line, step = -step) {
      value += step * (1 + std::erf((at - line) * scale));
    }
    return value;
  }

  [[nodiscard]] double grey_at(double u, double v) const {
    Pixel at = on_board({u, v});
    if (at.u < -1 || at.v < -1 || at.u > cols || at.v > rows) return light;
    if (!shifts.empty()) {
      const auto col = static_cast<std::size_t>(std::clamp(std::lround(at.u), 0L, cols - 1L));
      const auto row = static_cast<std::size_t>(std::clamp(std::lround(at.v), 0L, rows - 1L));
      const Pixel& shift = shifts[row * static_cast<std::size_t>(cols) + col];
      at = on_board({u - shift.u, v - shift.v});
    }
    return (light + dark) / 2 - (light - dark) / 2 * wave(at.u, cols) * wave(at.v, rows);
  }

  // Over a pixel's square. Where nothing changes nearby, its middle tells.
  [[nodiscard]] double mean(int x, int y) const {
    constexpr int kSamples = 16;  // a side: twenty in the blur's full width at its least
    double least = 255;
    double most = 0;
    for (const double du : {-0.5, 0.0, 0.5}) {
      for (const double dv : {-0.5, 0.0, 0.5}) {
        const double grey = grey_at(x + du, y + dv);
        least = std::min(least, grey);
        most = std::max(most, grey);
      }
    }
    if (most - least < 0.02) return (most + least) / 2;
    const int samples = blur < 0.2 ? kSamples : kSamples / 4;
    double sum = 0;
    for (int i = 0; i < samples * samples; ++i) {
      sum +=
          grey_at(x - 0.5 + (i % samples + 0.5) / samples, y - 0.5 + (i / samples + 0.5) / samples);
    }
    return sum / (samples * samples);
  }
};

}  // namespace calvin::scenes
