// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Compares tags by where they lie.

#include "calvin/detect/tags/sheet/sheet_conflicts.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace calvin::detect {

namespace {

constexpr std::size_t kOneOf = 8;  // of the tags of a sheet: one of many may be misread

// Whether a quad lies so many columns and rows from a tag, as the sides of that let it be expected.
// `off`: px, for each corner.
bool is_next_to(const Quad& tag, GridPlace way, double pitch, const Quad& quad, double off) {
  const std::array<Point, 2> across = {tag[1] - tag[0], tag[2] - tag[3]};  // the upper side first
  const std::array<Point, 2> down = {tag[3] - tag[0], tag[2] - tag[1]};    // the left side first
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& right = across[i < 2 ? 0 : 1];
    const Point& below = down[i == 0 || i == 3 ? 0 : 1];
    const Point expected = tag[i] + pitch * (way.col * right + way.row * below);
    if ((expected - quad[i]).squaredNorm() > off * off) return false;
  }
  return true;
}

// Whether the tag has no place there on the board of the sheet.
bool is_foreign(const TagGrid& board, GridPlace at, int id) {
  const bool is_inside = at.col >= 0 && at.row >= 0 && at.col < board.cols && at.row < board.rows;
  return !is_inside || board.tag_in(at.col, at.row) != id;
}

bool contradicts(const TagSheet& sheet, const NamedQuad& tag) {
  const TagGrid& board = sheet.board();
  const double pitch = 1 + board.gap / board.tag;
  constexpr double kOff = 0.25;  // of the shortest side
  return std::ranges::any_of(sheet.tags(), [&](const SheetTag& own) {
    const double off = kOff * shortest_side(own.fit.corners);
    for (const GridPlace way : {GridPlace{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const GridPlace at{own.place.col + way.col, own.place.row + way.row};
      if (is_foreign(board, at, tag.id) &&
          is_next_to(own.fit.corners, way, pitch, tag.corners, off)) {
        return true;
      }
    }
    return false;
  });
}

}  // namespace

bool lies_on(const TagSheet& sheet, const Quad& tag) {
  constexpr double kNear = 0.3;  // of the shortest side
  const Point centre = centre_of(tag);
  return std::ranges::any_of(sheet.tags(), [&](const SheetTag& own) {
    return (centre_of(own.fit.corners) - centre).norm() < kNear * shortest_side(own.fit.corners);
  });
}

bool overlap(const TagSheet& a, const TagSheet& b) {
  return std::ranges::any_of(b.tags(),
                             [&](const SheetTag& tag) { return lies_on(a, tag.fit.corners); });
}

bool is_of_another_board(const TagSheet& sheet, std::span<const NamedQuad> seen) {
  if (sheet.board().cols * sheet.board().rows == 1) return false;
  const auto count = static_cast<std::size_t>(
      std::ranges::count_if(seen, [&](const NamedQuad& tag) { return contradicts(sheet, tag); }));
  return count > 0 && kOneOf * count >= sheet.tags().size();
}

bool is_among_others(const TagSheet& sheet) {
  constexpr std::size_t kFewest = 2;  // the bits of one may be covered
  return sheet.others() >= kFewest && kOneOf * sheet.others() >= sheet.tags().size();
}

}  // namespace calvin::detect
