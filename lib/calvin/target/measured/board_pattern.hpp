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
    kAspect,  // where `value` is positive the board is longer along x than along y, else shorter;
              // not by how much, as another focal length along x does for a part of it
    kGap,     // `value` is the gap from every second column and row to the next, of a pitch
  };
  Kind kind = Kind::kAspect;
  double value = 0;
  double printed = 0;  // what `value` is by the text
  double pitch = 0;    // m, by the text
};

// What is left of residuals knows all but shift, turn and scale of the whole board, which are those
// of its pose and its distance. A measured board has no stretch and no shear either.
enum class OffsetsOf { kResiduals, kMeasurement };

// Absent where no change explains them.
[[nodiscard]] std::optional<BoardPattern> board_pattern(const Grid& grid,
                                                        const std::vector<SeenOffset>& corners,
                                                        OffsetsOf of);

// A clause on corners that are not where they should be, and a sentence on what to do.
[[nodiscard]] std::string to_words(const BoardPattern& pattern);
[[nodiscard]] std::string advice(const BoardPattern& pattern);

}  // namespace calvin
