// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where one thing is to another, by proposals that all pictures of both are asked about. Internal.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "calvin/geometry/se3.hpp"

namespace calvin::rig {

struct Voters {
  std::size_t count = 0;
  // px, weighted: how far corners are from where a voter expects them by a place.
  std::function<double(std::size_t voter, const SE3& place)> misfit;
  // Whether a place is another one, and not the same but for noise.
  std::function<bool(const SE3&, const SE3&)> is_elsewhere;
};

struct Vote {
  SE3 place;
  std::size_t votes = 0;   // voters that agree
  bool is_decided = true;  // else another place agrees with them as well
};

// `proposals` are one or more.
[[nodiscard]] Vote vote_on(const std::vector<SE3>& proposals, const Voters& voters);

// Whether two poses before a board that is `away` (m) are not the same but for noise.
[[nodiscard]] bool is_elsewhere(const SE3& one, const SE3& other, double away);

inline constexpr std::size_t kMostProposers = 40;  // pictures from which places are proposed

// Every `step`th of a list, so that at most `most` are left.
template <typename T>
std::vector<T> some_of(const std::vector<T>& all, std::size_t most) {
  std::vector<T> some;
  const std::size_t step = (all.size() + most - 1) / most;
  for (std::size_t i = 0; i < all.size(); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace calvin::rig
