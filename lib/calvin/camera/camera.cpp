// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the functions of a model by its name and makes a Camera of a calibration, or says what the
// calibration lacks.

#include "calvin/camera/camera.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/camera/image_transform.hpp"
#include "calvin/camera/models.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

// One row of the model table: the functions of a Model behind plain pointers.
struct CameraFunctions {
  std::string_view name;
  std::vector<std::string_view> parameters;
  bool (*project)(const double*, double, const Eigen::Vector3d&, double*, double*, double*);
  double (*limit)(const double*);
  double (*radius)(const Eigen::Vector3d&);
  std::optional<Eigen::Vector3d> (*undistort)(const double*, double, const double*);
};

namespace {

template <typename Lens>
CameraFunctions functions_of() {
  const auto names = Model<Lens>::names();
  return {Lens::kName,           {names.begin(), names.end()},
          &Model<Lens>::project, &Lens::limit,
          &Lens::radius,         &Lens::undistort};
}

// Never freed, as the names below: while a program ends, its other threads may still be at work.
const std::vector<CameraFunctions>& table() {
  static const auto& kTable = []<typename... Lens>(std::tuple<Lens...>*) -> auto& {
    return *new std::vector<CameraFunctions>{functions_of<Lens>()...};
  }
  (static_cast<AllLenses*>(nullptr));
  return kTable;
}

const CameraFunctions* find_model(std::string_view name) {
  const auto it = std::find_if(table().begin(), table().end(),
                               [name](const CameraFunctions& f) { return f.name == name; });
  return it == table().end() ? nullptr : &*it;
}

constexpr double kMost = 1e12;  // no parameter is larger

constexpr const char* kNoSize =
    " Files of OpenCV need not say it: set image_size to that of the pictures.";

tl::unexpected<Error> unknown_model(std::string_view name) {
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("The camera model '{}' is not known to this version. Known models: {}.", name,
                  join(model_names(), ", ")));
}

}  // namespace

const std::vector<std::string_view>& model_names() {
  static const auto& kNames = []() -> auto& {
    auto& names = *new std::vector<std::string_view>;
    for (const CameraFunctions& f : table()) names.push_back(f.name);
    return names;
  }
  ();
  return kNames;
}

std::vector<std::string_view> parameter_names(std::string_view model) {
  const CameraFunctions* f = find_model(model);
  return f == nullptr ? std::vector<std::string_view>() : f->parameters;
}

Result<Camera> Camera::make(const Calibration& calibration) {
  const CameraFunctions* f = find_model(calibration.model);
  if (f == nullptr) return unknown_model(calibration.model);
  std::vector<double> values;
  for (const std::string_view name : f->parameters) {
    const Parameter* p = calibration.find(name);
    if (p == nullptr) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("The calibration has no '{}', which the model {} needs ({}).",
                                    name, f->name, join(f->parameters, " ")));
    }
    values.push_back(p->value);
  }
  double skew = 0;
  for (const Parameter& p : calibration.parameters) {
    if (p.name == "skew") {
      skew = p.value;
    } else if (std::find(f->parameters.begin(), f->parameters.end(), p.name) ==
               f->parameters.end()) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("The calibration has a '{}', which the model {} does not know ({}).", p.name,
                      f->name, join(f->parameters, " ")));
    }
  }
  return make(calibration.model, calibration.image_size, values, skew);
}

Result<Camera> Camera::make(std::string_view model, ImageSize size,
                            const std::vector<double>& parameters, double skew) {
  Camera camera;
  camera.functions_ = find_model(model);
  if (camera.functions_ == nullptr) return unknown_model(model);
  const auto& names = camera.functions_->parameters;
  if (size.width < 1 || size.height < 1 || size.width > 65536 || size.height > 65536) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The calibration is for an image of {}x{} px; a size from 1x1 to "
                                  "65536x65536 is needed.{}",
                                  size.width, size.height, size == ImageSize{} ? kNoSize : ""));
  }
  if (parameters.size() != names.size()) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The model {} has {} parameters ({}), not {}.", model,
                                  names.size(), join(names, " "), parameters.size()));
  }
  const auto is_usable = [](double value) { return std::abs(value) <= kMost; };
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!is_usable(parameters[i])) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("The parameter {} of the calibration is {}, not a usable number.", names[i],
                      parameters[i]));
    }
  }
  if (!is_usable(skew)) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The parameter skew of the calibration is {}, not a usable "
                                  "number.",
                                  skew));
  }
  if (!(parameters[0] > 0) || !(parameters[1] > 0)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("The focal lengths of a calibration must be positive; fx is {}, fy {}.",
                    parameters[0], parameters[1]));
  }
  camera.size_ = size;
  camera.parameters_ = parameters;
  camera.skew_ = skew;
  camera.limit_ = camera.functions_->limit(camera.parameters_.data() + 4);
  if (!(camera.limit_ > 0)) {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("With these coefficients the model {} sees nothing ({}): check them.", model,
                    join(std::span(names).subspan(4), " ")));
  }
  return camera;
}

std::string_view Camera::model() const noexcept { return functions_->name; }

std::optional<Pixel> Camera::project(const Eigen::Vector3d& point) const noexcept {
  double uv[2];
  double j[6];
  if (!functions_->project(parameters_.data(), skew_, point, uv, j, nullptr)) return std::nullopt;
  if (!(functions_->radius(point) <= limit_)) return std::nullopt;
  // The image must keep its handedness: strong tangential terms fold before the radial limit does.
  const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> jacobian(j);
  const Eigen::Vector3d normal =
      Eigen::Vector3d(jacobian.row(0)).cross(Eigen::Vector3d(jacobian.row(1)));
  if (!(normal.dot(point) >= 0)) return std::nullopt;
  if (!std::isfinite(uv[0]) || !std::isfinite(uv[1])) return std::nullopt;
  return Pixel{uv[0], uv[1]};
}

std::optional<Eigen::Vector3d> Camera::unproject(Pixel pixel) const noexcept {
  if (!std::isfinite(pixel.u) || !std::isfinite(pixel.v)) return std::nullopt;
  double xy[2];
  xy[1] = (pixel.v - cy()) / fy();
  xy[0] = (pixel.u - cx() - skew_ * xy[1]) / fx();
  return functions_->undistort(parameters_.data() + 4, limit_, xy);
}

Camera Camera::scaled(ImageSize size) const {
  return ImageTransform::scaled(size_, size)(*this).value_or(*this);
}

Camera Camera::cropped(double x, double y, ImageSize size) const {
  return ImageTransform::cropped(x, y, size)(*this).value_or(*this);
}

Result<Camera> Camera::turned(Orientation orientation) const {
  return ImageTransform::turned(size_, orientation)(*this);
}

Calibration Camera::to_calibration() const {
  Calibration calibration;
  calibration.image_size = size_;
  calibration.model = model();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    calibration.parameters.push_back({std::string(functions_->parameters[i]), parameters_[i], {}});
  }
  if (skew_ != 0) calibration.parameters.push_back({"skew", skew_, {}});
  return calibration;
}

}  // namespace calvin
