// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Projects the points of a board by the pose of some of them.

#include "calvin/session/points/expected_points.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calvin/session/points/point_fit.hpp"
#include "calvin/solve/pose.hpp"

namespace calvin {

namespace {

constexpr double kNoOther = 0.4;   // of the way to the next point
constexpr double kFewestPx = 1.5;  // px, of the reach: points that lie closer are not told apart

double to_next(const std::vector<std::optional<Pixel>>& all, std::size_t i) {
  double least = HUGE_VAL;
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (j == i || !all[j]) continue;
    least = std::min(least, std::hypot(all[j]->u - all[i]->u, all[j]->v - all[i]->v));
  }
  return least;
}

bool is_inside(Pixel at, ImageSize size) {
  return at.u >= 0 && at.v >= 0 && at.u <= size.width - 1 && at.v <= size.height - 1;
}

}  // namespace

std::vector<ExpectedPoint> expected_points(const Camera& camera, const View& chosen,
                                           const std::set<int>& without, std::size_t most,
                                           double reach) {
  std::vector<ExpectedPoint> expected;
  const auto fit = fit_points(camera, chosen);
  if (!fit || !fit->agrees()) return expected;
  const auto pose = solve_pose(camera, chosen.board, chosen.observation);
  if (!pose) return expected;
  const std::vector<int> ids = chosen.board.ids();
  const std::vector<Eigen::Vector3d> places = chosen.board.points();
  std::vector<std::optional<Pixel>> all;
  for (const Eigen::Vector3d& place : places) {
    const auto at = camera.project(*pose * place);
    all.push_back(at && is_inside(*at, camera.image_size()) ? at : std::nullopt);
  }
  for (std::size_t i = 0; i < ids.size() && expected.size() < most; ++i) {
    const bool is_chosen = std::ranges::binary_search(chosen.observation.ids, ids[i]);
    if (is_chosen || without.contains(ids[i]) || !all[i]) continue;
    const double own = std::min(reach, kNoOther * to_next(all, i));
    if (own >= kFewestPx) expected.push_back({ids[i], {*all[i], places[i], {}}, own});
  }
  return expected;
}

}  // namespace calvin
