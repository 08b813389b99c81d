// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of a tag, where its fitted sides meet.
#pragma once

#include <array>
#include <optional>

#include "calvin/core/image.hpp"
#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/side_fit.hpp"
#include "calvin/detect/tags/tag_pattern.hpp"

namespace calvin::detect {

struct TagFit {
  Quad corners;                   // those of which no sides are seen are moved as the others were
  std::array<double, 4> sigma{};  // px, 1 sigma per coordinate; 0: the corner is not seen
  double width = 0;               // px, 1 sigma of the blur across sides
  int sides = 0;                  // that were found
  bool is_rough = false;

  [[nodiscard]] int seen() const;
};

// How far the middles of the sides of a tag are outside of the lines between its corners, and how
// far that is known.
struct TagBends {
  std::array<double, 4> at{};     // px
  std::array<double, 4> sigma{};  // px
};

// Bends of which nothing is known.
[[nodiscard]] TagBends unknown_bends(const Quad& corners);

// What is known of a tag before it is fitted.
struct TagGuess {
  Quad corners;
  double reach = 1;  // px, how far they may be off
  TagBends bends;
  double width = kUsualWidth;  // px, 1 sigma of the blur
  SideCare care = SideCare::kFull;
};

// The image has step 1.
[[nodiscard]] TagFit fit_tag(const ImageView& image, const TagGuess& guess,
                             const TagPattern& pattern);

}  // namespace calvin::detect
