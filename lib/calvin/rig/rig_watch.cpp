// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Counts instants that contradict the rig, and asks which camera they have in common.

#include "calvin/rig/rig_watch.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include "calvin/core/text.hpp"
#include "calvin/geometry/median.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin {

namespace {

using rig::Matrix6;
using rig::PairTest;
using rig::Vector6;

// An instant contradicts the rig where e^T C^-1 e / 6 is larger: by chance one of 15000 does.
constexpr double kContradicts = 5;
constexpr int kInARow = 5;  // which say the same
// Of the mean of several: 5 sigmas in every number.
constexpr double kMoved = 25;
// What is told of a movement has a decimal of the one and two of the other: a smaller one, which
// may be of pictures that were taken at other times than they tell, is of no use to anybody.
constexpr double kMillimetre = 1e-3;
constexpr double kDegree = 0.017453292519943295;
constexpr double kLeastPlace = 0.05 * kMillimetre;
constexpr double kLeastTurn = 0.005 * kDegree;  // rad
// So many in a row, and it is said even if nothing tells which camera of the two it is.
constexpr int kLongEnough = 15;

std::vector<RigCameraViews> at_some_instants(const std::vector<RigCameraViews>& seen,
                                             std::uint64_t tolerance) {
  constexpr std::size_t kMost = 40;
  const auto instants = pair_instants(seen, tolerance).instants;
  const std::size_t step = (instants.size() + kMost - 1) / kMost;
  std::vector<RigCameraViews> some;
  for (const RigCameraViews& camera : seen) some.push_back({camera.calibration, {}});
  for (std::size_t i = 0; i < instants.size(); i += step) {
    for (const RigView& of : instants[i].views) {
      some[of.camera].views.push_back(seen[of.camera].views[of.view]);
    }
  }
  return some;
}

// Whether the board stands elsewhere, so that the noise of its corners is another one.
bool has_moved(const std::array<Pixel, 2>& before, const std::array<Pixel, 2>& now) {
  constexpr double kFarEnough = 1;  // px
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (std::hypot(now[i].u - before[i].u, now[i].v - before[i].v) > kFarEnough) return true;
  }
  return false;
}

const std::string& name_of(const Rig& rig, std::size_t camera) {
  return rig.cameras[camera].calibration.camera;
}

}  // namespace

WatchedRig watched_rig(const Rig& rig, const std::vector<RigCameraViews>& seen,
                       const RigOptions& options) {
  constexpr std::size_t kFewest = 5;           // instants that say what is usual
  constexpr double kMedianOfChiSquare = 0.89;  // with 6 degrees of freedom, over 6
  WatchedRig watched{rig, {}};
  const auto tests =
      rig::test_pairs(rig, at_some_instants(seen, options.tolerance), options.tolerance);
  if (!tests) return watched;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> squares;
  for (const PairTest& test : *tests) {
    if (test.camera > test.by) squares[{test.by, test.camera}].push_back(test.discrepancy.square());
  }
  for (auto& [pair, all] : squares) {
    if (all.size() < kFewest) continue;
    const double usual = std::max(median_of(std::move(all)) / kMedianOfChiSquare, 1.0);
    watched.pairs.push_back({pair.first, pair.second, usual});
  }
  return watched;
}

std::string to_text(const MovedCamera& moved) {
  std::vector<std::string> names;
  for (const std::string& name : moved.cameras) names.push_back(fmt::format("'{}'", name));
  return fmt::format(
      "The camera {} has moved: it stands {:.1f} mm and {:.2f} degrees from where the rig has it.",
      join(names, " or "), moved.place / kMillimetre, moved.turn / kDegree);
}

void RigWatch::forget(const std::vector<std::string>& cameras) {
  for (const std::string& camera : cameras) cameras_.erase(camera);
  std::erase_if(cameras_, [&](const auto& other) {
    return std::ranges::any_of(
        cameras, [&](const std::string& camera) { return other.second.by.contains(camera); });
  });
}

std::vector<MovedCamera> RigWatch::look(const WatchedRig& watched,
                                        const std::vector<std::string>& left_out,
                                        const std::vector<RigCameraViews>& seen,
                                        std::uint64_t tolerance) {
  std::vector<std::string> unwatched = left_out;
  const auto is_unwatched = [&](const std::string& camera) {
    return std::ranges::find(unwatched, camera) != unwatched.end();
  };
  forget(unwatched);
  std::vector<MovedCamera> all;
  const auto tests = rig::test_pairs(watched.rig, seen, tolerance);
  if (!tests) return all;
  for (const PairTest& test : *tests) {
    const auto [a, b] = std::minmax(test.camera, test.by);
    const auto pair = std::ranges::find_if(
        watched.pairs, [a = a, b = b](const auto& p) { return p.a == a && p.b == b; });
    const std::string& camera = name_of(watched.rig, test.camera);
    const std::string& other = name_of(watched.rig, test.by);
    if (pair == watched.pairs.end() || is_unwatched(camera) || is_unwatched(other)) continue;
    cameras_[camera].add(test, other, pair->usual);
    auto moved = judge(camera, test.discrepancy, pair->usual, watched.rig.cameras.size() == 2);
    if (!moved) continue;
    unwatched.insert(unwatched.end(), moved->cameras.begin(), moved->cameras.end());
    forget(moved->cameras);
    all.push_back(*std::move(moved));
  }
  return all;
}

RigWatch::Mean RigWatch::Evidence::mean() const {
  const Matrix6 covariance = information.inverse();
  return {covariance * weighted, covariance};
}

// Whether an instant says the same as those in a row do. A board that is far away says nothing
// against either.
bool RigWatch::Evidence::says_same(const rig::Discrepancy& now, double usual) const {
  const Mean so_far = mean();
  const Matrix6 covariance = now.of_noise + so_far.covariance + now.in_common;
  return rig::normalised_square(now.change - so_far.change, covariance) <= kContradicts * usual;
}

void RigWatch::Evidence::add(const PairTest& test, const std::string& other, double usual) {
  const rig::Discrepancy& now = test.discrepancy;
  const bool agrees = now.square() <= kContradicts * usual;
  const bool goes_on = in_a_row > 0 && says_same(now, usual);
  if (agrees && !goes_on) agreed = test.timestamp;
  if (!goes_on) {
    in_a_row = 0;
    by.clear();
    information.setZero();
    weighted.setZero();
    if (agrees) return;
    since = test.timestamp;
  }
  if (!agrees) {
    ++in_a_row;
    by.insert(other);
  }
  if (goes_on && !has_moved(seen, test.seen)) return;
  const Matrix6 of_this = now.of_noise.inverse();
  information += of_this;
  weighted += of_this * now.change;
  seen = test.seen;
}

std::optional<MovedCamera> RigWatch::judge(const std::string& camera, const rig::Discrepancy& last,
                                           double usual, bool is_pair) const {
  const Evidence& own = cameras_.at(camera);
  if (own.in_a_row < kInARow) return std::nullopt;
  const auto [change, of_mean] = own.mean();
  if (rig::normalised_square(change, of_mean + last.in_common) < kMoved * usual) {
    return std::nullopt;
  }
  MovedCamera moved{{camera}, own.since, change.tail<3>().norm(), change.head<3>().norm()};
  if (moved.place < kLeastPlace && moved.turn < kLeastTurn) return std::nullopt;
  // Two others do not move alike. One may have moved itself, unless a third one agrees with it.
  if (own.by.size() > 1) return moved;
  const std::string& other = *own.by.begin();
  const auto of_other = cameras_.find(other);
  if (of_other != cameras_.end()) {
    if (of_other->second.by.size() > 1) return std::nullopt;
    if (of_other->second.agreed >= own.since) return moved;
  }
  if (!is_pair && own.in_a_row < kLongEnough) return std::nullopt;
  moved.cameras.push_back(other);
  std::ranges::sort(moved.cameras);
  return moved;
}

}  // namespace calvin
