// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which board is in a picture, where nobody said. Internal.
#pragma once

#include <stop_token>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

struct IdentifiedBoard {
  Board board;
  // All of its margins are in view; else it may have more rows or columns than were seen.
  bool whole = false;
  // Only in a mirror the picture has this board: the video is flipped.
  bool mirrored = false;
};

// The boards of any kind that a picture shows, those with a code first: PuzzleBoards, ChArUco
// boards, AprilGrids and grids of three tags and more of all dictionaries that this build knows,
// checkerboards with circles, grids of circles without marks, and checkerboards where nothing else
// is seen. No picture tells lengths: squares, tags and distances of circles have sides of `side` m,
// and what is beside them is as much of it as it is seen to be; gaps between tags are told to a
// hundredth of a tag, and are certain where they are a multiple of a twentieth. Takes some ten
// times as long as the search for a board that is known. Any image will do; empty where nothing is
// seen, where a stop was requested, and where there is no memory.
[[nodiscard]] std::vector<IdentifiedBoard> identify_boards(const ImageView& image, double side,
                                                           std::stop_token stop = {});

}  // namespace calvin
