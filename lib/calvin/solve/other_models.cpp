// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What a solve finds fault with, and another model does not.

#include "calvin/solve/other_models.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/auto_model.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/solve/judge/remarks.hpp"
#include "calvin/solve/models/trials.hpp"
#include "calvin/solve/split_halves.hpp"

namespace calvin {

namespace {

// The two richest of those about a plane, of which the richest is not always determined, and the
// richest wide one.
std::vector<std::string> richest() {
  std::vector<std::string> about_a_plane;
  std::vector<std::string> wide;
  for (const std::string& model : candidates()) {
    (find_lens(model)->perspective ? about_a_plane : wide).push_back(model);
  }
  return {about_a_plane.rbegin()[1], about_a_plane.back(), wide.back()};
}

double squares_held_out(const Trial& trial) { return held_out_rms(trial) * held_out_rms(trial); }

// Of the models that predict views held out clearly better than `own` the best; about a plane, the
// simplest that is as good. nullptr where none does.
const Trial* better_than(const Trial& own, const std::vector<Trial>& others) {
  constexpr double kLess = 0.8;  // of the variance
  std::vector<const Trial*> better;
  for (const Trial& other : others) {
    if (!is_better_by_ranks(own, other)) continue;
    if (squares_held_out(other) <= kLess * squares_held_out(own)) better.push_back(&other);
  }
  if (better.empty()) return nullptr;
  const Trial& best = **std::ranges::min_element(
      better, {}, [](const Trial* trial) { return held_out_rms(*trial); });
  if (!find_lens(best.model)->perspective) return &best;
  return *std::ranges::find_if(better, [&best](const Trial* trial) {
    return held_out_rms(*trial) <= kAsPredictive * held_out_rms(best);
  });
}

constexpr double kGoodEnough = 1;  // px, whatever an error is made of

// What the lens of a model lacks is in no covariance: the promises hold how far the projections of
// a better model are from its own, and what that one promises itself.
void hold_difference(Calibration& calibration, const Calibration& better) {
  const auto own = Camera::make(calibration);
  const auto other = Camera::make(better);
  if (!own || !other) return;
  DifferenceOptions options;
  options.focus = {calibration.covered};
  const auto apart = difference(*own, *other, options);
  if (!apart) return;
  const auto remark = uncovered(calibration);
  const auto held = [](std::optional<double>& promise, std::optional<double> of_other, double max) {
    if (!promise || !of_other) return 1.0;
    // Twice the promise is what a user is told.
    const double all = std::hypot(*promise, max / 2 + *of_other);
    return std::exchange(*promise, all) / all;
  };
  const double share = held(calibration.expected_error, better.expected_error, apart->focus.max);
  const double elsewhere =
      held(calibration.expected_error_anywhere, better.expected_error_anywhere, apart->image.max);
  constexpr double kMost = 0.5;  // of the promise: the rest of it is that
  if (elsewhere < kMost) calibration.worst_place = apart->image.worst;
  if (calibration.systematic) {
    calibration.systematic = 1 - (1 - *calibration.systematic) * share * share;
  }
  renew_uncovered(calibration, remark);
}

// All candidates, from simple to rich; none where the richest of them are no better than `own`, and
// nothing else makes the lens suspect.
std::vector<Trial> try_lenses(const Trial& own, bool is_suspect, const std::vector<PointSet>& views,
                              const BoardShape& shape, ImageSize size, const SolveOptions& options,
                              const std::stop_token& stop) {
  const std::vector<std::string> all = candidates();
  const std::vector<std::string> first = richest();
  std::vector<Trial> trials = try_all(first, views, shape, size, options, stop);
  if (!is_suspect && better_than(own, trials) == nullptr) return {};
  std::vector<std::string> rest = all;
  std::erase_if(rest, [&](const std::string& model) {
    return std::ranges::find(first, model) != first.end();
  });
  std::ranges::move(try_all(rest, views, shape, size, options, stop), std::back_inserter(trials));
  std::ranges::sort(trials, {}, [&all](const Trial& trial) {
    return std::ranges::find(all, trial.model) - all.begin();
  });
  return trials;
}

std::string lacks(const Calibration& calibration, const Trial& own, const Trial& better) {
  return fmt::format(
      "The lens distorts in ways that {} does not have: {} predicts views held out to {:.2g} px, "
      "where {} does to {:.2g} px. The accuracy of {:.2g} px holds that. Take {}, or model=auto.",
      calibration.model, better.model, held_out_rms(better), calibration.model, held_out_rms(own),
      2 * calibration.expected_error.value_or(0), better.model);
}

std::string contradicts(const Calibration& calibration, const Trial& own, const Trial& free,
                        const std::string& held) {
  return fmt::format(
      "What is held (fix={}) contradicts the views: {} with nothing held predicts those held "
      "out to {:.2g} px, else to {:.2g} px. The accuracy of {:.2g} px holds that. Hold less.",
      held, calibration.model, held_out_rms(free), held_out_rms(own),
      2 * calibration.expected_error.value_or(0));
}

std::string is_stretched(const Calibration& calibration, const BoardAspect& aspect) {
  const bool is_tall = aspect.value > 1;
  return fmt::format(
      "The board is {:.2g} % (+-{:.1g}) longer along its {} than by its text: the print is "
      "stretched. Measure it both ways, or print it anew at true scale. The accuracy of {:.2g} px "
      "holds that.",
      100 * ((is_tall ? aspect.value : 1 / aspect.value) - 1), 100 * aspect.sigma,
      is_tall ? "columns" : "rows", 2 * calibration.expected_error.value_or(0));
}

// A solve that is better than the one at hand: of a stretched board, with less held, or of another
// model.
struct Better {
  Trial trial;
  std::string held = {};  // what was let go for it
  [[nodiscard]] const std::optional<BoardAspect>& aspect() const {
    return trial.solution.board_aspect;
  }
  [[nodiscard]] Misfit::Cause cause() const {
    return aspect() ? Misfit::Cause::kBoard : Misfit::Cause::kModel;
  }
  [[nodiscard]] std::string words(const Calibration& calibration, const Trial& own) const {
    if (aspect()) return is_stretched(calibration, *aspect());
    return held.empty() ? lacks(calibration, own, trial)
                        : contradicts(calibration, own, trial, held);
  }
};

// The same model with nothing held: what is held may be wrong.
std::optional<Better> let_go(const Trial& own, const std::vector<PointSet>& views,
                             const BoardShape& shape, ImageSize size, SolveOptions options,
                             const std::stop_token& stop) {
  const std::vector<std::string> held = std::exchange(options.fix, {});
  if (held.empty()) return std::nullopt;
  const auto trials = try_all({own.model}, views, shape, size, options, stop);
  const Trial* free = better_than(own, trials);
  return free != nullptr ? std::optional(Better{*free, join(held, ",")}) : std::nullopt;
}

// The same with a board that may be stretched.
std::optional<Better> stretch(const Trial& own, const std::vector<PointSet>& views,
                              const BoardShape& stretched, ImageSize size,
                              const SolveOptions& options, const std::stop_token& stop) {
  constexpr double kSure = 5;  // sigma
  const auto trials = try_all({own.model}, views, stretched, size, options, stop);
  const Trial* better = better_than(own, trials);
  if (better == nullptr || !better->solution.board_aspect) return std::nullopt;
  const BoardAspect& aspect = *better->solution.board_aspect;
  if (!(std::abs(aspect.value - 1) > kSure * aspect.sigma)) return std::nullopt;
  return Better{*better};
}

// The promises hold how far the two are apart; the first remark says what is better.
void note_better(Solution& solution, const Trial& own, const Better& better, bool was_suspected) {
  constexpr double kHalf = 0.5;  // of the variance of views held out
  constexpr double kGrown = 2;   // times the error that was promised without it
  Calibration& calibration = solution.calibration;
  Misfit& misfit = solution.misfit;
  const double before = calibration.expected_error.value_or(0);
  hold_difference(calibration, better.trial.solution.calibration);
  const double after = calibration.expected_error.value_or(0);
  const bool was_noticed = misfit.noticed != Misfit::Cause::kNone;
  const bool is_removed = squares_held_out(better.trial) <= kHalf * squares_held_out(own);
  if ((was_suspected && is_removed) || after > std::max(kGoodEnough, kGrown * before)) {
    misfit.cause = better.cause();
  }
  const bool is_of_board = misfit.noticed == Misfit::Cause::kBoard;
  const bool is_cause = misfit.cause == better.cause() || (!misfit.found() && !is_of_board);
  if (is_cause) misfit.noticed = better.cause();
  calibration.misfit = to_string(misfit.cause);
  // Beside another cause it is a remark of its own.
  auto& remarks = calibration.remarks;
  auto remark = remarks.begin() + (is_cause ? 0 : 1);
  if (!was_noticed || !is_cause) remark = remarks.emplace(remark);
  *remark = better.words(calibration, own);
}

}  // namespace

bool may_be_the_lens(const Misfit& misfit) {
  constexpr double kHalvesDiffer = 1.5;
  if (misfit.found() || misfit.split_half_ratio > kHalvesDiffer) return true;
  return misfit.noticed != Misfit::Cause::kNone && misfit.noticed != Misfit::Cause::kBoard;
}

void try_others(Solution& solution, const std::vector<PointSet>& views, const BoardShape& shape,
                const std::optional<BoardShape>& stretched, ImageSize image_size,
                const SolveOptions& options, const std::stop_token& stop) {
  const Trial own = {solution.calibration.model, solution, held_out_of(views, solution)};
  const Misfit& misfit = solution.misfit;
  const bool was_suspected = misfit.found() || misfit.noticed == Misfit::Cause::kModel;
  const std::vector<PointSet> some = some_of(views);
  std::optional<Better> better = let_go(own, some, shape, image_size, options, stop);
  if (!better && stretched) better = stretch(own, some, *stretched, image_size, options, stop);
  if (!better && options.model != kAutoModel) {
    const auto lenses = try_lenses(own, was_suspected, some, shape, image_size, options, stop);
    if (const Trial* other = better_than(own, lenses)) better = Better{*other};
  }
  if (!better) return;
  // A print that is stretched can be mended, whatever was suspected.
  const double accuracy = 2 * solution.calibration.expected_error.value_or(0);
  const bool matters = better->aspect() && accuracy > kGoodEnough;
  note_better(solution, own, *better, was_suspected || matters);
}

}  // namespace calvin
