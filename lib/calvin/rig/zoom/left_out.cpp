// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Leaves out each setting of a zoom table in turn.

#include "calvin/rig/zoom/left_out.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/zoom_interpolation.hpp"
#include "calvin/solve/difference.hpp"

namespace calvin {

namespace {

// Of every setting: whether the table without it still has both its sides.
std::vector<bool> has_both_sides(const ZoomTable& table) {
  std::vector<bool> both(table.settings.size(), false);
  const auto groups = groups_of(table);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const auto [begin, end] = groups[g];
    if (end - begin == 1) both[begin] = g > 0 && g + 1 < groups.size();
    for (std::size_t i = begin + 1; i + 1 < end; ++i) both[i] = true;
  }
  return both;
}

std::optional<double> left_out(const ZoomTable& table, std::size_t index) {
  const Calibration& own = table.settings[index].calibration;
  ZoomTable others = table;
  others.settings.erase(others.settings.begin() + static_cast<std::ptrdiff_t>(index));
  const auto between = interpolate(others, {own.zoom, own.focus});
  const auto a = Camera::make(own);
  const auto b = between ? Camera::make(between->calibration) : a;
  if (!a || !between || !b) return std::nullopt;
  DifferenceOptions options;
  if (own.covered.size() >= 3) options.focus.push_back(own.covered);
  const auto all = difference(*a, *b, options);
  return all ? std::optional(all->focus.max) : std::nullopt;
}

}  // namespace

ZoomTable with_left_out(ZoomTable table) {
  const std::vector<bool> wanted = has_both_sides(table);
  std::vector<std::optional<double>> found(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (wanted[i]) found[i] = left_out(table, i);
  }
  for (std::size_t i = 0; i < found.size(); ++i) table.settings[i].left_out = found[i];
  return table;
}

std::optional<double> largest_left_out(const ZoomTable& table) {
  std::optional<double> largest;
  for (const ZoomSetting& setting : table.settings) {
    if (setting.left_out) largest = std::max(largest.value_or(0), *setting.left_out);
  }
  return largest;
}

}  // namespace calvin
