// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-hand-eye --method strobl: the files that it begins with and writes, and what it says of
// the cameras.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/hand_eye_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/rig/strobl/solve_strobl.hpp"

#include "print_calibration.hpp"

namespace hand_eye_joint {

struct Arguments {
  calvin::StroblOptions options;
  std::vector<std::string> calibrations;  // to write, of each camera in turn
  std::string rig;                        // to write; empty: none

  [[nodiscard]] bool is_asked_for() const {
    return options.pitch_known || options.aspect_known || !calibrations.empty() || !rig.empty();
  }
};

// A calibration whose camera has a name: its own, or that of the file.
inline calvin::Result<calvin::Calibration> read_named(const std::string& path) {
  auto calibration = calvin::read_calibration(path);
  if (calibration && calibration->camera.empty()) {
    calibration->camera = std::filesystem::path(path).stem().string();
  }
  return calibration;
}

inline calvin::Status write(const std::string& hand_eye, const Arguments& to,
                            const calvin::StroblSolution& solution) {
  for (std::size_t c = 0; c < to.calibrations.size(); ++c) {
    auto written = calvin::write_calibration(to.calibrations[c], solution.calibrations[c]);
    if (!written) return written;
  }
  if (!to.rig.empty()) {
    auto written = calvin::write_rig(to.rig, *solution.rig);
    if (!written) return written;
  }
  return calvin::write_hand_eye(hand_eye, solution.hand_eye);
}

// Where further cameras stand, and the lenses of all.
inline void print(const calvin::StroblSolution& solution) {
  constexpr double kMillimetre = 1e-3;  // m
  for (std::size_t c = 1; c < solution.calibrations.size(); ++c) {
    const calvin::RigCamera& camera = solution.rig->cameras[c];
    const auto& t = camera.rig_from_camera.translation;
    const auto sigma = [&](std::size_t k) {
      return calvin::two_digits(std::sqrt(camera.covariance[7 * (3 + k)]) / kMillimetre);
    };
    fmt::print("'{}' from '{}': {:.3f} {:.3f} {:.3f} mm (+-{} {} {}), {:.3f} mm apart\n",
               camera.calibration.camera, solution.rig->world, t[0] / kMillimetre,
               t[1] / kMillimetre, t[2] / kMillimetre, sigma(0), sigma(1), sigma(2),
               std::hypot(t[0], t[1], t[2]) / kMillimetre);
  }
  for (const calvin::Calibration& calibration : solution.calibrations) {
    calvin_tools::print(calibration);
  }
}

}  // namespace hand_eye_joint
