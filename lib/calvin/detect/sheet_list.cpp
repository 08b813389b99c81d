// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Gives each board of a list the nearest sheet.

#include "calvin/detect/sheet_list.hpp"

#include <algorithm>
#include <cmath>

namespace calvin::detect {

bool SheetList::is_satisfied(std::span<const SheetOf> sheets) const {
  return std::ranges::all_of(kinds_, [&](std::size_t kind) {
    return std::ranges::count(sheets, kind, &SheetOf::kind) >= std::ranges::count(kinds_, kind);
  });
}

std::vector<ListedSheet> SheetList::assign(std::span<const SheetOf> sheets) {
  std::vector<ListedSheet> all;
  std::vector<bool> given(sheets.size(), false);
  last_.resize(kinds_.size());
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    std::optional<std::size_t> best;
    double least = 0;
    for (std::size_t s = 0; s < sheets.size(); ++s) {
      if (given[s] || sheets[s].kind != kinds_[i]) continue;
      const Pixel& centre = sheets[s].centre;
      const double far = std::hypot(centre.u - last_[i].u, centre.v - last_[i].v);
      if (best && far >= least) continue;
      best = s;
      least = far;
    }
    if (best) {
      given[*best] = true;
      last_[i] = sheets[*best].centre;
    }
    all.push_back({i, best});
  }
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    if (given[s]) continue;
    const auto board = std::ranges::find(kinds_, sheets[s].kind) - kinds_.begin();
    all.push_back({static_cast<std::size_t>(board), s});
  }
  return all;
}

}  // namespace calvin::detect
