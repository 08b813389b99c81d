// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// PointLight: a light that somebody moves before the cameras, such as an LED on a stick or the spot
// of a laser pointer.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/observation.hpp"
#include "calvin/core/result.hpp"
#include "calvin/target/grid.hpp"

namespace calvin {

// One control point, id 0, at the origin: the middle of the light. It is seen from all sides, has
// no orientation, and is nothing that could be printed. One position of it says nothing of a single
// camera; many of them, each seen by several cameras at the same time, calibrate these together.
// What the functions answer is said of Board, in target/board.hpp.
struct PointLight {
  // m, of the ball that is rendered, which also bounds the outline.
  static constexpr double kDiameter = 0.01;

  [[nodiscard]] std::string text() const { return "dot"; }
  [[nodiscard]] Status check() const { return {}; }
  [[nodiscard]] int count() const noexcept { return 1; }
  [[nodiscard]] std::vector<int> ids() const { return {0}; }
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const { return {Eigen::Vector3d::Zero()}; }
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept {
    return id == 0 ? std::optional<std::size_t>(0) : std::nullopt;
  }
  [[nodiscard]] std::vector<int> neighbours(int /*id*/) const { return {}; }
  // There is no next control point: the light has itself.
  [[nodiscard]] double cell_size(int id) const noexcept { return id == 0 ? kDiameter : 0; }
  [[nodiscard]] BoardArea extent() const noexcept { return {0, 0, 0, 0}; }
  [[nodiscard]] BoardArea outline() const noexcept {
    constexpr double kRadius = kDiameter / 2;
    return {-kRadius, -kRadius, kRadius, kRadius};
  }
  // Turned about any axis it looks the same, which relabels nothing.
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const PointLight& /*other*/) const noexcept { return true; }

  friend bool operator==(const PointLight&, const PointLight&) = default;
};

}  // namespace calvin
