// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sheets paired with the places where sheets were nearest before.

#include "calvin/detect/checkerboard/sheets/sheet_places.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "calvin/geometry/pixels.hpp"

namespace calvin::detect {

SheetPlaces::SheetPlaces(std::span<const std::size_t> wanted) : listed_(wanted.size()) {
  for (std::size_t board = 0; board < listed_; ++board) {
    all_.push_back({board, wanted[board], {}, {}, nullptr});
  }
}

void SheetPlaces::begin() {
  for (SheetPlace& place : all_) place.sheet.reset();
}

void SheetPlaces::assign(std::span<const Sheet> sheets) {
  assign_nearest(sheets);
  assign_others(sheets);
  close_gaps();
  for (SheetPlace& place : all_) {
    if (place.sheet) place.last = sheets[*place.sheet].center();
  }
}

std::vector<std::size_t> SheetPlaces::without_place(std::span<const Sheet> sheets) const {
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    if (std::ranges::none_of(all_, [i](const SheetPlace& p) { return p.sheet == i; })) {
      left.push_back(i);
    }
  }
  return left;
}

void SheetPlaces::assign_nearest(std::span<const Sheet> sheets) {
  for (auto left = without_place(sheets); !left.empty(); left = without_place(sheets)) {
    SheetPlace* nearest = nullptr;
    std::size_t sheet = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : left) {
      for (SheetPlace& place : all_) {
        if (place.sheet || !place.last || place.wanted != sheets[i].wanted) continue;
        const double d = distance(*place.last, sheets[i].center());
        if (d >= least) continue;
        least = d;
        nearest = &place;
        sheet = i;
      }
    }
    if (nearest == nullptr) return;
    nearest->sheet = sheet;
  }
}

void SheetPlaces::assign_others(std::span<const Sheet> sheets) {
  std::vector<std::size_t> left = without_place(sheets);
  std::ranges::sort(left, {}, [&](std::size_t i) { return distance({}, sheets[i].center()); });
  for (const std::size_t i : left) {
    const std::size_t wanted = sheets[i].wanted;
    const auto vacant = std::ranges::find_if(
        all_, [&](const SheetPlace& p) { return p.wanted == wanted && !p.sheet; });
    if (vacant != all_.end()) {
      vacant->sheet = i;
      continue;
    }
    const auto board = std::ranges::find(all_, wanted, &SheetPlace::wanted)->board;
    all_.push_back({board, wanted, i, {}, nullptr});
  }
}

void SheetPlaces::close_gaps() {
  for (std::size_t i = 0; i < listed_; ++i) {
    if (all_[i].sheet) continue;
    const auto further = std::find_if(
        all_.begin() + static_cast<std::ptrdiff_t>(listed_), all_.end(),
        [&](const SheetPlace& p) { return p.wanted == all_[i].wanted && p.sheet.has_value(); });
    if (further == all_.end()) continue;
    all_[i].sheet = std::exchange(further->sheet, std::nullopt);
    all_[i].tracker = std::move(further->tracker);
  }
  all_.erase(std::remove_if(all_.begin() + static_cast<std::ptrdiff_t>(listed_), all_.end(),
                            [](const SheetPlace& p) { return !p.sheet; }),
             all_.end());
}

}  // namespace calvin::detect
