// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The map: for every pixel of an output frame the source coordinates, where in the source frame it
// comes from. A lens bends the picture smoothly, so that a coarse grid of nodes tells them all.
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <stop_token>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// px of the output frame -> px of the source frame, which may lie outside of it; absent where no
// ray leads there. Called from one thread at a time.
using PixelFunction = std::function<std::optional<Pixel>(Pixel)>;

// The four weights of cubic interpolation (Lagrange) at `t` between the second and the third of
// four equidistant values.
[[nodiscard]] constexpr std::array<float, 4> cubic_weights(double t) noexcept {
  const double a = t + 1;
  const double b = t - 1;
  const double c = t - 2;
  constexpr double kSixth = 1.0 / 6;
  return {static_cast<float>(-t * b * c * kSixth), static_cast<float>(a * b * c / 2),
          static_cast<float>(-a * t * c / 2), static_cast<float>(a * t * b * kSixth)};
}

// Source coordinates, px, on a square grid of nodes, between which they are interpolated
// bicubically. Immutable.
class RemapMap {
 public:
  // The largest error of the interpolation, px: a quarter of a grey level along each axis at the
  // sharpest edge that 8 bits can show. Thumbnails, which are bent more and cost little, get half.
  static constexpr double kTolerance = 1.0 / 1024;
  [[nodiscard]] double tolerance() const noexcept {
    return output_.width * output_.height <= kThumbnail ? kTolerance / 2 : kTolerance;
  }
  static constexpr int kCoarsest = 64;  // px

  // The grid is as coarse as tolerance() allows: 64 px, 32 px, and so on to 4 px, or less in small
  // pictures. The error is measured half way between nodes.
  // kCancelled soon after a stop was requested; kInvalidArgument where the memory does not suffice.
  static Result<RemapMap> build(ImageSize source, ImageSize output, const PixelFunction& source_of,
                                const std::stop_token& stop = {});

  [[nodiscard]] ImageSize source_size() const noexcept { return source_; }
  [[nodiscard]] ImageSize output_size() const noexcept { return output_; }
  // Distance of the nodes, px of the output; node (c, r) lies on pixel ((c - 1) step, (r - 1)
  // step).
  [[nodiscard]] int step() const noexcept { return step_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] const float* x_row(int row) const noexcept { return &x_[index(0, row)]; }
  [[nodiscard]] const float* y_row(int row) const noexcept { return &y_[index(0, row)]; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return (x_.size() + y_.size()) * sizeof(float);
  }

  // A cell lies between four nodes. It is smooth where all sixteen nodes exist that its coordinates
  // are interpolated from, mixed where some of them exist, and empty where none does. Only in
  // smooth cells does the interpolation mean something.
  [[nodiscard]] bool everywhere_smooth() const noexcept { return missing_ == 0; }
  enum class Cell { kSmooth, kMixed, kEmpty };
  [[nodiscard]] Cell cell(int cell_column, int cell_row) const noexcept;
  // Whether a cell may show something of the source.
  [[nodiscard]] bool matters(int cell_column, int cell_row) const noexcept;
  [[nodiscard]] int cell_of(double pixel, int cells) const noexcept;

  // The interpolated coordinates; NaN in cells that are not smooth. Kernels do not call this, they
  // walk rows.
  [[nodiscard]] Pixel at(Pixel output) const noexcept;

 private:
  static constexpr int kThumbnail = 128 * 128;  // px
  static constexpr float kMissing = std::numeric_limits<float>::quiet_NaN();

  RemapMap(ImageSize source, ImageSize output, int step);
  [[nodiscard]] std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  [[nodiscard]] bool fill(const PixelFunction& source_of, const std::stop_token& stop);
  [[nodiscard]] bool is_finest() const noexcept;
  [[nodiscard]] bool good_enough(const PixelFunction& source_of) const;

  ImageSize source_;
  ImageSize output_;
  int step_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  int missing_ = 0;
  std::vector<float> x_;
  std::vector<float> y_;
};

}  // namespace calvin
