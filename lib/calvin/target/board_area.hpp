// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// BoardArea: a rectangle in the plane of a board.
#pragma once

namespace calvin {

// m, in the board frame, with sides along x and y.
struct BoardArea {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  [[nodiscard]] double width() const noexcept { return right - left; }
  [[nodiscard]] double height() const noexcept { return bottom - top; }
};

}  // namespace calvin
