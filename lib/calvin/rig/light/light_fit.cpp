// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A start by linear algebra from some of the instants, then least squares over all of them.

#include "calvin/rig/light/light_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/rig/joint/camera_unknowns.hpp"
#include "calvin/rig/light/euclidean.hpp"
#include "calvin/rig/light/light_refinement.hpp"
#include "calvin/rig/light/reconstruct.hpp"
#include "calvin/rig/light/space.hpp"
#include "calvin/rig/light/tracks.hpp"
#include "calvin/rig/light/wand.hpp"

namespace calvin::rig {

namespace {

constexpr double kStartLimit = 0.015;  // of the width: what distortion does to most of a picture
// Sigmas. Of Gaussian sightings one in 3000 is beyond; what lights really look like has longer
// tails, in which a few sightings at 4 to 6 sigmas would decide on the focal lengths.
constexpr double kFar = 4;
constexpr double kWorstFocal = 0.1;   // of the focal length, 1 sigma
constexpr double kWorstCenter = 0.1;  // of the width

std::vector<std::string> names_of(const std::vector<LightCamera>& cameras) {
  std::vector<std::string> names;
  for (const LightCamera& camera : cameras) names.push_back(camera.name);
  return names;
}

tl::unexpected<Error> stopped() {
  return make_error(ErrorCode::kCancelled, "The solve was stopped.");
}

tl::unexpected<Error> no_fit() {
  return make_error(ErrorCode::kDegenerate,
                    "The cameras that linear algebra finds do not fit what was seen: move the "
                    "light through more of the room, so that three cameras or more see it at a "
                    "time and it fills their pictures, or give calibrations of the cameras.");
}

class LightSolver {
 public:
  LightSolver(const std::vector<LightCamera>& cameras, LightUnknowns unknowns,
              const std::stop_token& stop)
      : cameras_(cameras), unknowns_(std::move(unknowns)), stop_(stop) {}

  [[nodiscard]] Status run() {
    some_ = instants_to_begin_with(cameras_);
    if (const Status begun = begin(); !begun) return begun;
    return finish();
  }

  [[nodiscard]] LightFit take() {
    return {std::move(unknowns_),
            std::move(state_),
            std::move(covariance_),
            variance_,
            scatter_,
            stage_};
  }

 private:
  [[nodiscard]] double start_limit() const {
    double widest = 0;
    for (const LightCamera& camera : cameras_) {
      widest = std::max(widest, kStartLimit * camera.image_size.width);
    }
    return widest;
  }

  // From some instants: the best pairs of cameras and the plausible spaces are tried until one
  // leads to cameras that most sightings fit; else that is taken which most fit, and best.
  [[nodiscard]] Status begin() {
    constexpr std::size_t kPairs = 5;
    const Tracks tracks = some_tracks();
    const auto pairs = ranked_pairs(tracks, names_of(cameras_), start_limit());
    if (!pairs) return tl::unexpected(pairs.error());
    planar_ = pairs->front().planar;
    Trials trials;
    for (std::size_t p = 0; p < std::min(pairs->size(), kPairs) && !trials.are_enough(); ++p) {
      try_pair(tracks, (*pairs)[p], trials);
      if (stop_.stop_requested()) return stopped();
    }
    if (!trials.best) return trials.why ? Status(tl::unexpected(*trials.why)) : Status(no_fit());
    state_ = *std::move(trials.best);
    return {};
  }

  // The starts so far.
  struct Trials {
    std::optional<LightState> best;
    double share = 0;          // of the sightings, that the best one uses
    double noise = 0;          // of them over the share
    std::optional<Error> why;  // of the first one that led nowhere

    [[nodiscard]] static bool is_enough(double used) {
      constexpr double kMost = 0.7;
      return used > kMost;
    }
    [[nodiscard]] bool are_enough() const { return is_enough(share); }
    // Where most of what was seen is refused, the rest fits because it is little.
    [[nodiscard]] bool are_worse_than(double other_share, double other_noise) const {
      if (!best) return true;
      if (is_enough(other_share) != are_enough()) return !are_enough();
      return are_enough() ? other_noise < noise : other_share > share;
    }
    void fail(const Error& error) {
      if (!why) why = error;
    }
  };

  // Known cameras are placed as such first. Where the light's way is nearly flat the motion that is
  // nearest to what a pair has in common may be far from the true one, and cameras that are known
  // only in the end come nearer.
  void try_pair(const Tracks& tracks, const EpipolarGeometry& pair, Trials& trials) {
    for (const bool is_calibrated : {true, false}) {
      if (is_calibrated && !are_all_known()) continue;
      const auto linear =
          reconstruct(tracks, pair, names_of(cameras_), is_calibrated, start_limit());
      if (linear) {
        try_spaces(*linear, is_calibrated, trials);
      } else {
        trials.fail(linear.error());
      }
      if (trials.are_enough() || stop_.stop_requested()) return;
    }
  }

  void try_spaces(const LinearReconstruction& linear, bool is_calibrated, Trials& trials) {
    // From six cameras on pixels tell one space from another.
    constexpr std::size_t kManyCameras = 6;
    constexpr std::size_t kSpaces = 4;
    std::vector<Eigen::Matrix4d> spaces = {Eigen::Matrix4d::Identity()};
    if (!is_calibrated) {
      spaces = plausible_spaces(linear.projections, unknowns_.is_known(), kSpaces);
    }
    for (const Eigen::Matrix4d& h : spaces) {
      const bool is_sure = are_all_known() || cameras_.size() >= kManyCameras;
      if (is_sure && trials.are_enough()) return;
      const Status begun = begin_in(linear, h);
      if (!begun) trials.fail(begun.error());
      if (!begun || !approach()) continue;
      const double share = used_share();
      const double noise = state_.noise / share;
      if (!(share > 0) || !trials.are_worse_than(share, noise)) continue;
      trials = {state_, share, noise, trials.why};
    }
  }

  [[nodiscard]] bool are_all_known() const {
    return std::ranges::count(unknowns_.is_known(), false) == 0;
  }

  [[nodiscard]] Tracks some_tracks() const {
    Tracks tracks;
    for (const Track& track : unknowns_.start_tracks(cameras_)) {
      Track& to = tracks.emplace_back();
      for (const std::size_t i : some_) to.push_back(track[i]);
    }
    return tracks;
  }

  // Of the sightings of some instants: those that are used and as near as a start is to be.
  [[nodiscard]] double used_share() const {
    const auto models = unknowns_.cameras(state_.values);
    double seen = 0;
    double used = 0;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      for (const std::size_t i : some_) {
        seen += cameras_[c].seen[i] ? 1 : 0;
        if (!models || !state_.used[c][i]) continue;
        const auto off = distance(cameras_[c], i, (*models)[c], state_, c);
        used += off && *off <= start_limit() ? 1 : 0;
      }
    }
    return used / std::max(seen, 1.0);
  }

  [[nodiscard]] Status begin_in(const LinearReconstruction& linear, const Eigen::Matrix4d& h) {
    const auto start = upgrade(linear, h, unknowns_.is_known(), names_of(cameras_));
    if (!start) return tl::unexpected(start.error());
    const std::size_t instants = cameras_.front().seen.size();
    state_ = {unknowns_.start_values(start->focal), start->camera_from_rig,
              std::vector<std::optional<Eigen::Vector3d>>(instants),
              std::vector<std::vector<bool>>(cameras_.size(), std::vector<bool>(instants, false)),
              1};
    for (std::size_t k = 0; k < some_.size(); ++k) {
      state_.points[some_[k]] = start->points[k];
      for (std::size_t c = 0; c < cameras_.size(); ++c) {
        state_.used[c][some_[k]] = linear.agrees[c][k] && start->points[k] &&
                                   (start->camera_from_rig[c] * *start->points[k]).z() > 0;
      }
    }
    return {};
  }

  [[nodiscard]] bool step(LightStage stage, const Loss& loss, int iterations) {
    return refine(cameras_, unknowns_, stage, loss, iterations, stop_, state_) &&
           !stop_.stop_requested();
  }

  // Decides which sightings are used by how large the noise is now.
  void judge_again(const std::vector<std::size_t>& instants) {
    state_.noise = noise_scale(cameras_, unknowns_, stage_, state_);
    judge(cameras_, unknowns_, kFar * state_.noise, instants, state_);
  }

  // The loss is soft from where a sighting is unlikely.
  [[nodiscard]] Loss soft() {
    constexpr double kSoft = 3;  // sigmas
    state_.noise = noise_scale(cameras_, unknowns_, stage_, state_);
    return {Loss::Kind::kCauchy, kSoft * state_.noise};
  }

  // One kind of unknown after the other, over some instants.
  [[nodiscard]] bool approach() {
    constexpr int kFew = 12;
    constexpr int kMany = 30;
    if (!step(LightStage::kFocal, soft(), kFew)) return false;
    if (!step(LightStage::kLens, soft(), kFew)) return false;
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds; ++round) {
      judge_again(some_);
      if (!step(round == 0 ? LightStage::kLens : LightStage::kAll, soft(), kMany)) return false;
    }
    return true;
  }

  // Over all instants, without a loss: first as points by themselves, then those of a wand.
  [[nodiscard]] Status finish() {
    if (const Status settled = settle(); !settled) return settled;
    if (unknowns_.lights() > 1) {
      const auto distances = wand_distances(cameras_, unknowns_, state_);
      const auto scale = scale_by_wand(distances, unknowns_);
      if (!scale) return tl::unexpected(scale.error());
      grow(state_, *scale);
      stage_ = LightStage::kWand;
      if (const Status settled = settle(); !settled) return settled;
    }
    return set_covariance();
  }

  // Until the same sightings are used.
  [[nodiscard]] Status settle() {
    constexpr int kRounds = 6;
    constexpr int kIterations = 100;
    std::vector<std::size_t> all(state_.points.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (int round = 0; round < kRounds; ++round) {
      const auto before = state_.used;
      judge_again(all);
      if (stage_ == LightStage::kWand) {
        refuse_lights(wand_distances(cameras_, unknowns_, state_), unknowns_, state_);
      }
      if (state_.used == before && round > 0) break;
      if (!step(stage_, Loss{}, kIterations)) {
        return stop_.stop_requested() ? stopped() : no_fit();
      }
    }
    return {};
  }

  [[nodiscard]] Status set_covariance() {
    const ParameterTable& table = unknowns_.table();
    const Eigen::MatrixXd free = unknowns_.basis(stage_, state_);
    std::vector<int> given;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const ParameterRange range = table.intrinsics(c);
      for (int i = range.first; unknowns_.is_known()[c] && i < range.end(); ++i) given.push_back(i);
    }
    const auto first = static_cast<Eigen::Index>(given.size());
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(table.count(), first + free.cols());
    for (Eigen::Index k = 0; k < first; ++k) basis(given[static_cast<std::size_t>(k)], k) = 1;
    basis.rightCols(free.cols()) = free;
    auto equations = information(cameras_, unknowns_, stage_, basis, state_);
    if (!equations) return undetermined("");
    variance_ = equations->cost / degrees_of_freedom(free.cols());
    if (stage_ == LightStage::kWand) {
      // The sigma of a wand, which may be all that is known of the unit, is to come out as it is.
      state_.noise = std::sqrt(variance_);
      equations = information(cameras_, unknowns_, stage_, basis, state_);
      if (!equations) return undetermined("");
    }
    set_scatter(free, equations->matrix.bottomRightCorner(free.cols(), free.cols()));
    const Eigen::MatrixXd known = covariance_of_given();
    const auto covariance = covariance_of_places(
        equations->matrix, {static_cast<int>(first), static_cast<int>(free.cols())},
        scatter_ * variance_, basis.leftCols(first).transpose() * known * basis.leftCols(first));
    if (!covariance) return undetermined("");
    covariance_ = free * covariance->of_places * free.transpose() + known;
    return check_sigmas();
  }

  // Errors that last, as of clocks that run apart, are not told by how large residuals are.
  void set_scatter(const Eigen::MatrixXd& basis, const Eigen::MatrixXd& information) {
    constexpr std::size_t kStretches = 10;
    constexpr double kSure = 1.5;  // beyond what independent sightings ever come to
    const auto ratio =
        scatter(cameras_, unknowns_, stage_, basis, information, variance_, kStretches, state_);
    if (ratio && *ratio > kSure) scatter_ = *ratio;
  }

  // Of the calibrations that were given, over the table.
  [[nodiscard]] Eigen::MatrixXd covariance_of_given() const {
    std::vector<RigCameraViews> calibrations;
    for (const LightCamera& camera : cameras_) {
      calibrations.push_back({camera.calibration.value_or(Calibration()), {}});
    }
    return covariance_of_intrinsics(unknowns_.table(), calibrations);
  }

  [[nodiscard]] double degrees_of_freedom(Eigen::Index directions) const {
    const auto priors = unknowns_.priors(unknowns_.at(stage_), 1);
    double numbers = static_cast<double>(priors.size()) - static_cast<double>(directions) -
                     small_unknowns(unknowns_, stage_, state_);
    for (const auto& camera : state_.used) {
      numbers += 2 * static_cast<double>(std::ranges::count(camera, true));
    }
    return std::max(numbers, 1.0);
  }

  [[nodiscard]] Status check_sigmas() const {
    const ParameterTable& table = unknowns_.table();
    const auto sigma = [&](int unknown) { return std::sqrt(covariance_(unknown, unknown)); };
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (unknowns_.is_known()[c]) continue;
      const auto focal = values_of(state_.values, table.focal(c));
      const bool is_sure = sigma(table.focal(c)[0]) < kWorstFocal * focal[0] &&
                           sigma(table.focal(c)[1]) < kWorstFocal * focal[1];
      const double most = kWorstCenter * cameras_[c].image_size.width;
      if (is_sure && sigma(table.center(c)[0]) < most && sigma(table.center(c)[1]) < most) continue;
      return undetermined(cameras_[c].name);
    }
    return {};
  }

  [[nodiscard]] tl::unexpected<Error> undetermined(const std::string& camera) const {
    // Share of the best pair's instants, reflections among them.
    constexpr double kMostlyPlanar = 0.6;
    if (planar_ > kMostlyPlanar) return light_in_a_plane();
    return make_error(
        ErrorCode::kDegenerate,
        fmt::format(
            "What was seen of the light does not determine {}: move it through more of the room, "
            "near and far, so that it fills the pictures; a lens with fewer unknowns is surer "
            "(fix center and k2), and so are calibrations that are given.",
            camera.empty() ? "the cameras" : fmt::format("the camera '{}'", camera)));
  }

  const std::vector<LightCamera>& cameras_;
  LightUnknowns unknowns_;
  const std::stop_token& stop_;
  std::vector<std::size_t> some_;  // instants that are enough for a start
  double planar_ = 0;              // share of the best pair's instants that lie in a plane
  LightState state_;
  LightStage stage_ = LightStage::kAll;  // the last one so far
  Eigen::MatrixXd covariance_;
  double variance_ = 0;
  double scatter_ = 1;
};

}  // namespace

Result<LightFit> fit_light(const std::vector<LightCamera>& cameras, const LightOptions& options,
                           const std::stop_token& stop) {
  auto unknowns = LightUnknowns::make(cameras, options);
  if (!unknowns) return tl::unexpected(unknowns.error());
  LightSolver solver(cameras, *std::move(unknowns), stop);
  if (const Status solved = solver.run(); !solved) return tl::unexpected(solved.error());
  return solver.take();
}

}  // namespace calvin::rig
