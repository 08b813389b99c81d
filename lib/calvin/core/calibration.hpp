// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibration: what is known of one camera. Data only: camera/ makes a model of it, io/ files.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/export.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"

namespace calvin {

// A rigid motion as plain numbers: Rodrigues vector (rad) and translation (m).
struct Pose {
  std::array<double, 3> rotation{};
  std::array<double, 3> translation{};
};

// One intrinsic parameter, named as in docs/conventions.md. `sigma` is absent where the parameter
// was not estimated.
struct Parameter {
  std::string name;
  double value = 0;
  std::optional<double> sigma;
};

// A view that took part in the solve, or was held out of it.
struct ViewRecord {
  std::uint64_t timestamp = kNoTimestamp;  // ns
  double rms = 0;                          // px
  int points = 0;
  bool held_out = false;
  Pose camera_from_board;
};

// z = kx (1 - x^2) + ky (1 - y^2) in m, with x and y in -1..1 over the board.
struct BoardWarp {
  double kx = 0;
  double ky = 0;
  std::optional<double> kx_sigma = std::nullopt;  // m
  std::optional<double> ky_sigma = std::nullopt;
};

// A part of the calibrated image, in its px.
struct Rectangle {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;
};

// The camera that was calibrated, as its driver tells of it; empty where that is not known.
struct CaptureDevice {
  std::string node;  // "/dev/video0", which may be another camera's after the next start
  std::string name;  // "HD Pro Webcam C920"
  std::string bus;   // where it is plugged in: "usb-0000:00:14.0-1"
  std::optional<bool> autofocus;
};

struct Calibration {
  std::string camera;
  ImageSize image_size;
  std::string model;                  // "brown5", ...
  std::vector<Parameter> parameters;  // in the model's order, fx fy cx cy first

  // Row-major, over the parameters that have a sigma, in the order of `parameters`; may be empty.
  std::vector<double> covariance;

  std::optional<double> rms;           // px, see docs/conventions.md
  std::optional<double> held_out_rms;  // px
  std::optional<double> chi;
  // The promises, px, 1 sigma: where corners covered the picture, and all over it with the place
  // where it is worst.
  std::optional<double> expected_error;
  std::optional<double> expected_error_anywhere;
  std::optional<Pixel> worst_place;
  std::optional<double> split_half_ratio;
  std::string misfit;  // the cause, or "none"; empty where nobody looked for one
  // The share of expected_error squared that is more than the corners' own noise, 0..1.
  std::optional<double> systematic;
  std::vector<std::string> remarks;  // sentences for the user: what is weak, and what to do
  std::vector<Pixel> covered;        // convex polygon that the corners covered, px
  std::string board;                 // board text
  std::optional<BoardWarp> warp;
  std::vector<ViewRecord> views;
  std::optional<Rectangle> sensor_crop;  // the part of the calibrated image that frames show
  // s, from the first row of a frame to the last, by which the views were solved, and 1 sigma of it
  // where it was estimated. Negative: the last row comes first.
  std::optional<double> readout;
  std::optional<double> readout_sigma;
  std::optional<CaptureDevice> device;
  // Where the lens stood for all views, in the units of the camera's controls.
  std::optional<double> focus;
  std::optional<double> zoom;
  std::string created;  // ISO 8601, UTC

  // The value of a parameter, or nullptr.
  [[nodiscard]] CALVIN_API const Parameter* find(std::string_view name) const noexcept;
};

}  // namespace calvin
