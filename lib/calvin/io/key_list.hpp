// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A calibration as a list of keys, short enough for a command line.
#pragma once

#include <string_view>

#include "calvin/core/calibration.hpp"

namespace calvin {

// "fx=520,fy=518,cx=325,cy=236,k1=-0.28,k2=0.09,width=640,height=480[,model=brown5]". Focal lengths
// and centre are needed, coefficients that are not named are 0. Without a model: pinhole, brown4
// (k1 k2 p1 p2) or brown5 (k3), the first that knows all names. Without width and height the image
// size is 0x0: that of the images. An error (kInvalidArgument, or that of Camera::make()) shows a
// right text.
[[nodiscard]] Result<Calibration> parse_key_list(std::string_view text);

}  // namespace calvin
