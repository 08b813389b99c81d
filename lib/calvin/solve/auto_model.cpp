// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Every sensible model solved for the same corners, compared by the views that are held out.

#include "calvin/solve/auto_model.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"
#include "calvin/solve/difference.hpp"
#include "calvin/solve/judge/remarks.hpp"
#include "calvin/solve/models/trials.hpp"
#include "calvin/solve/split_halves.hpp"

namespace calvin {

namespace {

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

// Models that fit as well may differ where no corner was seen, and none of them knows: the promise
// for the whole picture holds how far one of them is from `chosen` that is sure of itself there. Of
// a wide lens a lens about a plane tells nothing but where corners were.
void hold_rivals(Calibration& chosen, const std::vector<Trial>& trials) {
  constexpr double kSure = 2;   // times what the other one promises itself, 2 sigma
  constexpr double kGrown = 2;  // times the promise before, to be a remark
  const auto own = Camera::make(chosen);
  if (!own || !chosen.expected_error_anywhere) return;
  const bool is_perspective = find_lens(chosen.model)->perspective;
  const double before = *chosen.expected_error_anywhere;
  const auto remark = uncovered(chosen);
  DifferenceOptions options;
  options.focus = {chosen.covered};
  std::string words;
  for (const std::size_t i : as_good_as_any(trials)) {
    const std::string& model = trials[i].model;
    const auto other = Camera::make(trials[i].solution.calibration);
    if (!other || model == chosen.model || find_lens(model)->perspective != is_perspective)
      continue;
    const auto apart = difference(*own, *other, options);
    if (!apart || !(apart->image.max > 2 * kSure * error_anywhere(trials[i]))) continue;
    const double all = std::hypot(before, apart->image.max / 2 + error_anywhere(trials[i]));
    if (!(all > *chosen.expected_error_anywhere)) continue;
    chosen.expected_error_anywhere = all;
    chosen.worst_place = apart->image.worst;
    words = fmt::format(
        "Where no corner was seen {} and {} differ by {:.2g} px, though both fit the views as "
        "well.",
        chosen.model, model, apart->image.max);
  }
  renew_uncovered(chosen, remark);
  if (*chosen.expected_error_anywhere > kGrown * before) {
    chosen.remarks.push_back(std::move(words));
  }
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
  hold_rivals(solution.calibration, trials);
  solution.calibration.remarks.push_back(explain(trials, best, rivals.far));
  return solution;
}

}  // namespace calvin
