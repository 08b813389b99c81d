// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The grid of tags that nobody asked for: which one it is by the ids of its tags and how they lie.
#pragma once

#include <optional>
#include <stop_token>

#include "calvin/core/image.hpp"
#include "calvin/target/board.hpp"

namespace calvin::detect {

struct AnyTags {
  Board board;         // a TagGrid or, where rows are counted from the lowest one, an AprilGrid
  bool whole = false;  // tags that went on at any side would be in view
};

struct TagsInView {
  std::optional<AnyTags> grid;
  bool of_april_tag = false;  // two tags or more of one of AprilTag's families
};

// Of any dictionary, in any way round, inverted or not, with borders of one or two cells; tags have
// sides of `side` m, and gaps as much of it as they are seen to have, to a hundredth. Of the
// dictionaries that begin with the same tags it is the smallest. No grid for fewer than three tags
// side by side, and where no numbering explains their ids.
[[nodiscard]] TagsInView find_any_tags(const ImageView& image, double side,
                                       const std::stop_token& stop);

}  // namespace calvin::detect
