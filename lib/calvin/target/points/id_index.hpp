// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// IdIndex: Board::index_of() for many ids of one board. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "calvin/target/board.hpp"

namespace calvin {

class IdIndex {
 public:
  explicit IdIndex(const Board& board) : ids_(board.ids()) {}

  [[nodiscard]] std::optional<std::size_t> of(int id) const noexcept {
    // Most boards count their points from 0, so that an id is its own place.
    const auto own = static_cast<std::size_t>(id);
    if (own < ids_.size() && ids_[own] == id) return own;
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), id);
    if (at == ids_.end() || *at != id) return std::nullopt;
    return static_cast<std::size_t>(at - ids_.begin());
  }

 private:
  std::vector<int> ids_;  // ascending
};

}  // namespace calvin
