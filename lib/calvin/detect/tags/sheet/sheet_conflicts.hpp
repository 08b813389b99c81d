// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a picture shows against a sheet of tags.
#pragma once

#include <span>

#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/sheet/tag_sheet.hpp"

namespace calvin::detect {

// A tag that is seen somewhere.
struct NamedQuad {
  int id = 0;
  Quad corners;
};

// Whether a tag lies where the sheet has one.
[[nodiscard]] bool lies_on(const TagSheet& sheet, const Quad& tag);

// Whether two sheets have a tag at the same place of the picture.
[[nodiscard]] bool overlap(const TagSheet& a, const TagSheet& b);

// Whether some of the tags that are seen lie as next to one of the sheet's, the same way up, where
// the board has another one or none: then it is another board, of which a few rows are alike.
[[nodiscard]] bool is_of_another_board(const TagSheet& sheet, std::span<const NamedQuad> seen);

// Whether there are others where the tags of the sheet let some of the board be expected.
[[nodiscard]] bool is_among_others(const TagSheet& sheet);

}  // namespace calvin::detect
