// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What to show a camera next, for programs and, as a sentence, for users.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "calvin/core/calibration.hpp"

namespace calvin {

enum class HintKind {
  kShowBoard,   // no view is kept yet
  kComeCloser,  // no view shows the board large enough, or it is to be nearer than it is
  kMoveBack,    // it is to be farther away than it is
  kMove,        // the board, to the side of the image that the direction names
  kTilt,        // the edge that the direction names nearer to the camera; kNone: more, any way
  kHoldStill,   // the board is where it is wanted
  kGood,        // all is there
  kDone,        // nothing more is captured
};

// A side or corner of the image for kMove, an edge of the board as the image shows it for kTilt.
// Where an outline shows the place, kMove is that way from where the board is now. hint.cpp has
// words for each, in this order.
enum class HintDirection {
  kNone,
  kLeft,
  kRight,
  kTop,
  kBottom,
  kUpperLeft,
  kUpperRight,
  kLowerLeft,
  kLowerRight,
};

struct Hint {
  HintKind kind = HintKind::kShowBoard;
  HintDirection direction = HintDirection::kNone;
  // What else is to be done on the way to an outline: kComeCloser or kMoveBack beside kMove; kTilt,
  // of the edge that `direction` names, beside kComeCloser and kMoveBack.
  std::optional<HintKind> also = std::nullopt;

  // camera_from_board of a view that does what the hint asks for, board upright. Absent for kGood,
  // and where nobody knows camera and board.
  std::optional<Pose> target = std::nullopt;
};

// Whether both ask for the same; where their targets are does not matter.
[[nodiscard]] inline bool operator==(const Hint& a, const Hint& b) {
  return a.kind == b.kind && a.direction == b.direction && a.also == b.also;
}

// "Move the board to the left side of the image." and the like, for every hint.
[[nodiscard]] std::string to_text(const Hint& hint);
// Likewise where an outline shows the place: "To the outline: move the board left and up in the
// image, and come closer."
[[nodiscard]] std::string text_to_outline(const Hint& hint);
// kDone, with the file that has the calibration.
[[nodiscard]] std::string done_text(std::string_view location);

}  // namespace calvin
