// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The proposal of the least cost, robustly summed over some of the voters.

#include "calvin/rig/start/vote.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace calvin::rig {

namespace {

constexpr std::size_t kMostVoters = 80;  // voters that are asked
constexpr std::size_t kRoughVoters = 8;  // that are asked first
// Proposals of the best place of which all are asked: it is refined later.
constexpr int kAsked = 3;
constexpr double kAgree = 8;       // px, weighted: of views whose poses are known about
constexpr double kSoftMisfit = 2;  // px, from where on a misfit counts less than its square
// How much better than another one a place has to be, in misfits of one view that disagrees.
constexpr double kLead = 1.5;
constexpr double kAny = std::numeric_limits<double>::infinity();

struct Proposal {
  SE3 place;
  double cost = kAny;
  double rough_cost = 0;  // of a few voters
};

// Of some voters; a part of it where it comes to `most` and more.
double cost(const SE3& place, const Voters& voters, const std::vector<std::size_t>& asked,
            double most) {
  double sum = 0;
  for (const std::size_t voter : asked) {
    const double misfit = voters.misfit(voter, place) / kSoftMisfit;
    sum += std::log1p(misfit * misfit);
    if (sum >= most) break;
  }
  return sum;
}

// Those that a few voters like best come first.
std::vector<Proposal> ranked(const std::vector<SE3>& proposals, const Voters& voters,
                             const std::vector<std::size_t>& all) {
  const std::vector<std::size_t> few = some_of(all, kRoughVoters);
  std::vector<Proposal> ranked;
  ranked.reserve(proposals.size());
  for (const SE3& place : proposals)
    ranked.push_back({place, kAny, cost(place, voters, few, kAny)});
  std::ranges::stable_sort(ranked, {}, &Proposal::rough_cost);
  return ranked;
}

// Asks all voters, and gives the best proposal. What costs more than the best so far and kLead is
// neither the best nor a rival of it, whatever more it costs; nor are more than a few of those that
// are the same place but for noise of use.
Proposal ask(std::vector<Proposal>& proposals, const Voters& voters,
             const std::vector<std::size_t>& all) {
  const std::vector<std::size_t> asked = some_of(all, kMostVoters);
  Proposal best = proposals.front();
  int of_best = 0;  // that were asked for all
  for (Proposal& p : proposals) {
    const bool is_same = !voters.is_elsewhere(p.place, best.place);
    if (is_same && of_best == kAsked) continue;
    p.cost = cost(p.place, voters, asked, best.cost + kLead);
    of_best = is_same ? of_best + 1 : of_best;
    if (p.cost >= best.cost) continue;
    best = p;
    if (!is_same) of_best = 1;
  }
  return best;
}

}  // namespace

bool is_elsewhere(const SE3& one, const SE3& other, double away) {
  constexpr double kTurn = 0.15;      // rad
  constexpr double kDistance = 0.15;  // of the distance of the board
  return log_so3(one.rotation * other.rotation.transpose()).norm() > kTurn ||
         (one.translation - other.translation).norm() > kDistance * away;
}

Vote vote_on(const std::vector<SE3>& proposals, const Voters& voters) {
  std::vector<std::size_t> all(voters.count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<Proposal> known = ranked(proposals, voters, all);
  const Proposal best = ask(known, voters, all);
  Vote vote = {best.place};
  vote.votes = static_cast<std::size_t>(std::ranges::count_if(
      all, [&](std::size_t voter) { return voters.misfit(voter, best.place) < kAgree; }));
  vote.is_decided = std::ranges::none_of(known, [&](const Proposal& p) {
    return p.cost < best.cost + kLead && voters.is_elsewhere(p.place, best.place);
  });
  return vote;
}

}  // namespace calvin::rig
