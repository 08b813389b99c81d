// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What becomes of pixels and of the numbers of a camera when a picture is turned, cut and scaled.

#include "calvin/camera/image_transform.hpp"

#include <utility>

#include "calvin/camera/models.hpp"

namespace calvin {

namespace {

// Where nothing is scaled a coordinate stays as it is to the last digit.
double scaled_or_kept(double c, double scale) {
  return scale == 1 ? c : scaled_coordinate(c, scale);
}

// False where the lens has no coefficients for the turned picture.
bool turn_coefficients(std::string_view model, std::vector<double>& parameters,
                       Orientation orientation) {
  bool turned = false;
  visit_model(model,
              [&]<typename M>() { turned = M::Lens::turn(parameters.data() + 4, orientation); });
  return turned;
}

}  // namespace

ImageTransform ImageTransform::scaled(ImageSize from, ImageSize to) {
  return filled({0, 0, static_cast<double>(from.width), static_cast<double>(from.height)}, to);
}

ImageTransform ImageTransform::cropped(double x, double y, ImageSize size) {
  ImageTransform transform;
  transform.x_ = x;
  transform.y_ = y;
  transform.size_ = size;
  return transform;
}

ImageTransform ImageTransform::filled(const Rectangle& part, ImageSize to) {
  ImageTransform transform = cropped(part.x, part.y, to);
  transform.sx_ = to.width / part.width;
  transform.sy_ = to.height / part.height;
  return transform;
}

ImageTransform ImageTransform::turned(ImageSize from, Orientation orientation) {
  ImageTransform transform = cropped(0, 0, orientation.size_of(from));
  transform.orientation_ = orientation;
  return transform;
}

Pixel ImageTransform::operator()(Pixel pixel) const noexcept {
  if (orientation_.transpose) std::swap(pixel.u, pixel.v);
  if (orientation_.flip_x) pixel.u = size_.width - 1 - pixel.u;
  if (orientation_.flip_y) pixel.v = size_.height - 1 - pixel.v;
  return {scaled_or_kept(pixel.u - x_, sx_), scaled_or_kept(pixel.v - y_, sy_)};
}

Observation ImageTransform::operator()(const Observation& observation) const {
  Observation moved = observation;
  for (Pixel& at : moved.uv) at = (*this)(at);
  for (double& sigma : moved.sigma) sigma = length(sigma);
  moved.blur = length(moved.blur);
  moved.image_size = size_;
  moved.patches.reset();
  return moved;
}

Result<Camera> ImageTransform::operator()(const Camera& camera) const {
  if (orientation_.transpose && camera.skew() != 0) {
    return make_error(ErrorCode::kUnsupported,
                      "A calibration with skew cannot be turned by a quarter: calibrate the frames "
                      "as the camera gives them, before they are turned.");
  }
  std::vector<double> p = camera.parameters();
  if (!turn_coefficients(camera.model(), p, orientation_)) {
    return make_error(ErrorCode::kUnsupported,
                      "A calibration with a sensor tilted about both axes cannot be turned by a "
                      "quarter: calibrate the frames as the camera gives them, before they are "
                      "turned.");
  }
  if (orientation_.transpose) std::swap(p[0], p[1]);
  p[0] *= sx_;
  p[1] *= sy_;
  const Pixel centre = (*this)(Pixel{p[2], p[3]});
  p[2] = centre.u;
  p[3] = centre.v;
  const double mirrored = orientation_.flip_x != orientation_.flip_y ? -1 : 1;
  return Camera::make(camera.model(), size_, p, mirrored * sx_ * camera.skew());
}

Eigen::MatrixXd scaled_covariance(const Eigen::MatrixXd& covariance,
                                  const std::vector<std::string_view>& names, double sx,
                                  double sy) {
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(covariance.rows());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string_view name = names[i];
    // Skew is along the rows, as fx and cx are.
    if (name == "fx" || name == "cx" || name == "skew") factor[static_cast<Eigen::Index>(i)] = sx;
    if (name == "fy" || name == "cy") factor[static_cast<Eigen::Index>(i)] = sy;
  }
  return factor.asDiagonal() * covariance * factor.asDiagonal();
}

}  // namespace calvin
