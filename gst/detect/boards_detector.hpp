// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the property `board` makes: the detector of its boards, and what tells other ones.
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/detect/board_identifier.hpp"
#include "calvin/detect/detector.hpp"
#include "common/metas.hpp"

namespace calvin::gst {

class BoardsDetector;
using SharedDetector = std::shared_ptr<const BoardsDetector>;

// Shared by the jobs of one worker, which use it one after the other.
class BoardsDetector {
 public:
  // Reads the file of names where `text` names one. Without boards where it is "auto": one is taken
  // when it is certain which one is in view. Points of a file (points:FILE) are never found: they
  // are chosen by hand.
  [[nodiscard]] static Result<SharedDetector> make(const std::string& text);

  [[nodiscard]] const std::vector<Board>& boards() const { return boards_; }
  // The board of a detection; nullptr where none was taken yet.
  [[nodiscard]] const Board* board_of(const Detection& detection) const {
    return detection.board < boards_.size() ? &boards_[detection.board] : nullptr;
  }

  // What is seen in the next frame: for each board a detection, or one of no board.
  [[nodiscard]] std::vector<Detection> follow(const ImageView& image, std::uint64_t timestamp,
                                              const std::stop_token& stop) const;

  // Where nothing was found for a while: notes which board is in view in place of the wanted ones.
  // Returns the detector of a board that is to be used from here on, where any will do.
  [[nodiscard]] SharedDetector identify(const ImageView& image,
                                        const std::vector<Detection>& detections,
                                        const std::stop_token& stop) const;

  // What keeps a board from being found, in words; empty where nobody knows.
  [[nodiscard]] DetectorHint hint_of(const Detection& detection, bool dark) const;

 private:
  std::vector<Board> boards_;                    // as `board` lists them
  std::string any_;                              // the text where it lists none
  std::unique_ptr<Detector> detector_;           // null where there is nothing to look for
  std::shared_ptr<BoardIdentifier> identifier_;  // null where nothing but points is wanted
};

}  // namespace calvin::gst
