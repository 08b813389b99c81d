// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a PuzzleBoard answers, and the two codes that make its map.

#include "calvin/target/puzzle_board.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

constexpr int kPeriod = 167;
constexpr int kLines = 3;
using Code = std::array<std::string_view, kLines>;

// A '1' is a light dot. The first code is of the dots that part two corners of a column, the second
// one, on its side, of those that part two of a row.
constexpr Code kDown = {
    "000010111000011101010101001000110101101100001110111000101001000100011111100000101011"
    "11110100110010010101110101110000111111011011010110011011111011100111101001111010001",
    "011000011111101111111101000100100000111100010011000001000100011000011000000111000110"
    "10100011101110101101110110010010000110100110001110101000111000100110001111010100100",
    "010000010100001110100001111010111110100000100100100001011101001101100111010110101100"
    "10110010010010110011001011110111001110000000101011011111010110110011000011110100011",
};
constexpr Code kAcross = {
    "111110101001111110000101001101111001000001001100100111111000110100011101101001000010"
    "00111001111010000000100111000000010111110010110101111101110100101101011001001110010",
    "101100110001001101011001110110000110101000100101010110000010110000001110000010110110"
    "00011111010101101101100011001111001001001010111011011001110011001011100011100011001",
    "001100000101010001111010100101100001100100100000001100001111010001111011001010101001"
    "00101001011111101000000010110101101011111110001000111101011101100101000011011111111",
};

int wrapped(int x, int period) { return ((x % period) + period) % period; }

bool is_one(const Code& code, int line, int at) {
  return code[static_cast<std::size_t>(wrapped(line, kLines))]
             [static_cast<std::size_t>(wrapped(at, kPeriod))] == '1';
}

}  // namespace

bool PuzzleBoard::is_light_after(GridPlace p) const noexcept {
  return is_one(kAcross, x0 + p.col, y0 + p.row);
}

bool PuzzleBoard::is_light_below(GridPlace p) const noexcept {
  return is_one(kDown, y0 + p.row, x0 + p.col);
}

std::string PuzzleBoard::text() const {
  std::string text = fmt::format("puzzle:{}x{}:{}", cols, rows, length_text(size));
  if (x0 != 0 || y0 != 0) text += fmt::format(":{},{}", x0, y0);
  return text;
}

Status PuzzleBoard::check() const {
  if (const Status status = grid().check(); !status) return status;
  if (x0 < 0 || y0 < 0 || x0 >= kMapSide || y0 >= kMapSide) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The map of PuzzleBoards has no place {},{}: it has {} x {}.", x0,
                                  y0, kMapSide, kMapSide));
  }
  return {};
}

bool PuzzleBoard::looks_like(const PuzzleBoard& other) const noexcept {
  return cols == other.cols && rows == other.rows && x0 == other.x0 && y0 == other.y0;
}

}  // namespace calvin
