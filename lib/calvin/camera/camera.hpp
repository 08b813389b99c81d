// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Camera: a calibration that can project. Immutable; safe to share between threads.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/calibration.hpp"
#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"

namespace calvin {

struct CameraFunctions;

class Camera {
 public:
  // kUnsupported for an unknown model; kInvalidArgument for all else that can be wrong: missing,
  // extra or non-finite parameters, focal lengths that are not positive, an empty image.
  CALVIN_API static Result<Camera> make(const Calibration& calibration);
  // The same from bare numbers in the model's order (fx fy cx cy d0 ...), with an optional skew.
  CALVIN_API static Result<Camera> make(std::string_view model, ImageSize size,
                                        const std::vector<double>& parameters, double skew = 0);

  [[nodiscard]] CALVIN_API std::string_view model() const noexcept;
  [[nodiscard]] ImageSize image_size() const noexcept { return size_; }
  // fx fy cx cy d0 d1 ...
  [[nodiscard]] const std::vector<double>& parameters() const noexcept { return parameters_; }
  [[nodiscard]] double fx() const noexcept { return parameters_[0]; }
  [[nodiscard]] double fy() const noexcept { return parameters_[1]; }
  [[nodiscard]] double cx() const noexcept { return parameters_[2]; }
  [[nodiscard]] double cy() const noexcept { return parameters_[3]; }
  [[nodiscard]] double skew() const noexcept { return skew_; }

  // Point in the camera frame (x right, y down, z forward, any unit) -> px. Absent where the model
  // is not valid: behind a perspective lens, or where the distortion folds back. The result may
  // lie outside the image.
  [[nodiscard]] CALVIN_API std::optional<Pixel> project(
      const Eigen::Vector3d& point) const noexcept;

  // px -> unit ray in the camera frame; the inverse of project(). Absent where no valid ray leads
  // to that pixel.
  [[nodiscard]] CALVIN_API std::optional<Eigen::Vector3d> unproject(Pixel pixel) const noexcept;

  // The camera whose image is this one's, scaled to another size / cut to a part of it that starts
  // at (x, y) px; this one as it is where no camera has such an image or such numbers.
  [[nodiscard]] CALVIN_API Camera scaled(ImageSize size) const;
  [[nodiscard]] CALVIN_API Camera cropped(double x, double y, ImageSize size) const;

  // The camera whose image is this one's, turned. kUnsupported where a skew would have to go along
  // the other axis, and where a sensor is tilted about both.
  [[nodiscard]] CALVIN_API Result<Camera> turned(Orientation orientation) const;

  // Model, size and parameters as data; skew is listed only where it is not zero.
  [[nodiscard]] CALVIN_API Calibration to_calibration() const;

 private:
  Camera() = default;

  const CameraFunctions* functions_ = nullptr;
  ImageSize size_;
  std::vector<double> parameters_;
  double skew_ = 0;
  double limit_ = 0;  // of the distance from the axis up to which the model is valid
};

// "pinhole, brown4, ...": the models that this version knows, and the parameter names of one of
// them (fx fy cx cy k1 ...; empty for an unknown one).
[[nodiscard]] CALVIN_API const std::vector<std::string_view>& model_names();
[[nodiscard]] CALVIN_API std::vector<std::string_view> parameter_names(std::string_view model);

}  // namespace calvin
