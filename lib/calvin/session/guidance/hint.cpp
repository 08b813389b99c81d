// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The words of every hint.

#include "calvin/session/guidance/hint.hpp"

#include <array>
#include <cstddef>
#include <string_view>

#include <fmt/format.h>

namespace calvin {

namespace {

// How a direction is told, in the order of HintDirection.
struct DirectionWords {
  std::string_view place;  // of the image
  std::string_view way;    // from where the board is
  std::string_view edge;   // of the board; of sides alone
};
constexpr std::array<DirectionWords, 9> kWords = {{
    {"another side", "elsewhere", ""},
    {"the left side", "left", "its left edge"},
    {"the right side", "right", "its right edge"},
    {"the top", "up", "its top edge"},
    {"the bottom", "down", "its bottom edge"},
    {"the upper left", "left and up", ""},
    {"the upper right", "right and up", ""},
    {"the lower left", "left and down", ""},
    {"the lower right", "right and down", ""},
}};

const DirectionWords& words_of(HintDirection direction) {
  return kWords[static_cast<std::size_t>(direction)];
}

std::string tilt_text(HintDirection edge) {
  const std::string_view name = words_of(edge).edge;
  if (name.empty()) return "Tilt the board more, and turn it a little.";
  return fmt::format("Tilt the board: {} nearer to the camera.", name);
}

}  // namespace

std::string to_text(const Hint& hint) {
  switch (hint.kind) {
    case HintKind::kComeCloser:
      return "Come closer with the board.";
    case HintKind::kMoveBack:
      return "Move the board away from the camera.";
    case HintKind::kMove:
      return fmt::format("Move the board to {} of the image.", words_of(hint.direction).place);
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
  const auto& [place, way, edge] = words_of(hint.direction);
  if (hint.kind == kMove) {
    const std::string also = hint.also ? fmt::format(", and {}", distance_text(*hint.also)) : "";
    return fmt::format("To the outline: move {} in the image{}.", way, also);
  }
  if (hint.kind == kComeCloser || hint.kind == kMoveBack) {
    const std::string also = hint.also ? fmt::format(", {} nearer than the other", edge) : "";
    return fmt::format("To the outline: {}{}.", distance_text(hint.kind), also);
  }
  if (hint.kind == kTilt && !edge.empty()) {
    return fmt::format("To the outline: tilt the board, {} nearer to the camera.", edge);
  }
  return to_text(hint);
}

std::string done_text(std::string_view location) {
  return fmt::format("Done: the calibration is in '{}'.", location);
}

}  // namespace calvin
