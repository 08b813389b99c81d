// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards by name, and several at once: "checkerboard:9x6:25mm;boards.json#floor"; points of a file,
// "points:FILE" (io/point_rows.hpp).
//
// A file of names is JSON, in UTF-8; keys that are not known here are kept as they are:
//   {"format": "calvin-boards", "version": 1, "boards": {"floor": "checkerboard:9x6:25mm"}}
// A board that was measured is {"board": TEXT, "shape": {...}} in place of its text: this very
// sheet. A name stands for one board text, never for another name, and stands once. It has 1 to 64
// bytes and neither '#', ';', control characters nor a space at its ends. A file has at most 1 MiB,
// and its values lie at most 64 deep in each other.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/result.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/measured/board_measurement.hpp"

namespace calvin {

inline constexpr int kMaxBoards = 16;

// The boards of a `board` property: board texts, points:FILE and FILE.json#NAME, separated by ';'.
// At least one, at most kMaxBoards. A board that is there twice is one of which two sheets are in
// view; two boards of the same corners, either way round, that are not the same look alike and are
// refused. Every error shows a right text; kNotFound where a file or a name is missing.
[[nodiscard]] Result<std::vector<Board>> parse_boards(std::string_view text);

// Whether parse_boards() reads a file: for whoever must not wait for a disk or a network.
[[nodiscard]] bool names_a_file(std::string_view text);

struct NamedBoard {
  std::string name;
  std::string text;             // as the file has it: parse_board() tells whether it is right
  std::size_t measured_by = 0;  // views; 0: it was not measured
};

// The boards of a file, in its order.
[[nodiscard]] Result<std::vector<NamedBoard>> list_boards(const std::string& path);

// Adds a board to a file, or replaces the one of that name in place; the file is created where
// there is none and replaced atomically. `text` must be one right board text; its canonical form is
// stored. The shape of a board that is replaced by another one is dropped. A file that is not one
// of board names is left alone and is an error.
[[nodiscard]] Status add_board(const std::string& path, std::string_view name,
                               std::string_view text);

// What was measured of the first board of a `board` property that is one of a file and was
// measured; null where none was. Errors are those of parse_boards(), and kMalformed for a shape
// that is not one of its board.
[[nodiscard]] Result<std::shared_ptr<const BoardMeasurement>> read_measurement(
    std::string_view text);

// Stores what was measured under a name that the file has already, for the same board; the file is
// replaced atomically. kInvalidArgument where `named` is not FILE.json#NAME or the board differs.
[[nodiscard]] Status store_measurement(std::string_view named, const BoardMeasurement& measured);

}  // namespace calvin
