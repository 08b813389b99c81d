// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig, calvin-hand-eye and calvin-solve: the board of --board, beside those that a file of
// observations tells by itself.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/target/board.hpp"

namespace given_board {

// What is looked for in pictures, where `board`, that of --board, is empty.
inline std::string or_usual(const std::string& board) {
  return board.empty() ? std::string(calvin::kDefaultBoard) : board;
}

// Whether two boards are one sheet of which another size was said or measured: the same control
// points, which are in the same places but for a scale.
inline bool is_resized(const calvin::Board& board, const calvin::Board& other) {
  constexpr double kAlike = 0.02;  // of the size of the board; measured gaps of tags differ by less
  if (!board.looks_like(other) || board.ids() != other.ids()) return false;
  const auto points = board.points();
  const auto others = other.points();
  double along = 0;
  double squares = 0;
  double farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    along += points[i].dot(others[i]);
    squares += points[i].squaredNorm();
    farthest = std::max(farthest, others[i].norm());
  }
  const double scale = squares > 0 ? along / squares : 1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((scale * points[i] - others[i]).norm() > kAlike * farthest) return false;
  }
  return true;
}

// The boards of one file of observations.
class BoardsOfFile {
 public:
  // `given`: the text of --board, or empty.
  BoardsOfFile(std::string path, const std::string& given) : path_(std::move(path)), text_(given) {}

  // The board that a text of the file stands for: the one of its size in --board, which corrects
  // what the file says. An error where --board has none of its kind.
  calvin::Result<calvin::Board> board_of(const std::string& text) {
    const auto known = boards_.find(text);
    if (known != boards_.end()) return known->second;
    const auto own = calvin::parse_boards(text);
    if (!own) return tl::unexpected<calvin::Error>(own.error());
    auto board = corrected(own->front());
    if (board) boards_.emplace(text, *board);
    return board;
  }

 private:
  calvin::Result<calvin::Board> corrected(const calvin::Board& own) {
    if (text_.empty()) return own;
    const auto given = calvin::parse_boards(text_);
    if (!given) return tl::unexpected<calvin::Error>(given.error());
    if (std::ranges::find(*given, own) != given->end()) return own;
    const auto resized =
        std::ranges::find_if(*given, [&](const auto& one) { return is_resized(own, one); });
    if (resized == given->end()) {
      return calvin::make_error(
          calvin::ErrorCode::kInvalidArgument,
          fmt::format(
              "'{}' has views of the board '{}', and --board is '{}': leave --board out, or "
              "give the board of the file with the size that was measured.",
              path_, own.text(), text_));
    }
    if (told_.insert(own.text()).second) {
      fmt::print("{} has views of the board '{}', which is taken as '{}', as --board says.\n",
                 path_, own.text(), resized->text());
    }
    return *resized;
  }

  std::string path_;
  std::string text_;
  std::map<std::string, calvin::Board> boards_;  // by the texts of the file
  std::set<std::string> told_;
};

}  // namespace given_board
