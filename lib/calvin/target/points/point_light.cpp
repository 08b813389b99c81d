// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text and the measures of a light and of a wand.

#include "calvin/target/point_light.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/target/board_name.hpp"

namespace calvin {

std::string PointLight::text() const {
  if (!is_wand()) return "dot";
  std::vector<std::string> distances;
  for (std::size_t k = 1; k < places.size(); ++k) {
    distances.push_back(length_text(places[k] - places[k - 1]));
  }
  return fmt::format("wand:{}", join(distances, "+"));
}

Status PointLight::check() const {
  if (places.empty() || places.size() > kMost) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("A wand of {} lights tells no length: say where 2 to {} lights "
                                  "are along it.",
                                  places.size(), kMost));
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (std::isfinite(places[k]) && (k == 0 ? places[k] == 0 : places[k] > places[k - 1])) continue;
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("Light {} of a wand cannot be at {} m: the places along it rise "
                                  "from 0, which is that of light 0.",
                                  k, places[k]));
  }
  return {};
}

std::vector<int> PointLight::ids() const {
  std::vector<int> all(places.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

std::vector<Eigen::Vector3d> PointLight::points() const {
  std::vector<Eigen::Vector3d> all;
  for (const double place : places) all.emplace_back(place, 0, 0);
  return all;
}

std::vector<int> PointLight::neighbours(int id) const {
  std::vector<int> all;
  for (const int other : {id - 1, id + 1}) {
    if (index_of(id) && index_of(other)) all.push_back(other);
  }
  return all;
}

double PointLight::cell_size(int id) const noexcept {
  const auto at = index_of(id);
  if (!at) return 0;
  double least = is_wand() ? HUGE_VAL : kDiameter;
  if (*at > 0) least = std::min(least, places[*at] - places[*at - 1]);
  if (*at + 1 < places.size()) least = std::min(least, places[*at + 1] - places[*at]);
  return least;
}

}  // namespace calvin
