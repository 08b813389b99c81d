// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The proposal of the least cost, robustly summed over some of the voters.

#include "calvin/rig/start/vote.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calvin::rig {

namespace {

constexpr std::size_t kMostVoters = 80;  // voters that are asked
constexpr double kAgree = 8;             // px, weighted: of views whose poses are known about
constexpr double kSoft = 2;              // px, from where on a misfit counts less than its square
// How much better than another one a place has to be, in misfits of one view that disagrees.
constexpr double kLead = 1.5;

}  // namespace

Vote vote_on(const std::vector<SE3>& proposals, const Voters& voters) {
  std::vector<std::size_t> all(voters.count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  const std::vector<std::size_t> asked = some_of(all, kMostVoters);
  std::vector<double> costs;
  for (const SE3& place : proposals) {
    double& cost = costs.emplace_back(0);
    for (const std::size_t voter : asked) {
      const double misfit = voters.misfit(voter, place) / kSoft;
      cost += std::log1p(misfit * misfit);
    }
  }
  const auto best = std::ranges::min_element(costs) - costs.begin();
  Vote vote = {proposals[static_cast<std::size_t>(best)]};
  vote.votes = static_cast<std::size_t>(std::ranges::count_if(
      all, [&](std::size_t voter) { return voters.misfit(voter, vote.place) < kAgree; }));
  for (std::size_t p = 0; p < proposals.size(); ++p) {
    if (costs[p] < costs[static_cast<std::size_t>(best)] + kLead &&
        voters.is_elsewhere(proposals[p], vote.place)) {
      vote.is_decided = false;
    }
  }
  return vote;
}

}  // namespace calvin::rig
