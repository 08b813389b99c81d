// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board on paper, to true scale.
//
// The page holds the pattern with a white border of at least half a square (and 5 mm, which
// printers leave white anyway), and below it one line with the board text and a ruler that tells
// whether the printer kept the scale. The square outside control point 0, at the top left of the
// page, is dark (target/board.hpp).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

enum class DrawingFormat { kSvg, kPdf, kPng };

inline constexpr double kDefaultDpi = 300;

struct DrawingOptions {
  DrawingFormat format = DrawingFormat::kPdf;

  // A name of paper_names(), or "auto" (the smallest of A4 to A0 on which the board fits, else
  // "fit"), or "fit" (as large as the board needs). The paper is turned as the board needs it.
  std::string paper = "auto";

  double dpi = kDefaultDpi;  // of a PNG, 20 to 2400; stored in the file
};

// The file's bytes, for write_file(). Errors: kInvalidArgument for an unknown paper, a board that
// does not fit (the message names a paper or a square size that would do) and a PNG of too many
// pixels; kUnsupported where the library was built without Cairo.
[[nodiscard]] Result<std::string> draw_board(const Board& board, const DrawingOptions& options);

// Where the pattern lies on its page; what draw_board() draws, for tests and for renderers.
struct BoardLayout {
  double width = 0;   // of the page, m
  double height = 0;  // m
  double x = 0;       // of control point 0, from the left edge of the page, m
  double y = 0;       // from the top edge, m
};
[[nodiscard]] Result<BoardLayout> lay_out_board(const Board& board, std::string_view paper);

// By the extension of a file's name: .svg, .pdf, .png in any case.
[[nodiscard]] Result<DrawingFormat> drawing_format(std::string_view path);

// "a4", "a3", ..., "letter", ...: from small to large.
[[nodiscard]] std::vector<std::string> paper_names();

}  // namespace calvin
