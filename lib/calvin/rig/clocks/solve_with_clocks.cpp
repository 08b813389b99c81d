// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A solve for every step that clocks make.

#include "calvin/rig/clocks/solve_with_clocks.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/geometry/dense.hpp"
#include "calvin/rig/clocks/timing.hpp"

namespace calvin::rig {

namespace {

// ns: what timestamps say is of one time is apart by so much at the most, beside the tolerance.
std::uint64_t spread_of(const std::vector<double>& offsets) {
  constexpr double kSecond = 1e9;  // ns
  if (offsets.empty()) return 0;
  const auto [least, most] = std::ranges::minmax(offsets);
  return static_cast<std::uint64_t>(std::llround(kSecond * (most - least)));
}

// `views` are those of the problem.
Result<JointSolve> solve(const JointProblem& problem, std::vector<BoardView> views,
                         const std::vector<double>& offsets, const std::stop_token& stop) {
  JointSolve one;
  one.views = std::move(views);
  const std::vector<ViewTimes> times = view_times(problem.seen, offsets);
  const Instants instants =
      pair_instants(times, problem.tolerance + spread_of(offsets), problem.instants);
  one.farthest = instants.farthest;
  auto groups = group_views(instants, one.views);
  allow_for_timing(times, one.views, groups);
  one.links = find_links(one.views, groups, problem.cameras);
  // What one camera sees says nothing of the others, and something of its own intrinsics.
  const std::size_t fewest = problem.instants == InstantsOf::kAny ? 1 : 2;
  auto places = place_all(one.views, groups, problem.cameras, one.links, problem.names, fewest);
  if (!places) return tl::unexpected<Error>(places.error());
  auto fit =
      fit_rig(one.views, *std::move(places), problem.seen, problem.cameras, problem.wishes, stop);
  if (!fit) return tl::unexpected<Error>(fit.error());
  one.fit = *std::move(fit);
  return one;
}

// Whether any clock is off by more than `sigmas`.
bool is_beyond(const std::optional<TimeOffsets>& offsets, double sigmas) {
  if (!offsets) return false;
  for (std::size_t c = 0; c < offsets->seconds.size(); ++c) {
    if (std::abs(offsets->seconds[c]) > sigmas * offsets->sigma[c]) return true;
  }
  return false;
}

}  // namespace

// Views that were paired wrongly or left out count once the clocks are known better, so that a step
// leads to the next one.
Result<JointSolve> solve_with_clocks(JointProblem problem, const std::stop_token& stop) {
  constexpr double kCertain = 4;  // sigmas
  constexpr double kSettled = 0.1;
  constexpr int kRounds = 6;
  // Of boards that stand still nothing tells of clocks: there is one solve.
  const bool any_moves =
      std::ranges::any_of(problem.views, [](const BoardView& v) { return !v.velocity.empty(); });
  if (!any_moves) return solve(problem, std::move(problem.views), {}, stop);
  auto best = solve(problem, problem.views, {}, stop);
  if (!best || !is_beyond(best->fit.time_offsets, kCertain)) return best;
  std::vector<double> now(problem.seen.size(), 0.0);
  for (int round = 0; round < kRounds && is_beyond(best->fit.time_offsets, kSettled); ++round) {
    for (std::size_t c = 0; c < now.size(); ++c) now[c] += best->fit.time_offsets->seconds[c];
    auto next = solve(problem, problem.views, now, stop);
    if (!next) break;
    best = std::move(next);
    best->offsets = now;
  }
  if (!best->offsets.empty() && best->fit.time_offsets) {
    // What places owe to offsets that are not known exactly.
    const TimeOffsets& known = *best->fit.time_offsets;
    best->fit.covariance += congruent(known.covariance, known.places_by_offset.transpose());
  }
  return best;
}

}  // namespace calvin::rig
