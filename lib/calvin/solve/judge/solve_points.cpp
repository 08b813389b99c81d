// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The chain of one model: weights, fit, common sigma, solution.

#include "calvin/solve/judge/solve_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/fit/board_fit.hpp"
#include "calvin/solve/fit/camera_fit.hpp"
#include "calvin/solve/fit/weights.hpp"
#include "calvin/solve/judge/make_solution.hpp"
#include "calvin/solve/methods/methods.hpp"

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

// Fits with the common sigma, and with the offsets of the board's points, where they are unknowns.
class BoardedFit {
 public:
  BoardedFit(const BoardShape& shape, ImageSize size, const Parameterization& parameterization,
             const SolveOptions& options, Weights original, const WeightScale& scale,
             const std::stop_token& stop)
      : shape_(shape),
        size_(size),
        parameterization_(parameterization),
        options_(options),
        original_(std::move(original)),
        scale_(scale),
        stop_(stop) {}

  Fit run(std::vector<PointSet> views) {
    if (!shape_.offsets) return settled(std::move(views));
    BoardFit board =
        shape_.start ? BoardFit(*shape_.offsets, *shape_.start) : BoardFit(*shape_.offsets);
    board.place(views);
    Fit fit = settled(std::move(views));
    if (!options_.offsets) return known(board, std::move(fit));
    // A board that is another one than the measured one is no better for steps away from it.
    contradicted_ = options_.measured && linearise(board, fit) && board.contradicts_prior();
    if (contradicted_) return fit;
    return estimated(board, std::move(fit));
  }

  [[nodiscard]] bool contradicted() const { return contradicted_; }

 private:
  bool linearise(BoardFit& board, const Fit& fit) const {
    return fit.converged && board.linearise(fit, shape_, parameterization_);
  }

  // With offsets that these views estimate, too.
  Fit estimated(BoardFit& board, Fit fit) {
    constexpr int kRounds = 5;
    // A smaller decrease of the cost is that of a few hundredths of a sigma, of all offsets.
    constexpr double kSmall = 1e-6;
    for (int i = 0; linearise(board, fit); ++i) {
      const auto decrease = board.find_step(scale_.sigma);
      if (!decrease) break;
      if (i == kRounds || *decrease < kSmall * fit.cost) {
        fit.board = board.fitted();
        break;
      }
      board.take_step();
      board.place(fit.views);
      fit = settled(with_common_sigma(std::move(fit.views), original_, scale_, common_));
    }
    return fit;
  }

  // With the offsets that others found. No error of the board hides any more how much worse one
  // view is than another, so that each gets a weight of its own.
  Fit known(BoardFit& board, Fit fit) {
    constexpr int kRounds = 2;
    const Weights told = original_;
    for (int i = 0; i < kRounds && fit.converged && scale_.known; ++i) {
      original_ = with_view_factors(fit, told, scale_);
      fit = settled(with_common_sigma(std::move(fit.views), original_, scale_, common_));
    }
    if (!linearise(board, fit)) return fit;
    contradicted_ = board.contradicts_prior();
    if (!contradicted_) fit.board = board.known();
    return fit;
  }

  // The fit to points that stand still.
  Fit settled(std::vector<PointSet> views) {
    Fit fit = fit_camera(std::move(views), shape_, size_, parameterization_, options_, stop_);
    constexpr int kRounds = 3;
    for (int i = 0; i < kRounds && fit.converged && scale_.known; ++i) {
      const double common = common_sigma(fit, original_, scale_, stop_);
      if (std::abs(common - common_) <= kConverged * common) break;
      fit = fit_camera(with_common_sigma(std::move(fit.views), original_, scale_, common), shape_,
                       size_, parameterization_, options_, stop_);
      common_ = common;
    }
    return fit;
  }

  const BoardShape& shape_;
  ImageSize size_;
  const Parameterization& parameterization_;
  const SolveOptions& options_;
  Weights original_;
  WeightScale scale_;
  const std::stop_token& stop_;
  double common_ = 0;
  bool contradicted_ = false;
};

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
  if (!options.method.empty()) {
    const auto start = run_method(options.method, method_input(views, image_size, options));
    if (!start) return tl::unexpected<Error>(start.error());
    start_from(start->start.value_or(start->camera).to_calibration(), *parameterization);
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
  BoardedFit run(shape, image_size, *parameterization, options, original, scale, stop);
  const Fit fit = run.run(std::move(views));
  const double chi = fit.converged ? chi_of(fit, *parameterization, original, scale) : 1;
  auto solution =
      make_solution({fit, *parameterization, shape, scale, chi}, image_size, options, stop);
  if (solution) solution->other_board = run.contradicted();
  return solution;
}

}  // namespace calvin
