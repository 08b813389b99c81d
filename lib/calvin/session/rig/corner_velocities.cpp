// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Differences over time.

#include "calvin/session/rig/corner_velocities.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace calvin {

std::vector<Pixel> velocities(const Observation& now, const Observation& other) {
  // Negative where the other one is the later one.
  const double seconds =
      1e-9 * (static_cast<double>(now.timestamp) - static_cast<double>(other.timestamp));
  std::vector<std::optional<Pixel>> known;
  Pixel sum{};
  double count = 0;
  std::size_t i = 0;
  for (std::size_t j = 0; j < now.ids.size(); ++j) {
    while (i < other.ids.size() && other.ids[i] < now.ids[j]) ++i;
    auto& one = known.emplace_back();
    if (i == other.ids.size() || other.ids[i] != now.ids[j]) continue;
    one = {(now.uv[j].u - other.uv[i].u) / seconds, (now.uv[j].v - other.uv[i].v) / seconds};
    sum.u += one->u;
    sum.v += one->v;
    ++count;
  }
  std::vector<Pixel> all;
  if (count == 0) return all;
  for (const auto& one : known) all.push_back(one.value_or(Pixel{sum.u / count, sum.v / count}));
  return all;
}

std::vector<Pixel> interpolated(const std::vector<Pixel>& first, const std::vector<Pixel>& second,
                                double share) {
  std::vector<Pixel> all;
  for (std::size_t i = 0; i < first.size(); ++i) {
    all.push_back({first[i].u + share * (second[i].u - first[i].u),
                   first[i].v + share * (second[i].v - first[i].v)});
  }
  return all;
}

double speed_of(const std::vector<Pixel>& velocities) {
  double sum = 0;
  for (const Pixel& v : velocities) sum += v.u * v.u + v.v * v.v;
  return velocities.empty() ? 0 : std::sqrt(sum / static_cast<double>(velocities.size()));
}

bool is_jump(const std::vector<Pixel>& there, double seconds_there,
             const std::vector<Pixel>& from_there, double seconds_from_there, double far) {
  constexpr double kOther = 0.7;  // of the greater velocity
  const double first = speed_of(there);
  const double second = speed_of(from_there);
  if (std::max(first * seconds_there, second * seconds_from_there) < far) return false;
  std::vector<Pixel> change;
  for (std::size_t i = 0; i < std::min(there.size(), from_there.size()); ++i) {
    change.push_back({from_there[i].u - there[i].u, from_there[i].v - there[i].v});
  }
  return speed_of(change) > kOther * std::max(first, second);
}

}  // namespace calvin
