// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How a picture has to be turned to stand upright.
#pragma once

#include "calvin/core/image.hpp"

namespace calvin {

// The eight ways to lay a picture on itself. First rows become columns (transpose), then the new
// picture is mirrored: left to right (flip_x), top to bottom (flip_y). A quarter turn clockwise is
// transpose and flip_x.
struct Orientation {
  bool transpose = false;
  bool flip_x = false;
  bool flip_y = false;

  [[nodiscard]] Orientation inverse() const noexcept {
    return transpose ? Orientation{true, flip_y, flip_x} : *this;
  }
  [[nodiscard]] ImageSize size_of(ImageSize size) const noexcept {
    return transpose ? ImageSize{size.height, size.width} : size;
  }
  friend bool operator==(const Orientation&, const Orientation&) = default;
};

}  // namespace calvin
