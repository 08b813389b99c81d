// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// That no part of the map of PuzzleBoards is mistaken for another one.
#include <cstdint>
#include <set>
#include <unordered_set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr int kSide = PuzzleBoard::kMapSide;
constexpr PuzzleBoard kMap = {kSide, kSide, 0.01};

// The dots between n x n corners: those after a corner of its row and those below it.
struct Window {
  int n;
  std::vector<bool> after;  // n - 1 of each row
  std::vector<bool> below;  // n of each row but the last

  Window(int size, int x, int y) : n(size) {
    for (int row = 0; row < n; ++row) {
      for (int col = 0; col + 1 < n; ++col) {
        after.push_back(kMap.is_light_after({x + col, y + row}));
      }
    }
    for (int row = 0; row + 1 < n; ++row) {
      for (int col = 0; col < n; ++col) below.push_back(kMap.is_light_below({x + col, y + row}));
    }
  }

  // By a quarter to the right: what was a column upwards is a row.
  void turn() {
    std::vector<bool> new_after;
    std::vector<bool> new_below;
    const auto at = [](int row, int col, int cols) {
      return static_cast<std::size_t>(row * cols + col);
    };
    for (int row = 0; row < n; ++row) {
      for (int col = 0; col + 1 < n; ++col) new_after.push_back(below[at(n - 2 - col, row, n)]);
    }
    for (int row = 0; row + 1 < n; ++row) {
      for (int col = 0; col < n; ++col) new_below.push_back(after[at(n - 1 - col, row, n - 1)]);
    }
    after = std::move(new_after);
    below = std::move(new_below);
  }

  [[nodiscard]] std::uint64_t bits() const {
    std::uint64_t all = 0;
    for (const bool bit : after) all = all << 1 | (bit ? 1 : 0);
    for (const bool bit : below) all = all << 1 | (bit ? 1 : 0);
    return all;
  }
};

// How many of the windows of the map, in so many turns, are like an earlier one.
int repeated(int n, int turns) {
  std::unordered_set<std::uint64_t> seen;
  int count = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      Window window(n, x, y);
      for (int turn = 0; turn < turns; ++turn, window.turn()) {
        if (!seen.insert(window.bits()).second) ++count;
      }
    }
  }
  return count;
}

TEST(PuzzleCode, ThreeByThreeSquaresOccurOnceTheRightWayUp) { EXPECT_EQ(repeated(4, 1), 0); }

TEST(PuzzleCode, FourByFourSquaresOccurOnceInAnyTurn) { EXPECT_EQ(repeated(5, 4), 0); }

// That fewer squares are not enough shows that repeats are seen.
TEST(PuzzleCode, FewerSquaresDoNot) {
  EXPECT_GT(repeated(3, 1), 0);
  EXPECT_GT(repeated(4, 4), 0);
}

// The codes of the paper: any 3 x 3 dots of one direction tell the place within 3 x 167.
TEST(PuzzleCode, ThreeByThreeDotsOfOneDirectionTellTheirPlace) {
  std::set<int> after;
  std::set<int> below;
  for (int line = 0; line < 3; ++line) {
    for (int at = 0; at < 167; ++at) {
      int a = 0;
      int b = 0;
      for (int i = 0; i < 9; ++i) {
        a = a << 1 | (kMap.is_light_after({line + i % 3, at + i / 3}) ? 1 : 0);
        b = b << 1 | (kMap.is_light_below({at + i % 3, line + i / 3}) ? 1 : 0);
      }
      after.insert(a);
      below.insert(b);
    }
  }
  EXPECT_EQ(after.size(), 501u);
  EXPECT_EQ(below.size(), 501u);
}

TEST(PuzzleBoard, IsThePartOfTheMapThatBeginsAtItsPlace) {
  const PuzzleBoard board = {9, 7, 0.02, 495, 230};
  for (int row = -3; row < 12; ++row) {
    for (int col = -3; col < 12; ++col) {
      const GridPlace in_map{495 + col, 230 + row};
      EXPECT_EQ(board.is_light_after({col, row}), kMap.is_light_after(in_map));
      EXPECT_EQ(board.is_light_below({col, row}), kMap.is_light_below(in_map));
      EXPECT_EQ(board.is_dark_before({col, row}), kMap.is_dark_before(in_map));
    }
  }
  EXPECT_EQ(kMap.is_light_after({-1, -1}), kMap.is_light_after({kSide - 1, kSide - 1}));
}

}  // namespace
}  // namespace calvin
