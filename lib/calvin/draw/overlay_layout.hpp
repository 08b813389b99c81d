// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where on the frame the panel and its words stand, for whoever draws words: the library has no
// fonts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/session/progress.hpp"

namespace calvin {

// The upper corner that the panel is in.
enum class PanelSide { kLeft, kRight };

// Whole px of the frame.
struct OverlayBox {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool operator==(const OverlayBox&) const = default;
};

// Around the panel, its dark ground included.
[[nodiscard]] OverlayBox overlay_panel_box(ImageSize frame, const Progress& progress,
                                           PanelSide side);

// Words in the panel, in a line of their own, or beside a point.
struct OverlayWords {
  std::string text;
  Pixel at;          // the left end, half way up the line
  double width = 0;  // px that there is room for
  double size = 0;   // of the font, px

  [[nodiscard]] bool operator==(const OverlayWords& o) const {
    return text == o.text && at.u == o.at.u && at.v == o.at.v && width == o.width && size == o.size;
  }
};
[[nodiscard]] std::vector<OverlayWords> overlay_panel_words(ImageSize frame,
                                                            const Progress& progress,
                                                            PanelSide side);

// The number of each manual point, beside its cross.
[[nodiscard]] std::vector<OverlayWords> overlay_point_numbers(ImageSize frame,
                                                              const Progress& progress);

// Px of the frame, from left to right.
struct OverlaySpan {
  int left = 0;
  int right = 0;

  [[nodiscard]] bool operator==(const OverlaySpan&) const = default;
};

// What the panel leaves free at its height: half of the frame at least.
[[nodiscard]] OverlaySpan beside_panel(const OverlayBox& panel, ImageSize frame);

// Whether a corner of a board lies under the box.
[[nodiscard]] bool hides_corner(const OverlayBox& box, std::span<const Observation> seen,
                                ImageSize frame);
// Whether a square around its corners does, as wide as they are apart.
[[nodiscard]] bool hides_square(const OverlayBox& box, std::span<const Observation> seen,
                                ImageSize frame);
// Whether a place of an outline does, as Progress::ghost has them: parts of the picture.
[[nodiscard]] bool hides_outline(const OverlayBox& box, std::span<const Pixel> outline,
                                 ImageSize frame);

}  // namespace calvin
