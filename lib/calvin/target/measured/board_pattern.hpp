// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the corners of a board have in common that are not where its text has them: a wrong length
// in the text or a stretched print shows as a pattern. Internal.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calvin/target/grid.hpp"

namespace calvin {

// Where the views have a corner of a board.
struct SeenOffset {
  GridPlace place;
  Eigen::Vector2d offset;       // m, in the plane of the board, from where the text has it
  Eigen::Vector2d information;  // per axis, in any unit
};

// A change of the text of a board that explains most of the offsets of its corners.
struct BoardPattern {
  enum class Kind {
    kAspect,  // `value` is how much longer the board is along x than along y, of its length, at the
              // least: another focal length along x may have done for the rest of it
    kGap,     // `value` is the gap from every second column and row to the next, of a pitch
  };
  Kind kind = Kind::kAspect;
  double value = 0;
  double printed = 0;  // what `value` is by the text
};

// Absent where no change explains them. A shift, a turn and a scale of the whole board are those of
// its pose and its distance.
[[nodiscard]] std::optional<BoardPattern> board_pattern(const Grid& grid,
                                                        const std::vector<SeenOffset>& corners);

// A sentence that follows one on corners that are not where they should be.
[[nodiscard]] std::string to_words(const BoardPattern& pattern);

}  // namespace calvin
