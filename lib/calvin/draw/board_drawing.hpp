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
#include "calvin/draw/board/layout.hpp"
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

// Over several sheets of a paper, options.paper, which are cut along their marks and glued edge to
// edge: a PDF of as many pages, or an SVG or PNG for each, row by row. "auto" is A4. Errors are
// those of draw_board() and lay_out_tiles().
[[nodiscard]] Result<std::vector<std::string>> draw_tiles(const Board& board,
                                                          const DrawingOptions& options);

// By the extension of a file's name: .svg, .pdf, .png in any case.
[[nodiscard]] Result<DrawingFormat> drawing_format(std::string_view path);

}  // namespace calvin
