// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The order of the unknowns of one camera and of one board, for ParameterTable and for whoever
// works on one of them alone. No other file knows at which place an unknown stands. Internal.
#pragma once

#include <cstddef>

namespace calvin {

// Unknowns that stand one after the other.
struct ParameterRange {
  int first = 0;
  int count = 0;

  [[nodiscard]] constexpr int end() const { return first + count; }
  [[nodiscard]] constexpr bool empty() const { return count == 0; }
  [[nodiscard]] constexpr bool has(int unknown) const {
    return unknown >= first && unknown < end();
  }
  // The unknown with this number in the range.
  [[nodiscard]] constexpr int operator[](int i) const { return first + i; }
  // The same unknowns where those before them take up `more` places.
  [[nodiscard]] constexpr ParameterRange after(int more) const { return {first + more, count}; }
};

// The unknowns of a camera: fx fy cx cy, the lens' coefficients, the skew where it is estimated.
struct CameraUnknowns {
  int coefficients = 0;
  bool has_skew = false;

  // Those of a camera with so many intrinsics (fx fy cx cy and the coefficients).
  [[nodiscard]] static constexpr CameraUnknowns of(std::size_t intrinsics, bool skew) {
    return {static_cast<int>(intrinsics) - CameraUnknowns().pinhole().count, skew};
  }

  [[nodiscard]] constexpr ParameterRange focal() const { return {0, 2}; }
  [[nodiscard]] constexpr ParameterRange center() const { return {focal().end(), 2}; }
  [[nodiscard]] constexpr ParameterRange pinhole() const { return {0, center().end()}; }
  [[nodiscard]] constexpr ParameterRange distortion() const {
    return {pinhole().end(), coefficients};
  }
  [[nodiscard]] constexpr ParameterRange intrinsics() const { return {0, distortion().end()}; }
  [[nodiscard]] constexpr ParameterRange skew() const {
    return {intrinsics().end(), has_skew ? 1 : 0};
  }
  [[nodiscard]] constexpr ParameterRange all() const { return {0, skew().end()}; }
};

// The unknowns of a board, which are the coefficients of its modes: two curvatures, the aspect
// less 1, and how far the lights of a wand but the first are from their places along it.
struct BoardUnknowns {
  bool has_warp = false;
  bool has_aspect = false;
  int moved_lights = 0;

  [[nodiscard]] constexpr ParameterRange warp() const { return {0, has_warp ? 2 : 0}; }
  [[nodiscard]] constexpr ParameterRange aspect() const {
    return {warp().end(), has_aspect ? 1 : 0};
  }
  [[nodiscard]] constexpr ParameterRange lights() const { return {aspect().end(), moved_lights}; }
  [[nodiscard]] constexpr ParameterRange all() const { return {0, lights().end()}; }
};

}  // namespace calvin
