// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's model with three radial terms: k1 k2 p1 p2 k3 (OpenCV's default, "plumb_bob" of ROS).
#pragma once

#include "calvin/camera/brown.hpp"

namespace calvin::lens {

struct Brown5 : Brown<5> {
  static constexpr std::string_view kName = "brown5";
  static constexpr std::array<std::string_view, 5> kNames = {"k1", "k2", "p1", "p2", "k3"};
};

}  // namespace calvin::lens
