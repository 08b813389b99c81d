// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a grid of tags answers.

#include "calvin/target/tag_grid.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board_name.hpp"

namespace calvin {

std::optional<GridPlace> TagGrid::place_of(int id) const noexcept {
  const Grid tags{cols, rows, tag};
  if (id < first || id - first >= tags.count()) return std::nullopt;
  return tags.place(id - first);
}

bool TagGrid::is_dark(int id, int col, int row) const {
  const int last = cells() - 1;
  const int depth = std::min({col, row, last - col, last - row});
  if (depth >= 0 && depth < border) return !dictionary->has_light_rim();
  const int own_col = col - border;
  const int own_row = row - border;
  if (dictionary->bit_at(own_col, own_row) >= 0) return !is_light(id, own_col, own_row);
  // The ring, and what a tag leaves free in its middle; the corners of a round tag are paper.
  return depth >= -1 && dictionary->has_light_rim();
}

std::string TagGrid::text() const {
  const std::string measures =
      fmt::format("{}x{}:{}:{}", cols, rows, length_text(tag), length_text(gap));
  const std::string_view name = dictionary == nullptr ? "" : dictionary->name;
  std::string all = april ? fmt::format("apriltag:{}:{}", family_name(name), measures)
                          : fmt::format("aruco:{}:{}", measures, name);
  if (first != 0) all += fmt::format(":first={}", first);
  if (border != kUsualBorder) all += fmt::format(":border={}", border);
  if (inverted) all += ":inverted";
  return all;
}

Status TagGrid::check() const {
  const auto refuse = [&](std::string why) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The board {} does not exist: {}.", text(), why));
  };
  if (const Status status = grid().check(); !status) return status;
  if (dictionary == nullptr) return refuse("it has no dictionary of tags");
  if (border != 1 && border != 2) return refuse("borders of tags are 1 or 2 bits wide");
  if (dictionary->outside > 0 && border != 1) {
    return refuse(fmt::format("borders of {} are 1 bit wide", dictionary->name));
  }
  if (dictionary->outside > 0 && !april) {
    return refuse(
        fmt::format("{} are AprilTags, of apriltag:{}:...", dictionary->name, dictionary->name));
  }
  // What is between two tags has to be seen where a bit of them can be read.
  if (!(2 * gap * cells() >= tag))
    return refuse(fmt::format("{} at least half as wide as a bit of a tag, {}",
                              cols * rows > 1
                                  ? "gaps are"
                                  : "what is free around a single tag, in the place of the gap, is",
                              length_text(tag / cells() / 2)));
  constexpr double kRounded = 1e-6;  // of a tag: texts have lengths to a nanometre
  if (cols * rows > 1 && gap < (least_gap_share() - kRounded) * tag) {
    return refuse(fmt::format(
        "tags of {} have bits outside of their borders, so that gaps between borders are at least "
        "{} of a tag's side",
        dictionary->name, format_double(std::ceil(1000 * least_gap_share()) / 1000)));
  }
  const auto known = static_cast<int>(dictionary->codes.size());
  if (first < 0 || first >= known || cols * rows > known - first) {
    return refuse(fmt::format("it needs {} tags from {} on, {} has {}", cols * rows, first,
                              dictionary->name, known));
  }
  return {};
}

BoardArea TagGrid::outline() const noexcept {
  const BoardArea tags = grid().extent();
  const double around =
      dictionary == nullptr ? gap : std::max(gap, tag / cells() * (dictionary->outside + 1));
  return {tags.left - around, tags.top - around, tags.right + around, tags.bottom + around};
}

bool TagGrid::looks_like(const TagGrid& other) const noexcept {
  TagGrid same_size = other;
  same_size.tag = tag;
  same_size.gap = gap;
  return *this == same_size;
}

TagGrid TagGrid::with_cells_of(double side) const noexcept {
  TagGrid other = *this;
  other.tag = side;
  other.gap = gap / tag * side;
  return other;
}

}  // namespace calvin
