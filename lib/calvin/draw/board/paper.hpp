// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Papers, and how large a board is with its white border. Internal.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

inline constexpr double kCaptionHeight = 0.010;   // m, of the strip below the white border
inline constexpr double kSmallestBorder = 0.005;  // m, of white

struct Paper {
  std::string_view name;
  double width;  // m, upright
  double height;
  bool automatic;  // one of those that "auto" takes
};

// m, around the part of a sheet that is cut out: room for the marks, and what printers leave white.
inline constexpr double kTileMargin = 0.010;

// From small to large.
[[nodiscard]] std::span<const Paper> papers() noexcept;

// ASCII only and whatever the locale.
[[nodiscard]] std::string lower(std::string_view text);

// kInvalidArgument for a name that no paper has.
[[nodiscard]] tl::unexpected<Error> no_such_paper(std::string_view name, std::string_view others);

// m, of white around a board.
[[nodiscard]] double white_border(const Board& board);

// kInvalidArgument for a board that no sheet can show.
[[nodiscard]] Status check_printable(const Board& board);

}  // namespace calvin
