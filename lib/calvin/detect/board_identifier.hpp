// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// When a video is searched for boards that nobody asked for, and what is made of what it shows.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/result.hpp"
#include "calvin/detect/identify.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

// What is looked for where the text names no board.
struct AutoBoard {
  double side = 0;         // m, that squares, tags or distances of circles are said to have
  bool is_puzzle = false;  // a PuzzleBoard of any size, from anywhere in its map
  std::string_view text() const { return is_puzzle ? "puzzle:auto" : "auto"; }
};

// "auto", "auto:25mm", "puzzle:auto" and "puzzle:auto:25mm"; absent for every other text.
[[nodiscard]] std::optional<Result<AutoBoard>> parse_auto_board(std::string_view text);

class BoardIdentifier {
 public:
  // For `wanted`, whose first board tells what side a board that is seen is said to have.
  explicit BoardIdentifier(std::vector<Board> wanted);
  explicit BoardIdentifier(const AutoBoard& any) : any_(any), side_(any.side) {}

  // To be asked once for each frame: whether it is to be looked at. Where any board will do, until
  // one was taken; else where no board was found for a while, and then once in a while.
  [[nodiscard]] bool is_due(bool found);
  void look(const ImageView& image, std::stop_token stop);

  // The board that is certainly the one in view, where any will do: all of it was seen, and its
  // code says so or two looks have said the same. Absent where it is the one that was taken last.
  [[nodiscard]] std::optional<Board> certain() const;
  void take(const Board& board);

  // What is in view in place of the boards that are wanted, for whoever shows it; empty where
  // nobody knows.
  [[nodiscard]] std::string hint() const;
  // Whether a code says what is in view.
  [[nodiscard]] bool sees_code() const;

 private:
  [[nodiscard]] bool is_any() const { return wanted_.empty(); }
  [[nodiscard]] bool is_sure() const;
  // Whether any board may be this one.
  [[nodiscard]] bool will_do(const Board& board) const;

  std::vector<Board> wanted_;
  AutoBoard any_;    // where none is wanted
  double side_ = 0;  // m
  int without_ = 0;  // frames without a board
  std::optional<IdentifiedBoard> seen_;
  int alike_ = 0;  // looks that have said the same as the last one
  std::optional<Board> taken_;
};

}  // namespace calvin
