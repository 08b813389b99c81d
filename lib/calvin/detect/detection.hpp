// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a detector returns, and the interface that the detector of every kind of board implements.
#pragma once

#include <cstdint>
#include <stop_token>
#include <utility>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"

namespace calvin {

// What was seen of the board. `observation` has the corners that are in view and not covered, if
// enough of the board is; `reason` is then kAccepted, and otherwise says why there are none:
// kNotFound, or kWrongBoard (a checkerboard, but of another size or with its colours exchanged),
// with the inner corners that were seen. `timestamp` and `camera` of the observation are left to
// the caller.
struct Detection {
  Observation observation;
  Reason reason = Reason::kNotFound;
  int seen_cols = 0;  // kWrongBoard only
  int seen_rows = 0;
};

// Finds one board. Control point 0 is always the same corner of the board, see target/board.hpp;
// where the board looks the same after a turn, it is the candidate nearest to the top left of the
// image, and Observation::ambiguous lists the other labellings: "rotate180" (by the board's own
// turns, or any where a part is in view), "shift(2,0)" (two columns more) where neither outer edge
// of the board tells the place along an axis, or both. Keeps memory from one image to the next; not
// to be shared between threads.
class Detector {
 public:
  Detector() = default;
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;
  virtual ~Detector() = default;

  // Any image will do, an empty one too. A requested stop is seen between the steps of the work;
  // the result is then kNotFound.
  virtual Detection detect(const ImageView& image, std::stop_token stop = {}) noexcept = 0;

  // Detects the board in the next frame of a video, at `timestamp` ns (kNoTimestamp: a frame after
  // the last one): a board of the last frame is looked for where it is going, which is quicker; the
  // whole image is searched where the board is not there any more, and once a second.
  virtual Detection follow(const ImageView& image, std::uint64_t /*timestamp*/,
                           std::stop_token stop = {}) noexcept {
    return detect(image, std::move(stop));
  }
};

}  // namespace calvin
