// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What was found next to a pixel that somebody has pointed at.
#pragma once

#include "calvin/core/image.hpp"

namespace calvin {

struct FoundPoint {
  enum class Kind { kCorner, kDisc };

  Pixel at;          // of a disc the centre
  double sigma = 0;  // px, 1 sigma per coordinate
  Kind kind = Kind::kCorner;
};

}  // namespace calvin
