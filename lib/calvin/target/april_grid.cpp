// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What an AprilGrid answers.

#include "calvin/target/april_grid.hpp"

#include <cmath>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board_name.hpp"

namespace calvin {

namespace {

// Tags that are nearly as far apart as they are large cannot be told from what is between them.
constexpr double kLeastSpacing = 0.1;
constexpr double kMostSpacing = 0.7;

}  // namespace

std::string AprilGrid::text() const {
  std::string all =
      fmt::format("aprilgrid:{}x{}:{}:{}", cols, rows, length_text(tag), format_double(spacing));
  if (dictionary != nullptr && dictionary->name != kUsualFamily) {
    all += fmt::format(":{}", family_name(dictionary->name));
  }
  if (border != kUsualBorder) all += fmt::format(":border={}", border);
  if (first != 0) all += fmt::format(":first={}", first);
  return all;
}

Status AprilGrid::check() const {
  const auto refuse = [&](std::string why) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("The board {} does not exist: {}.", text(), why));
  };
  if (dictionary == nullptr) return refuse("it has no family of tags");
  if (dictionary->outside > 0) {
    return refuse(
        fmt::format("tags of {} have bits where the squares between tags would be; a "
                    "grid without squares is apriltag:{}:...",
                    dictionary->name, dictionary->name));
  }
  if (!(spacing >= kLeastSpacing && spacing <= kMostSpacing)) {
    return refuse(
        fmt::format("gaps are from {} to {} of a tag's side", kLeastSpacing, kMostSpacing));
  }
  if (border != 1 && border != 2) return refuse("borders of tags are 1 or 2 bits wide");
  const auto known = static_cast<int>(dictionary->codes.size());
  if (first < 0 || first >= known || cols * rows > known - first) {
    return refuse(fmt::format("it needs {} tags from {} on, {} has {}", cols * rows, first,
                              family_name(dictionary->name), known));
  }
  return grid().check();
}

bool AprilGrid::looks_like(const AprilGrid& other) const noexcept {
  AprilGrid same_size = other;
  same_size.tag = tag;
  return *this == same_size;
}

AprilGrid AprilGrid::with_cells_of(double side) const noexcept {
  AprilGrid other = *this;
  other.tag = side;
  return other;
}

}  // namespace calvin
