// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks tags up in their family, and lays rows of consecutive ids.

#include "calvin/detect/checkerboard/code/april_tags.hpp"

#include <algorithm>
#include <cstdint>

namespace calvin::detect {

namespace {

constexpr std::size_t kFewestTags = 4;

// The tag whose bits, from the upper left in rows, a number has from its highest bit on.
std::optional<int> find_tag(const AprilGrid& family, std::uint64_t seen) {
  // In the dictionary tags are the other way up: their bits are in the opposite order.
  const int count = family.dictionary->side * family.dictionary->side;
  std::uint64_t code = 0;
  for (int i = 0; i < count; ++i) code |= (seen >> i & 1) << (count - 1 - i);
  const auto& codes = family.dictionary->codes;
  const auto known = std::ranges::find(codes, code);
  if (known == codes.end()) return std::nullopt;
  return static_cast<int>(known - codes.begin());
}

}  // namespace

std::vector<SeenTag> tags_in(const AprilGrid& family, std::span<const CodeBit> bits) {
  const auto count = static_cast<std::size_t>(family.dictionary->side * family.dictionary->side);
  std::vector<SeenTag> tags;
  for (std::size_t from = 0; from < bits.size();) {
    const Cell cell = bits[from].at.cell;
    std::size_t to = from;
    std::uint64_t seen = 0;
    for (; to < bits.size() && bits[to].at.cell == cell; ++to) {
      seen |= std::uint64_t{bits[to].light}
              << (count - 1 - static_cast<std::size_t>(bits[to].at.index));
    }
    const auto id = to - from == count ? find_tag(family, seen) : std::nullopt;
    if (id) tags.push_back({cell, *id});
    from = to;
  }
  return tags;
}

std::optional<AprilGrid> grid_of_tags(std::span<const SeenTag> tags, const AprilGrid& like) {
  if (tags.size() < kFewestTags) return std::nullopt;
  Cell from = tags[0].cell;
  Cell to = from;
  for (const SeenTag& tag : tags) {
    from = {std::min(from.col, tag.cell.col), std::min(from.row, tag.cell.row)};
    to = {std::max(to.col, tag.cell.col), std::max(to.row, tag.cell.row)};
  }
  AprilGrid board = like;
  board.cols = (to.col - from.col) / 2 + 1;
  board.rows = (to.row - from.row) / 2 + 1;
  const auto place = [from](const SeenTag& t) {
    return Cell{(t.cell.col - from.col) / 2, (t.cell.row - from.row) / 2};
  };
  board.first = 0;
  board.first = tags[0].id - board.tag_in(place(tags[0]).col, place(tags[0]).row);
  const bool agree = std::ranges::all_of(tags, [&](const SeenTag& t) {
    const Cell at = place(t);
    return t.id == board.tag_in(at.col, at.row);
  });
  if (!agree || board.rows < 2 || !board.check()) return std::nullopt;
  return board;
}

}  // namespace calvin::detect
