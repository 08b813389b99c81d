// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// PointLight: a light that somebody moves before the cameras, such as an LED on a stick or the spot
// of a laser pointer, or a wand with several of them.
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
// Those of a wand lie on its x axis, and their ids are their numbers along it: what is known of
// their distances gives the unit too. What the functions answer is said of Board, in
// target/board.hpp.
struct PointLight {
  // m, of the ball that is rendered, which also bounds the outline.
  static constexpr double kDiameter = 0.01;
  static constexpr std::size_t kMost = 8;

  // m, of each light, rising from 0.
  std::vector<double> places = {0};

  [[nodiscard]] bool is_wand() const noexcept { return places.size() > 1; }

  // "dot", or "wand:150mm+350mm": the distance of each light from the one before it.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] Status check() const;
  [[nodiscard]] int count() const noexcept { return static_cast<int>(places.size()); }
  [[nodiscard]] std::vector<int> ids() const;
  [[nodiscard]] std::vector<Eigen::Vector3d> points() const;
  [[nodiscard]] std::optional<std::size_t> index_of(int id) const noexcept {
    return id >= 0 && id < count() ? std::optional(static_cast<std::size_t>(id)) : std::nullopt;
  }
  [[nodiscard]] std::vector<int> neighbours(int id) const;
  // A light by itself has no next one, but its own size.
  [[nodiscard]] double cell_size(int id) const noexcept;
  [[nodiscard]] BoardArea extent() const noexcept { return {0, 0, places.back(), 0}; }
  [[nodiscard]] BoardArea outline() const noexcept {
    constexpr double kRadius = kDiameter / 2;
    return {-kRadius, -kRadius, places.back() + kRadius, kRadius};
  }
  // One light looks the same turned about any axis, which relabels nothing; those of a wand are
  // named by their distances, or not at all.
  [[nodiscard]] std::vector<Relabelling> symmetries() const { return {}; }
  [[nodiscard]] bool looks_like(const PointLight& other) const noexcept {
    return places.size() == other.places.size();
  }

  friend bool operator==(const PointLight&, const PointLight&) = default;
};

}  // namespace calvin
