// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The light's places as free points of a BundleProblem, and votes of rays.

#include "calvin/rig/light/light_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/rig/light/linear.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/residuals/outliers.hpp"

namespace calvin::rig {

namespace {

constexpr std::size_t kLeastRays = 2;

// The free points of a problem: those that two cameras or more have seen, by their instants.
std::vector<std::size_t> points_in_use(const LightState& state) {
  std::vector<std::size_t> instants;
  for (std::size_t i = 0; i < state.points.size(); ++i) {
    std::size_t rays = 0;
    for (const auto& camera : state.used) rays += camera[i] ? 1 : 0;
    if (state.points[i] && rays >= kLeastRays) instants.push_back(i);
  }
  return instants;
}

BundleProblem problem_of(const std::vector<LightCamera>& cameras, SharedUnknowns unknowns,
                         const Loss& loss, const std::vector<std::size_t>& instants,
                         const LightState& state, const std::stop_token& stop) {
  BundlePoint start;
  start.shared = state.values;
  start.camera_from_rig = state.camera_from_rig;
  for (const std::size_t i : instants) start.points.push_back(*state.points[i]);
  ResidualBlocks blocks;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    PointResiduals block;
    block.camera = c;
    for (std::size_t k = 0; k < instants.size(); ++k) {
      if (!state.used[c][instants[k]]) continue;
      const LightPoint& seen = *cameras[c].seen[instants[k]];
      block.seen.ids.push_back(static_cast<int>(k));
      block.seen.points.push_back(start.points[k]);
      block.seen.uv.push_back(seen.uv);
      block.seen.weight.push_back(1 / seen.sigma);
    }
    if (block.seen.used() > 0) blocks.points.push_back(std::move(block));
  }
  return {std::move(blocks), std::move(unknowns), std::move(start), loss, stop};
}

// What the known or solved cameras make of all rays of one instant.
class Judge {
 public:
  Judge(const std::vector<LightCamera>& cameras, const std::vector<Camera>& models, double limit,
        LightState& state)
      : cameras_(cameras), models_(models), limit_(limit), state_(state) {}

  // Whether anything changed.
  bool at(std::size_t instant) {
    const std::vector<bool> before = used(instant);
    const bool had_point = state_.points[instant].has_value();
    std::vector<bool> now = had_point ? agreeing(instant) : std::vector<bool>(cameras_.size());
    // Where a ray in use has come to disagree, the point was drawn to it by what is wrong.
    bool is_drawn = !had_point || std::ranges::count(now, true) < 2;
    for (std::size_t c = 0; c < now.size(); ++c) is_drawn |= before[c] && !now[c];
    if (is_drawn) {
      vote(instant);
      now = state_.points[instant] ? agreeing(instant) : std::vector<bool>(cameras_.size());
    }
    if (std::ranges::count(now, true) < static_cast<std::ptrdiff_t>(kLeastRays)) {
      state_.points[instant].reset();
      now.assign(cameras_.size(), false);
    }
    for (std::size_t c = 0; c < now.size(); ++c) state_.used[c][instant] = now[c];
    return now != before;
  }

 private:
  [[nodiscard]] std::vector<bool> used(std::size_t instant) const {
    std::vector<bool> all;
    for (const auto& camera : state_.used) all.push_back(camera[instant]);
    return all;
  }

  // The cameras whose sightings are near the projection of the point.
  [[nodiscard]] std::vector<bool> agreeing(std::size_t instant) const {
    std::vector<bool> all;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      const auto off = cameras_[c].seen[instant]
                           ? distance(cameras_[c], instant, models_[c], state_, c)
                           : std::nullopt;
      all.push_back(off && *off <= limit_ * cameras_[c].seen[instant]->sigma);
    }
    return all;
  }

  // The point where most rays agree.
  void vote(std::size_t instant) {
    state_.points[instant].reset();
    std::vector<Ray> rays;
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
      if (!cameras_[c].seen[instant]) continue;
      const LightPoint& seen = *cameras_[c].seen[instant];
      const auto ray = models_[c].unproject(seen.uv);
      if (!ray || !(ray->z() > 0)) continue;
      const SE3& pose = state_.camera_from_rig[c];
      Matrix34 projection;
      projection << pose.rotation, pose.translation;
      const double focal = (models_[c].fx() + models_[c].fy()) / 2;
      rays.push_back({c, projection, ray->hnormalized(), focal / seen.sigma});
    }
    const auto point = agreed_point(rays, limit_);
    if (!point || point->at[3] == 0) return;
    state_.points[instant] = point->at.hnormalized();
  }

  const std::vector<LightCamera>& cameras_;
  const std::vector<Camera>& models_;
  double limit_;
  LightState& state_;
};

}  // namespace

bool refine(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns,
            LightStage stage, const Loss& loss, int iterations, const std::stop_token& stop,
            LightState& state) {
  const ParameterTable table = unknowns.at(stage);
  const std::vector<std::size_t> instants = points_in_use(state);
  if (instants.empty()) return false;
  BundleProblem problem = problem_of(
      cameras, {&table, unknowns.basis(table, state), unknowns.priors(table, state.noise)}, loss,
      instants, state, stop);
  if (!problem.valid()) return false;
  LmOptions options;
  options.max_iterations = iterations;
  options.tolerance = 1e-11;
  (void)minimise(problem, options, stop);
  const BundlePoint& found = problem.point();
  state.values = found.shared;
  state.camera_from_rig = found.camera_from_rig;
  for (std::size_t k = 0; k < instants.size(); ++k) state.points[instants[k]] = found.points[k];
  return true;
}

std::optional<LightInformation> information(const std::vector<LightCamera>& cameras,
                                            const LightUnknowns& unknowns,
                                            const Eigen::MatrixXd& basis, const LightState& state) {
  const std::vector<std::size_t> instants = points_in_use(state);
  const ParameterTable table = unknowns.at(LightStage::kAll);
  BundleProblem problem = problem_of(cameras, {&table, basis, unknowns.priors(table, state.noise)},
                                     Loss{}, instants, state, {});
  if (!problem.valid()) return std::nullopt;
  auto reduced = problem.reduced();
  if (!reduced) return std::nullopt;
  return LightInformation{std::move(reduced->information), problem.cost()};
}

std::optional<double> scatter(const std::vector<LightCamera>& cameras,
                              const LightUnknowns& unknowns, const Eigen::MatrixXd& basis,
                              const Eigen::MatrixXd& information, double variance,
                              std::size_t blocks, const LightState& state) {
  const ParameterTable table = unknowns.at(LightStage::kAll);
  const std::vector<std::size_t> instants = points_in_use(state);
  double sum = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto begin = instants.begin();
    const std::vector<std::size_t> own(
        begin + static_cast<std::ptrdiff_t>(b * instants.size() / blocks),
        begin + static_cast<std::ptrdiff_t>((b + 1) * instants.size() / blocks));
    if (own.empty()) return std::nullopt;
    BundleProblem problem = problem_of(cameras, {&table, basis, {}}, Loss{}, own, state, {});
    const auto reduced = problem.valid() ? problem.reduced() : std::nullopt;
    if (!reduced) return std::nullopt;
    const auto step = scaled_solve(information, reduced->gradient, kLeastPivot);
    if (!step) return std::nullopt;
    sum += reduced->gradient.dot(step->col(0));
  }
  // The gradients add up to 0, so that one of them is not free.
  const double expected = variance * static_cast<double>(basis.cols()) *
                          static_cast<double>(blocks - 1) / static_cast<double>(blocks);
  return sum / expected;
}

std::optional<double> distance(const LightCamera& camera, std::size_t instant, const Camera& model,
                               const LightState& state, std::size_t number) {
  const auto at = model.project(state.camera_from_rig[number] * *state.points[instant]);
  if (!at) return std::nullopt;
  const Pixel& seen = camera.seen[instant]->uv;
  return std::hypot(at->u - seen.u, at->v - seen.v);
}

double noise_scale(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns,
                   const LightState& state) {
  const auto models = unknowns.cameras(state.values);
  std::vector<double> distances;
  for (const std::size_t i : points_in_use(state)) {
    double rays = 0;
    for (const auto& camera : state.used) rays += camera[i] ? 1 : 0;
    const double given_back = std::sqrt(2 * rays / (2 * rays - 3));
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (!models || !state.used[c][i]) continue;
      const auto off = distance(cameras[c], i, (*models)[c], state, c);
      if (off) distances.push_back(given_back * *off / cameras[c].seen[i]->sigma);
    }
  }
  return robust_scale(std::move(distances));
}

bool judge(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns, double limit,
           const std::vector<std::size_t>& instants, LightState& state) {
  const auto models = unknowns.cameras(state.values);
  if (!models) return false;
  Judge by_rays(cameras, *models, limit, state);
  bool changed = false;
  for (const std::size_t i : instants) changed |= by_rays.at(i);
  return changed;
}

}  // namespace calvin::rig
