// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How scaling, cropping and turning a picture moves what is measured in it: pixels, observations,
// cameras and their covariance. Nothing else knows where a coordinate goes when pixels change their
// size (docs/conventions.md): tests/structure.py holds that.
#pragma once

#include <concepts>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"

namespace calvin {

// A coordinate, px, in a picture that is `scale` times as long along its axis. The centre of the
// first pixel is 0, its edge -0.5.
template <std::floating_point T>
[[nodiscard]] constexpr T scaled_coordinate(T c, T scale) noexcept {
  return scale * (c + T(0.5)) - T(0.5);
}

// The same for cells: the coordinate, px, that divides the length of a picture so that `share` of
// it lies before, and the share that lies before a coordinate.
[[nodiscard]] constexpr double coordinate_at(double share, int length) noexcept {
  return share * length - 0.5;
}
[[nodiscard]] constexpr double share_before(double c, int length) noexcept {
  return (c + 0.5) / length;
}

// The time at which a rolling shutter reads the row v of a picture that many rows high, in readouts
// (from the first row to the last) after the middle one: -1/2..1/2.
[[nodiscard]] constexpr double row_delay(double v, int height) noexcept {
  return height > 1 ? v / (height - 1) - 0.5 : 0;
}

// First the picture is turned, then a part of it is cut out, then that is scaled.
class ImageTransform {
 public:
  // The whole picture, scaled to another size.
  [[nodiscard]] static ImageTransform scaled(ImageSize from, ImageSize to);
  // The part of a picture that begins `x` columns and `y` rows in.
  [[nodiscard]] static ImageTransform cropped(double x, double y, ImageSize size);
  // A part of a picture, px, scaled to a size.
  [[nodiscard]] static ImageTransform filled(const Rectangle& part, ImageSize to);
  [[nodiscard]] static ImageTransform turned(ImageSize from, Orientation orientation);

  // The size of the picture that results.
  [[nodiscard]] ImageSize size() const noexcept { return size_; }

  [[nodiscard]] Pixel operator()(Pixel pixel) const noexcept;

  // A length without a direction, px: the mean of both axes, for pixels that become oblong.
  [[nodiscard]] double length(double px) const noexcept { return px * (sx_ + sy_) / 2; }

  // Without the patches, which are of the picture before.
  [[nodiscard]] Observation operator()(const Observation& observation) const;

  // kUnsupported where the model has no words for what results: a skew that would have to go along
  // the other axis, a sensor that is tilted about both and turned by a quarter. Errors of
  // Camera::make() where no camera results.
  [[nodiscard]] Result<Camera> operator()(const Camera& camera) const;

 private:
  ImageTransform() = default;

  Orientation orientation_;
  double x_ = 0;  // px, where the part begins
  double y_ = 0;
  double sx_ = 1;
  double sy_ = 1;
  ImageSize size_;
};

// The covariance of parameters, by their names, of a camera whose picture becomes `sx` times as
// wide and `sy` times as high.
[[nodiscard]] Eigen::MatrixXd scaled_covariance(const Eigen::MatrixXd& covariance,
                                                const std::vector<std::string_view>& names,
                                                double sx, double sy);

}  // namespace calvin
