// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The chain of one model: weights, fit, common sigma, solution.

#include "calvin/solve/judge/solve_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/make_solution.hpp"

namespace calvin {

namespace {

// The common sigma has converged where it changes by a smaller part than this.
constexpr double kConverged = 0.02;

// Adds the priors that `initial` gives, in units of `sigma` px. Coefficients of another model mean
// something else, so that only fx fy cx cy of it count.
void add_initial_priors(ParameterTable& table, const SolveOptions& options, double sigma) {
  if (!options.initial || !options.initial_is_prior) return;
  const bool same = options.initial->model == options.model;
  const ParameterRange counts = same ? table.intrinsics(0) : table.pinhole(0);
  for (int i = counts.first; i < counts.end(); ++i) {
    const Parameter* known = options.initial->find(table.name(i));
    if (known == nullptr || !known->sigma || !(*known->sigma > 0)) continue;
    table.add_prior({i, known->value, *known->sigma / sigma});
  }
}

// The readout that views ask for; none, and nothing moves any more, where none of them shows a
// corner that a readout moves noticeably.
std::optional<ReadoutTime> readout_for(std::vector<PointSet>& views, const SolveOptions& options) {
  constexpr double kNoticeable = 0.03;  // px
  if (options.readout) {
    const double most = std::abs(options.readout->value) + 2 * options.readout->sigma;
    const auto noticeable = [most](const RowMotion& motion) {
      return std::hypot(motion.by_readout.u, motion.by_readout.v) * most > kNoticeable;
    };
    const auto moves = [&noticeable](const PointSet& view) {
      return std::ranges::any_of(view.motion, noticeable);
    };
    if (std::ranges::any_of(views, moves)) return options.readout;
  }
  for (PointSet& view : views) view.motion.clear();
  return std::nullopt;
}

}  // namespace

Result<Solution> solve_points(std::vector<PointSet> views, const BoardShape& shape,
                              ImageSize image_size, const SolveOptions& asked,
                              const std::stop_token& stop) {
  SolveOptions options = asked;
  options.readout = readout_for(views, asked);
  auto parameterization = make_parameterization(options, image_size, shape.unknowns);
  if (!parameterization) return tl::unexpected<Error>(parameterization.error());
  const std::vector<bool> all(views.size(), true);
  if (const Status status = check_equations(views, all, *parameterization, options.model);
      !status) {
    return tl::unexpected<Error>(status.error());
  }
  const WeightScale scale = normalise_weights(views);
  ParameterTable& table = parameterization->table;
  for (std::size_t m = 0; m < shape.modes; ++m) {
    table.add_prior({table.board(0)[static_cast<int>(m)], 0, shape.prior[m] / scale.sigma});
  }
  add_initial_priors(table, options, scale.sigma);
  if (options.readout && options.readout->sigma > 0) {
    table.add_prior(
        {table.readout(0).first, options.readout->value, options.readout->sigma / scale.sigma});
  }
  const Weights original = weights_of(views);
  Fit fit = fit_camera(std::move(views), shape, image_size, *parameterization, options, stop);
  constexpr int kRounds = 3;
  double before = 0;
  for (int i = 0; i < kRounds && fit.converged && scale.known; ++i) {
    const double common = common_sigma(fit, original, scale, stop);
    if (std::abs(common - before) <= kConverged * common) break;
    fit = fit_camera(with_common_sigma(std::move(fit.views), original, scale, common), shape,
                     image_size, *parameterization, options, stop);
    before = common;
  }
  const double chi = fit.converged ? chi_of(fit, *parameterization, original, scale) : 1;
  return make_solution({fit, *parameterization, shape, scale, chi}, image_size, options, stop);
}

}  // namespace calvin
