// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The AprilGrid that nobody asked for: which one it is by the ids of its tags.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/target/april_grid.hpp"

namespace calvin::detect {

struct SeenTag {
  Cell cell;  // of its upper left corner
  int id = 0;
};

// The tags of the family of a board whose bits were all read as the family has them. The bits of
// each tag follow each other.
[[nodiscard]] std::vector<SeenTag> tags_in(const AprilGrid& family, std::span<const CodeBit> bits);

// The board of which all columns, and as many rows, are there, with the measures of `like`. Absent
// where tags are too few or contradict each other, and where columns are missing.
[[nodiscard]] std::optional<AprilGrid> grid_of_tags(std::span<const SeenTag> tags,
                                                    const AprilGrid& like);

}  // namespace calvin::detect
