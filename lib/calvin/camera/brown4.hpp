// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Brown's model with two radial terms: k1 k2 p1 p2 ("radtan" of Kalibr, OPENCV of COLMAP).
#pragma once

#include "calvin/camera/brown.hpp"

namespace calvin::lens {

struct Brown4 : Brown<4> {
  static constexpr std::string_view kName = "brown4";
  static constexpr std::array<std::string_view, 4> kNames = {"k1", "k2", "p1", "p2"};
};

}  // namespace calvin::lens
