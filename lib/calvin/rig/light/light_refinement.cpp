// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The light's places as free points of a BundleProblem, or as those of a line of known lights, and
// votes of rays.

#include "calvin/rig/light/light_refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/rig/light/linear.hpp"
#include "calvin/rig/light/wand.hpp"
#include "calvin/solve/linear/lm.hpp"
#include "calvin/solve/linear/scaled_solve.hpp"
#include "calvin/solve/residuals/bundle_problem.hpp"
#include "calvin/solve/residuals/outliers.hpp"
#include "calvin/solve/residuals/view_points.hpp"

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

// The least squares of a state, and what it refers to.
struct LightProblem {
  std::vector<std::size_t> points;      // free, by their numbers among the instants
  std::vector<PlacedWand> wands;        // of rigid lights
  std::vector<ViewPoints> views;        // of wands
  std::optional<BundleProblem> bundle;  // refers to views
};

// What one camera has seen of some points, of which point k is numbers[k].
PointSet seen_by(const LightCamera& camera, const std::vector<bool>& used,
                 const std::vector<std::size_t>& numbers,
                 const std::vector<Eigen::Vector3d>& points) {
  PointSet seen;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    if (!used[numbers[k]]) continue;
    const LightPoint& at = *camera.seen[numbers[k]];
    seen.ids.push_back(static_cast<int>(k));
    seen.points.push_back(points[k]);
    seen.uv.push_back(at.uv);
    seen.weight.push_back(1 / at.sigma);
  }
  return seen;
}

void add_wands(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns,
               const LightState& state, LightProblem& problem, BundlePoint& start,
               ResidualBlocks& blocks) {
  const BoardShape shape = shape_of_wand(unknowns.lights());
  std::vector<Eigen::Vector3d> lights;
  for (const double at : unknowns.wand()) lights.emplace_back(at, 0, 0);
  problem.views.reserve(problem.wands.size() * cameras.size());
  for (const PlacedWand& wand : problem.wands) {
    const std::size_t pose = start.rig_from_board.size();
    start.rig_from_board.push_back(wand.rig_from_wand);
    blocks.lines.push_back(pose);
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < lights.size(); ++k) numbers.push_back(wand.first + k);
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const PointSet seen = seen_by(cameras[c], state.used[c], numbers, lights);
      if (seen.ids.empty()) continue;
      const ViewPoints* other = problem.views.empty() ? nullptr : &problem.views.back();
      problem.views.emplace_back(seen, shape, other);
      blocks.boards.push_back({&problem.views.back(), pose, c, 0});
    }
  }
}

// Of the points with these numbers.
LightProblem problem_of(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns,
                        LightStage stage, SharedUnknowns shared, const Loss& loss,
                        std::vector<std::size_t> numbers, const LightState& state,
                        const std::stop_token& stop) {
  LightProblem problem;
  problem.points = std::move(numbers);
  BundlePoint start;
  start.shared = state.values;
  start.camera_from_rig = state.camera_from_rig;
  ResidualBlocks blocks;
  if (stage == LightStage::kWand) {
    problem.wands = take_wands(problem.points, unknowns.wand_at(state.values), state);
    add_wands(cameras, unknowns, state, problem, start, blocks);
  }
  for (const std::size_t i : problem.points) start.points.push_back(*state.points[i]);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    PointResiduals block;
    block.camera = c;
    block.seen = seen_by(cameras[c], state.used[c], problem.points, start.points);
    if (block.seen.used() > 0) blocks.points.push_back(std::move(block));
  }
  problem.bundle.emplace(std::move(blocks), std::move(shared), std::move(start), loss, stop);
  return problem;
}

// By what distances have to grow that are as short as they are because points and wands fit them:
// per point, the root of numbers that were seen over those that are left.
std::vector<double> given_back(const LightUnknowns& unknowns, LightStage stage,
                               const LightState& state) {
  std::vector<double> by(state.points.size(), 1.0);
  const auto rays_of = [&](std::size_t i) {
    double rays = 0;
    for (const auto& camera : state.used) rays += camera[i] ? 1 : 0;
    return rays;
  };
  std::vector<std::size_t> numbers = points_in_use(state);
  if (stage == LightStage::kWand) {
    for (const PlacedWand& wand : take_wands(numbers, unknowns.wand(), state)) {
      double rays = 0;
      for (const std::size_t k : wand.lights) rays += rays_of(wand.first + k);
      for (const std::size_t k : wand.lights) {
        by[wand.first + k] = std::sqrt(2 * rays / (2 * rays - 5));
      }
    }
  }
  for (const std::size_t i : numbers) {
    const double rays = rays_of(i);
    by[i] = std::sqrt(2 * rays / (2 * rays - 3));
  }
  return by;
}

// What the known or solved cameras make of all rays of one instant.
class Judge {
 public:
  Judge(const std::vector<LightCamera>& cameras, const std::vector<Camera>& models, double limit,
        LightState& state)
      : cameras_(cameras), models_(models), limit_(limit), state_(state) {}

  void at(std::size_t instant) {
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
  std::vector<std::size_t> numbers = points_in_use(state);
  if (numbers.empty()) return false;
  LightProblem problem =
      problem_of(cameras, unknowns, stage,
                 {&table, unknowns.basis(stage, state), unknowns.priors(table, state.noise)}, loss,
                 std::move(numbers), state, stop);
  if (!problem.bundle->valid()) return false;
  LmOptions options;
  options.max_iterations = iterations;
  options.tolerance = 1e-11;
  (void)minimise(*problem.bundle, options, stop);
  const BundlePoint& found = problem.bundle->point();
  state.values = found.shared;
  state.camera_from_rig = found.camera_from_rig;
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    state.points[problem.points[k]] = found.points[k];
  }
  for (std::size_t w = 0; w < problem.wands.size(); ++w) {
    problem.wands[w].rig_from_wand = found.rig_from_board[w];
    put_lights(problem.wands[w], unknowns.wand_at(state.values), state);
  }
  return true;
}

std::optional<LightInformation> information(const std::vector<LightCamera>& cameras,
                                            const LightUnknowns& unknowns, LightStage stage,
                                            const Eigen::MatrixXd& basis, const LightState& state) {
  const ParameterTable table = unknowns.at(stage);
  LightProblem problem =
      problem_of(cameras, unknowns, stage, {&table, basis, unknowns.priors(table, state.noise)},
                 Loss{}, points_in_use(state), state, {});
  if (!problem.bundle->valid()) return std::nullopt;
  auto reduced = problem.bundle->reduced();
  if (!reduced) return std::nullopt;
  return LightInformation{std::move(reduced->information), problem.bundle->cost()};
}

double small_unknowns(const LightUnknowns& unknowns, LightStage stage, const LightState& state) {
  constexpr double kLine = 5;
  constexpr double kPoint = 3;
  std::vector<std::size_t> numbers = points_in_use(state);
  double wands = 0;
  if (stage == LightStage::kWand) {
    wands = static_cast<double>(take_wands(numbers, unknowns.wand(), state).size());
  }
  return kLine * wands + kPoint * static_cast<double>(numbers.size());
}

std::optional<double> scatter(const std::vector<LightCamera>& cameras,
                              const LightUnknowns& unknowns, LightStage stage,
                              const Eigen::MatrixXd& basis, const Eigen::MatrixXd& information,
                              double variance, std::size_t blocks, const LightState& state) {
  const ParameterTable table = unknowns.at(stage);
  const std::vector<std::size_t> numbers = points_in_use(state);
  double sum = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto begin = numbers.begin();
    std::vector<std::size_t> own(
        begin + static_cast<std::ptrdiff_t>(b * numbers.size() / blocks),
        begin + static_cast<std::ptrdiff_t>((b + 1) * numbers.size() / blocks));
    if (own.empty()) return std::nullopt;
    LightProblem problem = problem_of(cameras, unknowns, stage, {&table, basis, {}}, Loss{},
                                      std::move(own), state, {});
    const auto reduced = problem.bundle->valid() ? problem.bundle->reduced() : std::nullopt;
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
                   LightStage stage, const LightState& state) {
  const auto models = unknowns.cameras(state.values);
  std::vector<double> distances;
  const std::vector<double> given_back_to = given_back(unknowns, stage, state);
  for (const std::size_t i : points_in_use(state)) {
    const double given_back = given_back_to[i];
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      if (!models || !state.used[c][i]) continue;
      const auto off = distance(cameras[c], i, (*models)[c], state, c);
      if (off) distances.push_back(given_back * *off / cameras[c].seen[i]->sigma);
    }
  }
  return robust_scale(std::move(distances));
}

void judge(const std::vector<LightCamera>& cameras, const LightUnknowns& unknowns, double limit,
           const std::vector<std::size_t>& instants, LightState& state) {
  const auto models = unknowns.cameras(state.values);
  if (!models) return;
  Judge by_rays(cameras, *models, limit, state);
  for (const std::size_t i : instants) by_rays.at(i);
}

}  // namespace calvin::rig
