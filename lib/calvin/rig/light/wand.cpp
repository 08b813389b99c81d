// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Where wands are, how long cameras alone see them, and which of their lights contradict the rest.

#include "calvin/rig/light/wand.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/core/text.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/median.hpp"

namespace calvin::rig {

namespace {

constexpr double kMedianOfNormal = 0.6745;  // of |x|, in its sigma

SE3 pose_of(const PlacedWand& wand, const std::vector<double>& places, const LightState& state) {
  const auto at = [&](std::size_t light) { return *state.points[wand.first + light]; };
  const Eigen::Vector3d along =
      (at(wand.lights.back()) - at(wand.lights.front())).stableNormalized();
  SE3 pose;
  if (along.squaredNorm() > 0) pose.rotation = rotation_between(Eigen::Vector3d::UnitX(), along);
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  for (const std::size_t k : wand.lights) first += at(k) - places[k] * along;
  pose.translation = first / static_cast<double>(wand.lights.size());
  return pose;
}

// A point by the rays of cameras alone.
struct FreePoint {
  Eigen::Vector3d at;
  Eigen::Matrix3d covariance;  // for sightings of their sigmas
};

class FreePoints {
 public:
  FreePoints(const std::vector<LightCamera>& cameras, std::vector<Camera> models,
             const LightState& state)
      : cameras_(cameras), models_(std::move(models)), state_(state) {}

  // By Gauss-Newton from where the point is. Absent where rays do not tell.
  [[nodiscard]] std::optional<FreePoint> operator()(std::size_t number) const {
    constexpr int kSteps = 4;
    FreePoint point{*state_.points[number], {}};
    for (int step = 0; step < kSteps; ++step) {
      Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (std::size_t c = 0; c < cameras_.size(); ++c) {
        if (state_.used[c][number] && !add(c, number, point.at, information, gradient)) {
          return std::nullopt;
        }
      }
      point.covariance = information.inverse();
      if (!point.covariance.allFinite()) return std::nullopt;
      point.at -= point.covariance * gradient;
    }
    return point;
  }

 private:
  bool add(std::size_t c, std::size_t number, const Eigen::Vector3d& at,
           Eigen::Matrix3d& information, Eigen::Vector3d& gradient) const {
    const LightPoint& seen = *cameras_[c].seen[number];
    const Eigen::Vector3d own = state_.camera_from_rig[c] * at;
    const double step = 1e-5 * own.norm();
    const auto middle = models_[c].project(own);
    if (!middle) return false;
    Eigen::Matrix<double, 2, 3> by;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = step * Eigen::Vector3d::Unit(k);
      const auto more = models_[c].project(own + d);
      const auto less = models_[c].project(own - d);
      if (!more || !less) return false;
      by.col(k) << more->u - less->u, more->v - less->v;
    }
    by = by * state_.camera_from_rig[c].rotation / (2 * step * seen.sigma);
    const Eigen::Vector2d off(middle->u - seen.uv.u, middle->v - seen.uv.v);
    information += by.transpose() * by;
    gradient += by.transpose() * off / seen.sigma;
    return true;
  }

  const std::vector<LightCamera>& cameras_;
  std::vector<Camera> models_;
  const LightState& state_;
};

// Of two lights: how long what is seen is, over what is known, per instant.
using Ratios = std::map<std::pair<std::size_t, std::size_t>, std::vector<double>>;

Result<double> too_few(std::size_t wands, std::size_t fewest) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("Two lights of the wand were seen by two cameras each at {} instants, and {} are "
                  "the fewest: hold the wand so that both are seen from all sides, and see that "
                  "the lights have the numbers 0, 1 and so on along it.",
                  wands, fewest));
}

Result<double> not_rigid(double spread) {
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format(
          "What is seen of the wand is not rigid: the distance of two of its lights changes "
          "by {:.0f} % from time to time. See that each light keeps its number, that all "
          "are those of one wand, and that the clocks of the cameras agree.",
          100 * spread));
}

Result<double> wrong_parts(const std::vector<double>& wand, const Ratios& ratios) {
  std::vector<std::string> parts;
  const auto longest = std::ranges::max_element(
      ratios, {}, [&](const auto& of) { return wand[of.first.second] - wand[of.first.first]; });
  const double whole = median_of(longest->second);
  for (const auto& [pair, seen] : ratios) {
    const double known = 1e3 * (wand[pair.second] - wand[pair.first]);
    parts.push_back(fmt::format("lights {} and {} {:.1f} mm apart, not {:.1f} mm", pair.first,
                                pair.second, known * median_of(seen) / whole, known));
  }
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "The lights of the wand are not where they were said to be beside each other. If the "
          "longest distance is right, there are {}. Say distances in the order of the "
          "numbers of the lights, and measure them from middle to middle.",
          join(parts, "; ")));
}

// The largest set of lights of one instant, as bits, all distances within which are as known; none
// where two are as large.
unsigned agreeing(const std::vector<std::pair<unsigned, bool>>& pairs, unsigned all) {
  unsigned best = 0;
  bool is_only = true;
  for (unsigned set = all; set > 0; set = (set - 1) & all) {
    const int size = std::popcount(set);
    if (size < 2 || size < std::popcount(best)) continue;
    const bool agrees = std::ranges::all_of(pairs, [&](const std::pair<unsigned, bool>& pair) {
      return pair.second || (pair.first & set) != pair.first;
    });
    if (!agrees) continue;
    is_only = size > std::popcount(best);
    best = set;
  }
  return is_only ? best : 0;
}

unsigned bit(std::size_t light) { return 1U << light; }

}  // namespace

std::vector<PlacedWand> take_wands(std::vector<std::size_t>& points,
                                   const std::vector<double>& places, const LightState& state) {
  const std::size_t lights = places.size();
  std::vector<PlacedWand> wands;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < points.size();) {
    PlacedWand wand{points[i] / lights * lights, {}, {}};
    std::size_t next = i;
    for (; next < points.size() && points[next] < wand.first + lights; ++next) {
      wand.lights.push_back(points[next] - wand.first);
    }
    if (wand.lights.size() > 1) {
      wand.rig_from_wand = pose_of(wand, places, state);
      wands.push_back(std::move(wand));
    } else {
      left.push_back(points[i]);
    }
    i = next;
  }
  points = std::move(left);
  return wands;
}

void put_lights(const PlacedWand& wand, const std::vector<double>& places, LightState& state) {
  for (const std::size_t k : wand.lights) {
    state.points[wand.first + k] = wand.rig_from_wand * Eigen::Vector3d(places[k], 0, 0);
  }
}

BoardShape shape_of_wand(std::size_t lights) {
  BoardShape shape;
  shape.modes = lights - 1;
  for (std::size_t k = 0; k < lights; ++k) {
    for (std::size_t mode = 0; mode < shape.modes; ++mode) {
      shape.displacement.emplace_back(k == mode + 1 ? 1 : 0, 0, 0);
    }
  }
  return shape;
}

std::vector<WandDistance> wand_distances(const std::vector<LightCamera>& cameras,
                                         const LightUnknowns& unknowns, const LightState& state) {
  std::vector<WandDistance> all;
  auto models = unknowns.cameras(state.values);
  if (!models) return all;
  const FreePoints free_point(cameras, *std::move(models), state);
  const std::size_t lights = unknowns.lights();
  for (std::size_t first = 0; first + lights <= state.points.size(); first += lights) {
    std::vector<std::pair<std::size_t, FreePoint>> placed;
    for (std::size_t k = 0; k < lights; ++k) {
      if (!state.points[first + k]) continue;
      if (const auto point = free_point(first + k)) placed.emplace_back(k, *point);
    }
    for (std::size_t b = 1; b < placed.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        const Eigen::Vector3d between = placed[b].second.at - placed[a].second.at;
        const double length = between.norm();
        if (!(length > 0)) continue;
        const double variance =
            between.dot((placed[a].second.covariance + placed[b].second.covariance) * between);
        all.push_back({first, placed[a].first, placed[b].first, length,
                       state.noise * std::sqrt(variance) / length});
      }
    }
  }
  return all;
}

Result<double> scale_by_wand(const std::vector<WandDistance>& distances,
                             const LightUnknowns& unknowns) {
  constexpr std::size_t kFewest = 10;
  constexpr double kAlike = 0.03;  // of a distance
  constexpr double kRigid = 0.05;
  constexpr double kSure = 5;  // sigmas
  const std::vector<double>& wand = unknowns.wand();
  Ratios ratios;
  std::vector<double> all;
  std::vector<double> noise;
  std::size_t wands = 0;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const WandDistance& one = distances[i];
    all.push_back(one.seen / (wand[one.b] - wand[one.a]));
    noise.push_back(one.sigma / one.seen);
    ratios[{one.a, one.b}].push_back(all.back());
    wands += i == 0 || distances[i - 1].first != one.first ? 1 : 0;
  }
  if (wands < kFewest) return too_few(wands, kFewest);
  const double scale = median_of(all);
  std::vector<double> off;
  for (const double ratio : all) off.push_back(std::abs(ratio / scale - 1));
  double least = scale;
  double most = scale;
  double allowed = kAlike;
  for (auto& [pair, own] : ratios) {
    if (own.size() < kFewest) continue;
    least = std::min(least, median_of(own));
    most = std::max(most, median_of(own));
    allowed =
        std::max(allowed, kSure * unknowns.wand_sigma() / (wand[pair.second] - wand[pair.first]));
  }
  if (most > (1 + allowed) * least) return wrong_parts(wand, ratios);
  const double spread = median_of(std::move(off)) / kMedianOfNormal;
  if (spread > std::max(kRigid, kSure * median_of(std::move(noise)))) return not_rigid(spread);
  return 1 / scale;
}

void refuse_lights(const std::vector<WandDistance>& distances, const LightUnknowns& unknowns,
                   LightState& state) {
  constexpr double kFar = 4;  // sigmas, as of sightings
  if (distances.empty()) return;
  const std::vector<double> wand = unknowns.wand_at(state.values);
  std::vector<double> off;
  for (const WandDistance& one : distances) {
    off.push_back(std::abs(one.seen - (wand[one.b] - wand[one.a])) /
                  std::hypot(one.sigma, unknowns.wand_sigma()));
  }
  const double limit = kFar * std::max(1.0, median_of(off) / kMedianOfNormal);
  for (std::size_t i = 0; i < distances.size();) {
    const std::size_t first = distances[i].first;
    std::vector<std::pair<unsigned, bool>> pairs;
    unsigned lights = 0;
    for (; i < distances.size() && distances[i].first == first; ++i) {
      pairs.emplace_back(bit(distances[i].a) | bit(distances[i].b), off[i] <= limit);
      lights |= pairs.back().first;
    }
    const unsigned kept = agreeing(pairs, lights);
    for (std::size_t k = 0; k < unknowns.lights(); ++k) {
      if ((lights & ~kept & bit(k)) == 0) continue;
      state.points[first + k].reset();
      for (auto& camera : state.used) camera[first + k] = false;
    }
  }
}

void grow(LightState& state, double scale) {
  for (SE3& pose : state.camera_from_rig) pose.translation *= scale;
  for (auto& point : state.points) {
    if (point) *point *= scale;
  }
}

}  // namespace calvin::rig
