// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words of every hint.

#include "calvin/session/guidance/hint.hpp"

#include <fmt/format.h>

namespace calvin {

namespace {

const char* move_text(HintDirection to) {
  switch (to) {
    case HintDirection::kLeft:
      return "Move the board to the left side of the image.";
    case HintDirection::kRight:
      return "Move the board to the right side of the image.";
    case HintDirection::kTop:
      return "Move the board to the top of the image.";
    case HintDirection::kBottom:
      return "Move the board to the bottom of the image.";
    case HintDirection::kUpperLeft:
      return "Move the board to the upper left of the image.";
    case HintDirection::kUpperRight:
      return "Move the board to the upper right of the image.";
    case HintDirection::kLowerLeft:
      return "Move the board to the lower left of the image.";
    case HintDirection::kLowerRight:
      return "Move the board to the lower right of the image.";
    case HintDirection::kNone:
      break;
  }
  return "Move the board to another side of the image.";
}

const char* tilt_text(HintDirection edge) {
  switch (edge) {
    case HintDirection::kLeft:
      return "Tilt the board: its left edge nearer to the camera.";
    case HintDirection::kRight:
      return "Tilt the board: its right edge nearer to the camera.";
    case HintDirection::kTop:
      return "Tilt the board: its top edge nearer to the camera.";
    case HintDirection::kBottom:
      return "Tilt the board: its bottom edge nearer to the camera.";
    default:
      break;
  }
  return "Tilt the board more, and turn it a little.";
}

// From where the board is now.
const char* way_text(HintDirection to) {
  switch (to) {
    case HintDirection::kLeft:
      return "left";
    case HintDirection::kRight:
      return "right";
    case HintDirection::kTop:
      return "up";
    case HintDirection::kBottom:
      return "down";
    case HintDirection::kUpperLeft:
      return "left and up";
    case HintDirection::kUpperRight:
      return "right and up";
    case HintDirection::kLowerLeft:
      return "left and down";
    case HintDirection::kLowerRight:
      return "right and down";
    case HintDirection::kNone:
      break;
  }
  return "elsewhere";
}

const char* edge_text(HintDirection edge) {
  switch (edge) {
    case HintDirection::kLeft:
      return "its left edge";
    case HintDirection::kRight:
      return "its right edge";
    case HintDirection::kTop:
      return "its top edge";
    default:
      return "its bottom edge";
  }
}

}  // namespace

std::string to_text(const Hint& hint) {
  switch (hint.kind) {
    case HintKind::kComeCloser:
      return "Come closer with the board.";
    case HintKind::kMoveBack:
      return "Move the board away from the camera.";
    case HintKind::kMove:
      return move_text(hint.direction);
    case HintKind::kTilt:
      return tilt_text(hint.direction);
    case HintKind::kHoldStill:
      return "Hold the board still.";
    case HintKind::kGood:
      return "Good: other tilts and places make it better still.";
    case HintKind::kDone:
      return "Done: nothing more is needed.";
    case HintKind::kShowBoard:
      break;
  }
  return "Show the whole board to the camera.";
}

std::string text_to_outline(const Hint& hint) {
  using enum HintKind;
  const auto distance_text = [](HintKind kind) {
    return kind == kComeCloser ? "come closer" : "move away from the camera";
  };
  const bool is_vague = hint.direction == HintDirection::kNone;
  if (is_vague && (hint.kind == kMove || hint.kind == kTilt)) return to_text(hint);
  switch (hint.kind) {
    case kMove: {
      const std::string also = hint.also ? fmt::format(", and {}", distance_text(*hint.also)) : "";
      return fmt::format("To the outline: move {} in the image{}.", way_text(hint.direction), also);
    }
    case kComeCloser:
    case kMoveBack: {
      const std::string also =
          hint.also ? fmt::format(", {} nearer than the other", edge_text(hint.direction)) : "";
      return fmt::format("To the outline: {}{}.", distance_text(hint.kind), also);
    }
    case kTilt:
      return fmt::format("To the outline: tilt the board, {} nearer to the camera.",
                         edge_text(hint.direction));
    default:
      return to_text(hint);
  }
}

std::string done_text(std::string_view location) {
  return fmt::format("Done: the calibration is in '{}'.", location);
}

}  // namespace calvin
