// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries all ends and middles.

#include "calvin/detect/light/wand_shape.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calvin/geometry/pixels.hpp"

namespace calvin::detect {

namespace {

constexpr std::size_t kLights = 3;
constexpr double kUnequal = 1.25;  // the longer distance over the shorter one, at the least

// How much nearer one end of the wand may be than the other: one of 50 cm at 75 cm, say. For points
// at depths z0 and z2 the odds of the middle one's share of the way are z2 / z0 times those on the
// wand, so that this is how far odds may be off.
constexpr double kNearer = 2;
// Of what tells one end from the other: a picture in the middle of both names neither.
constexpr double kSure = 0.9;

// px, and of its length: by how much the middle light may be beside the line of the others, by the
// noise of spots and by what lenses bend.
constexpr double kBeside = 2;
constexpr double kBent = 0.03;
constexpr double kAlike = 10;  // times, that one light may be brighter than another of the wand

// The logarithm of the odds of a share of a way.
double log_odds(double before, double after) { return std::log(before / after); }

// Whether the spots may be the lights 0, 1 and 2.
bool is_wand(const LightSpotSeen& first, const LightSpotSeen& middle, const LightSpotSeen& last,
             double odds) {
  const auto [least, most] = std::minmax({first.flux, middle.flux, last.flux});
  if (most > kAlike * least) return false;
  const Pixel a = first.fit.centre;
  const Pixel b = last.fit.centre;
  const Pixel at = middle.fit.centre;
  const double length = distance(a, b);
  const Pixel way = {(b.u - a.u) / length, (b.v - a.v) / length};
  const double along = (at.u - a.u) * way.u + (at.v - a.v) * way.v;
  const double beside = (at.v - a.v) * way.u - (at.u - a.u) * way.v;
  if (!(along > 0 && along < length)) return false;
  if (std::abs(beside) > kBeside + kBent * length) return false;
  const double allowed = std::min(std::log(kNearer), kSure * std::abs(odds));
  return std::abs(log_odds(along, length - along) - odds) < allowed;
}

}  // namespace

Status check_shape(const PointLight& light) {
  if (!light.is_wand()) return {};
  if (light.places.size() != kLights) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("No picture tells the lights of {} apart: put three on the wand, "
                                  "the middle one nearer to one end, as in wand:150mm+350mm. Files "
                                  "of observations whose points have the numbers of their lights "
                                  "may be of any wand.",
                                  light.text()));
  }
  const double one = light.places[1];
  const double other = light.places[2] - light.places[1];
  if (std::max(one, other) >= kUnequal * std::min(one, other)) return {};
  return make_error(
      ErrorCode::kUnsupported,
      fmt::format("No picture tells the ends of {} apart: put the middle light nearer "
                  "to one end, as in wand:150mm+350mm.",
                  light.text()));
}

std::vector<std::vector<std::size_t>> sets_of_wand(const std::vector<LightSpotSeen>& spots,
                                                   const std::vector<double>& wand) {
  std::vector<std::vector<std::size_t>> sets;
  const double odds = log_odds(wand[1], wand[2] - wand[1]);
  for (std::size_t first = 0; first < spots.size(); ++first) {
    for (std::size_t middle = 0; middle < spots.size(); ++middle) {
      for (std::size_t last = 0; last < spots.size(); ++last) {
        if (first == middle || middle == last || last == first) continue;
        if (!is_wand(spots[first], spots[middle], spots[last], odds)) continue;
        sets.push_back({first, middle, last});
      }
    }
  }
  return sets;
}

}  // namespace calvin::detect
