// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every sensible model solved for the same corners, compared by the views that are held out.

#include "calvin/solve/auto_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/solve/split_halves.hpp"

namespace calvin {

namespace {

// The least gain of another model, in standard deviations of what noise makes of it, which exceeds
// it in 2.3 % of all cases.
constexpr double kGain = 2;

// Models whose corners held out are so many times as far off as those of the best are as good.
constexpr double kAsPredictive = 1.03;

struct Trial {
  std::string model;
  Solution solution;
  std::map<std::size_t, double> held_out;  // by the index of the view
};

// Per view index, px^2 per corner.
std::map<std::size_t, double> held_out_of(const std::vector<PointSet>& views,
                                          const Solution& solution) {
  const auto rejected = [&solution](std::size_t index) {
    return std::any_of(solution.rejected.begin(), solution.rejected.end(),
                       [index](const RejectedView& r) { return r.index == index; });
  };
  std::map<std::size_t, double> result;
  std::size_t at = 0;
  for (const PointSet& view : views) {
    if (rejected(view.index)) continue;
    if (at < solution.held_out.size()) result[view.index] = solution.held_out[at];
    ++at;
  }
  return result;
}

// The corners that a solution left out, weighing nothing.
std::vector<PointSet> masked(const std::vector<PointSet>& views, const Solution& solution) {
  std::vector<PointSet> result;
  std::vector<std::pair<std::size_t, int>> left_out;  // in order: there may be many thousands
  left_out.reserve(solution.rejected_corners.size());
  for (const RejectedCorner& c : solution.rejected_corners) left_out.emplace_back(c.view, c.id);
  std::sort(left_out.begin(), left_out.end());
  for (const PointSet& view : views) {
    const auto is_this = [&view](const RejectedView& r) { return r.index == view.index; };
    if (std::any_of(solution.rejected.begin(), solution.rejected.end(), is_this)) continue;
    PointSet kept = view.without_corners();
    for (std::size_t i = 0; i < view.size(); ++i) {
      const std::pair corner = {view.index, view.ids[i]};
      if (!std::binary_search(left_out.begin(), left_out.end(), corner)) kept.append(view, i);
    }
    result.push_back(std::move(kept));
  }
  return result;
}

// Whether `b` predicts views held out better than `a` does, by more than chance: the signed ranks
// of the differences (F. Wilcoxon, Biometrics Bulletin 1, 1945). A model that is far from right is
// so by much in a few views, which their ranks bound.
bool is_better_by_ranks(const Trial& a, const Trial& b) {
  std::vector<double> differences;
  for (const auto& [view, cost] : a.held_out) {
    const auto other = b.held_out.find(view);
    const bool known =
        other != b.held_out.end() && (std::isfinite(cost) || std::isfinite(other->second));
    if (known) differences.push_back(cost - other->second);
  }
  std::ranges::sort(differences, {}, [](double d) { return std::abs(d); });
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const auto rank = static_cast<double>(i + 1);
    sum += differences[i] > 0 ? rank : -rank;
    squares += rank * rank;
  }
  return sum > kGain * std::sqrt(squares);
}

// From simple to rich; lenses about a plane come first, which most other programs read.
std::vector<std::string> candidates() {
  auto lenses = lenses_where([](const LensTraits& lens) { return lens.candidate; });
  std::stable_partition(lenses.begin(), lenses.end(),
                        [](const LensTraits* lens) { return lens->perspective; });
  std::vector<std::string> models;
  for (const LensTraits* lens : lenses) models.emplace_back(lens->model);
  return models;
}

std::vector<Trial> try_all(const std::vector<std::string>& models,
                           const std::vector<PointSet>& views, const BoardShape& shape,
                           ImageSize size, SolveOptions options, const std::stop_token& stop) {
  std::vector<Trial> trials;
  for (const std::string& model : models) {
    if (stop.stop_requested()) break;
    options.model = model;
    auto solution = solve_points(views, shape, size, options, stop);
    if (!solution) continue;
    auto held_out = held_out_of(views, *solution);
    trials.push_back({options.model, *std::move(solution), std::move(held_out)});
  }
  return trials;
}

double held_out_rms(const Trial& trial) {
  return trial.solution.calibration.held_out_rms.value_or(HUGE_VAL);
}

// Takes out those that leave out views which another one keeps, of views that are all good: they
// end in a lens that does not show what these saw, and are no better for it.
void drop_partial(std::vector<Trial>& trials) {
  std::size_t fewest = SIZE_MAX;
  for (const Trial& trial : trials) fewest = std::min(fewest, trial.solution.rejected.size());
  std::erase_if(trials,
                [fewest](const Trial& trial) { return trial.solution.rejected.size() > fewest; });
}

struct Rivals {
  std::vector<std::string> near;
  std::vector<std::string> far;
};

// Which models may still be the best once all have the same corners. A poor model has left out
// those that it explains worst, so that it is no better than it looks.
Rivals rivals_of(const std::vector<Trial>& trials) {
  constexpr double kFar = 1.5;  // times the least distance of corners held out
  double least = HUGE_VAL;
  for (const Trial& trial : trials) least = std::min(least, held_out_rms(trial));
  Rivals rivals;
  for (const Trial& trial : trials) {
    (held_out_rms(trial) <= kFar * least ? rivals.near : rivals.far).push_back(trial.model);
  }
  return rivals;
}

// The models that predict views held out about as well as the best one does, in the order of the
// trials.
std::vector<std::size_t> as_good_as_any(const std::vector<Trial>& trials) {
  double least = HUGE_VAL;
  for (const Trial& trial : trials) least = std::min(least, held_out_rms(trial));
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (held_out_rms(trials[i]) <= kAsPredictive * least) good.push_back(i);
  }
  return good;
}

double error_anywhere(const Trial& trial) {
  return trial.solution.calibration.expected_error_anywhere.value_or(HUGE_VAL);
}

// Of the models that are as good as any the first on which halves of the views agree about as well
// as on any of these; where that knows little of what no corner was seen in, one that knows more.
std::size_t choose(const std::vector<Trial>& trials, const std::vector<PointSet>& views,
                   const BoardShape& shape, SolveOptions options, const std::stop_token& stop) {
  constexpr double kAsClose = 1.1;     // times the least difference of halves
  constexpr double kStillClose = 1.2;  // likewise
  constexpr double kLittle = 5;        // times the error among corners that is elsewhere
  constexpr double kMore = 0.7;        // times the error that may be anywhere in the picture
  const std::vector<std::size_t> good = as_good_as_any(trials);
  std::vector<double> apart;
  for (const std::size_t i : good) {
    options.model = trials[i].model;
    apart.push_back(good.size() == 1 ? 0
                                     : split_half_difference(views, trials[i].solution.calibration,
                                                             shape, options, stop)
                                           .value_or(HUGE_VAL));
  }
  const double least = *std::min_element(apart.begin(), apart.end());
  const auto first =
      std::find_if(apart.begin(), apart.end(), [&](double d) { return d <= kAsClose * least; });
  std::size_t best = good[static_cast<std::size_t>(first - apart.begin())];
  const double among_corners = trials[best].solution.calibration.expected_error.value_or(0);
  if (error_anywhere(trials[best]) <= kLittle * among_corners) return best;
  const double most = kMore * error_anywhere(trials[best]);
  for (std::size_t k = 0; k < good.size(); ++k) {
    const double error = error_anywhere(trials[good[k]]);
    if (apart[k] > kStillClose * least || error > most) continue;
    if (error < error_anywhere(trials[best])) best = good[k];
  }
  return best;
}

std::string explain(const std::vector<Trial>& trials, std::size_t best,
                    const std::vector<std::string>& far) {
  const auto words = [](const Trial& trial) {
    return fmt::format("{} {:.3g} px", trial.model, held_out_rms(trial));
  };
  std::vector<std::string> held_out = {words(trials[best])};
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (i != best) held_out.push_back(words(trials[i]));
  }
  for (const std::string& model : far) held_out.push_back(model + " far worse");
  return fmt::format(
      "The views ask for the model {}: halves of the views agree on it (from 8 views on), of those "
      "that predict views held out to within 3 % of the best. On views held out: {}.",
      trials[best].model, join(held_out, ", "));
}

}  // namespace

Result<Solution> solve_auto(const std::vector<PointSet>& views, const BoardShape& shape,
                            ImageSize image_size, const SolveOptions& options,
                            const std::stop_token& stop) {
  SolveOptions trial_options = options;
  trial_options.checks = true;
  // A poor model rejects good corners that it cannot explain, so the best model decides for all
  // which corners are wrong.
  const std::vector<PointSet> some = some_of(views);
  std::vector<Trial> trials = try_all(candidates(), some, shape, image_size, trial_options, stop);
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  if (trials.empty()) {
    trial_options.model = "pinhole";
    return solve_points(views, shape, image_size, trial_options, stop);
  }
  const Trial& most_predictive = *std::min_element(
      trials.begin(), trials.end(),
      [](const Trial& a, const Trial& b) { return held_out_rms(a) < held_out_rms(b); });
  trial_options.model = most_predictive.model;
  const Result<Solution> of_all = some.size() == views.size()
                                      ? Result<Solution>(most_predictive.solution)
                                      : solve_points(views, shape, image_size, trial_options, stop);
  if (!of_all) return of_all;
  const Solution& reference = *of_all;
  trial_options.reject_outliers = false;
  const std::vector<PointSet> good_corners = masked(views, reference);
  const Rivals rivals = rivals_of(trials);
  trials = try_all(rivals.near, good_corners, shape, image_size, trial_options, stop);
  drop_partial(trials);
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  if (trials.empty()) return reference;
  const std::size_t best = choose(trials, good_corners, shape, trial_options, stop);
  if (stop.stop_requested()) return make_error(ErrorCode::kCancelled, "The solve was stopped.");
  Solution solution = trials[best].solution;
  // The best model may have rejected a view that the reference kept; both lists are reported.
  const auto add = [](auto& all, const auto& more) {
    all.insert(all.end(), more.begin(), more.end());
  };
  add(solution.rejected, reference.rejected);
  add(solution.rejected_corners, reference.rejected_corners);
  solution.calibration.remarks.push_back(explain(trials, best, rivals.far));
  return solution;
}

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
}

// All candidates, from simple to rich; none where the richest of them are no better than `own`, and
// nothing else makes the lens suspect.
std::vector<Trial> try_others(const Trial& own, bool is_suspect, const std::vector<PointSet>& views,
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

}  // namespace

bool may_be_the_lens(const Misfit& misfit) {
  constexpr double kHalvesDiffer = 1.5;
  if (misfit.found() || misfit.split_half_ratio > kHalvesDiffer) return true;
  return misfit.noticed != Misfit::Cause::kNone && misfit.noticed != Misfit::Cause::kBoard;
}

void try_other_models(Solution& solution, const std::vector<PointSet>& views,
                      const BoardShape& shape, ImageSize image_size, const SolveOptions& options,
                      const std::stop_token& stop) {
  constexpr double kHalf = 0.5;      // of the variance of views held out
  constexpr double kGoodEnough = 1;  // px, whatever an error is made of
  constexpr double kGrown = 2;       // times the error that was promised without it
  Calibration& calibration = solution.calibration;
  const Trial own = {options.model, solution, held_out_of(views, solution)};
  Misfit& misfit = solution.misfit;
  const bool was_suspected = misfit.found() || misfit.noticed == Misfit::Cause::kModel;
  const std::vector<Trial> others =
      try_others(own, was_suspected, some_of(views), shape, image_size, options, stop);
  const Trial* better = better_than(own, others);
  if (better == nullptr) return;
  const double before = calibration.expected_error.value_or(0);
  hold_difference(calibration, better->solution.calibration);
  const double after = calibration.expected_error.value_or(0);
  const bool was_noticed = misfit.noticed != Misfit::Cause::kNone;
  const bool is_removed = squares_held_out(*better) <= kHalf * squares_held_out(own);
  if ((was_suspected && is_removed) || after > std::max(kGoodEnough, kGrown * before)) {
    misfit.cause = Misfit::Cause::kModel;
  }
  const bool is_of_board = misfit.noticed == Misfit::Cause::kBoard;
  const bool is_cause = misfit.cause == Misfit::Cause::kModel || (!misfit.found() && !is_of_board);
  if (is_cause) misfit.noticed = Misfit::Cause::kModel;
  calibration.misfit = to_string(misfit.cause);
  // Beside another cause it is a remark of its own.
  auto& remarks = calibration.remarks;
  auto remark = remarks.begin() + (is_cause ? 0 : 1);
  if (!was_noticed || !is_cause) remark = remarks.emplace(remark);
  *remark = lacks(calibration, own, *better);
}

}  // namespace calvin
