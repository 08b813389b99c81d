// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a detector returns, and the interface that the detector of every kind of board implements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/core/reason.hpp"

namespace calvin {

// What was seen of a board. `observation` has the corners that are in view and not covered, if
// enough of the board is; `reason` is then kAccepted, and otherwise says why there are none:
// kNotFound, or kWrongBoard (a checkerboard, but of another size or with its colours exchanged),
// with the inner corners that were seen, or kMoving (a light that leaves a long streak).
// `timestamp` and `camera` of the observation are left to the caller.
struct Detection {
  Observation observation;
  Reason reason = Reason::kNotFound;
  int seen_cols = 0;  // kWrongBoard only
  int seen_rows = 0;
  bool seen_all = false;  // kWrongBoard: where all margins are in view, that is the board's size
  // kWrongBoard: the text of the board, or of the part of it that is seen, where its code tells it;
  // lengths are those of the board that was looked for.
  std::string seen_board;
  std::string obstacle;   // what keeps a light from being found, for a user; else empty
  std::size_t board = 0;  // its place in the list that the detector was made for
};

// Finds boards. Control point 0 is always the same corner of the board, see target/board.hpp;
// where the board looks the same after a turn, it is the candidate nearest to the top left of the
// image, and Observation::ambiguous lists the other labellings: "rotate180" (by the board's own
// turns, or any where a part is in view), "shift(2,0)" (two columns more) where neither outer edge
// of the board tells the place along an axis, or both. Keeps memory from one image to the next; not
// to be shared between threads.
//
// The result of a list of boards: first one for each board of the list, in its order, found or not;
// then one for each further sheet that shows one of them. A board that is in the list twice is
// looked for until two sheets of it are found, however different their sizes; without that a
// further sheet is found where it is about as large in the image as the first. Empty where there is
// no memory.
class Detector {
 public:
  Detector() = default;
  Detector(const Detector&) = delete;
  Detector& operator=(const Detector&) = delete;
  virtual ~Detector() = default;

  // Any image will do, an empty one too. A requested stop is seen between the steps of the work;
  // every result is then kNotFound. Equal sheets come in the order of their distance from the top
  // left of the image.
  virtual std::vector<Detection> detect_all(const ImageView& image,
                                            std::stop_token stop = {}) noexcept = 0;

  // Detects the boards in the next frame of a video, at `timestamp` ns (kNoTimestamp: a frame after
  // the last one): sheets of the last frame are looked for where they are going, which is quicker;
  // the whole image is searched where one is not there any more, and once a second. Equal sheets
  // keep the places among the results that they had in the frame before.
  virtual std::vector<Detection> follow_all(const ImageView& image, std::uint64_t /*timestamp*/,
                                            std::stop_token stop = {}) noexcept {
    return detect_all(image, std::move(stop));
  }

  // The first result alone, for whoever has one board.
  Detection detect(const ImageView& image, std::stop_token stop = {}) noexcept {
    return first_of(detect_all(image, std::move(stop)));
  }
  Detection follow(const ImageView& image, std::uint64_t timestamp,
                   std::stop_token stop = {}) noexcept {
    return first_of(follow_all(image, timestamp, std::move(stop)));
  }

 private:
  static Detection first_of(std::vector<Detection> all) noexcept {
    return all.empty() ? Detection() : std::move(all.front());
  }
};

}  // namespace calvin
