// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve: a camera from `par`, the result of Heikkila's toolbox.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/heikkila/inverse_model.hpp"

namespace solve_par {

// s f u0 v0 K1 K2 T1 T2 in mm and px, on a sensor of that many m.
struct Par {
  std::array<double, 8> numbers{};
  std::array<double, 2> sensor{};
  bool is_release_3 = false;  // distortion from where a point is seen to where it would be
  bool is_given = false;
};

// Whether the text is eight numbers.
inline bool set_numbers(std::string_view text, Par& par) {
  const auto fields = calvin::split(text, ',');
  if (fields.size() != par.numbers.size()) return false;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto number = calvin::parse_double(calvin::trim(fields[i]));
    if (!number) return false;
    par.numbers[i] = *number;
  }
  par.is_given = true;
  return true;
}

// Whether the text is two lengths with a unit, as 6.2031x4.6515mm.
inline bool set_sensor(std::string_view text, Par& par) {
  const auto sides = calvin::split(text, 'x');
  if (sides.size() != 2) return false;
  const std::string_view unit = sides[1].substr(sides[1].find_last_of("0123456789.") + 1);
  const auto width = calvin::parse_length(fmt::format("{}{}", sides[0], unit));
  const auto height = calvin::parse_length(sides[1]);
  if (!width || !height) return false;
  par.sensor = {*width, *height};
  return true;
}

// Of releases 1 and 2 it is a brown4; of release 3 the brown5 that follows, and how far it is off
// is among the remarks. `shift` is what is taken off u0 and v0, px.
inline calvin::Result<calvin::Calibration> calibration_of(const Par& par, calvin::ImageSize size,
                                                          double shift) {
  const auto [s, f, u0, v0, k1, k2, t1, t2] = par.numbers;
  if (!(par.sensor[0] > 0) || !(par.sensor[1] > 0)) {
    return calvin::make_error(calvin::ErrorCode::kInvalidArgument,
                              "The focal length of par is in mm: give the size of the sensor, as "
                              "in --sensor 6.2031x4.6515mm.");
  }
  constexpr double kMillimetre = 1e-3;  // m
  const double fx = s * f * kMillimetre * size.width / par.sensor[0];
  const double fy = f * kMillimetre * size.height / par.sensor[1];
  const std::array<double, 4> k = {k1 * f * f, k2 * std::pow(f, 4), t1 * f, t2 * f};
  if (!par.is_release_3) {
    const auto camera = calvin::Camera::make(
        "brown4", size, {fx, fy, u0 - shift, v0 - shift, k[0], k[1], k[2], k[3]});
    if (!camera) return tl::unexpected<calvin::Error>(camera.error());
    return camera->to_calibration();
  }
  const calvin::InverseModel inverse = {fx,         fy, u0 - shift,
                                        v0 - shift, 0,  {k[0], k[1], k[2], k[3], 0, 0, 0, 0}};
  const auto fit = calvin::camera_of(inverse, size);
  if (!fit) return tl::unexpected<calvin::Error>(fit.error());
  if (!std::isfinite(fit->residual)) {
    return calvin::make_error(calvin::ErrorCode::kDegenerate,
                              "No camera of ours follows these coefficients over the picture: "
                              "check the sensor's size, and whether they are of release 3.");
  }
  calvin::Calibration calibration = fit->camera.to_calibration();
  calibration.remarks.push_back(
      fmt::format("brown5 follows the coefficients of release 3 within {:.2g} px.", fit->residual));
  return calibration;
}

}  // namespace solve_par
