// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A model too rich for the views gives way to the richest of its simpler ones.

#include "calvin/solve/models/simpler_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

bool holds(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// Without what is fixed of the coefficients that the simpler model does not have.
SolveOptions for_model(SolveOptions options, std::string_view model) {
  const auto own = parameter_names(options.model);
  const auto left = parameter_names(model);
  std::erase_if(options.fix, [&](const std::string& fix) {
    const auto names = split(fix, '=');
    return std::any_of(names.begin(), names.end(), [&](std::string_view name) {
      return holds(own, name) && !holds(left, name);
    });
  });
  options.model = model;
  return options;
}

// Whether the simpler solution takes the place of the one that was asked for.
bool is_surer(const Solution& simpler, const Solution& asked) {
  constexpr double kSurer = 4;      // times
  constexpr double kAsGood = 1.02;  // times the distance of corners held out
  const Calibration& a = asked.calibration;
  const Calibration& b = simpler.calibration;
  return b.expected_error && *b.expected_error * kSurer < a.expected_error.value_or(HUGE_VAL) &&
         b.held_out_rms && a.held_out_rms && *b.held_out_rms < kAsGood * *a.held_out_rms;
}

}  // namespace

std::vector<std::string_view> simpler_models(std::string_view model) {
  const LensTraits* lens = find_lens(model);
  if (lens == nullptr) return {};
  auto simpler = lenses_where([lens](const LensTraits& other) {
    return other.perspective == lens->perspective &&
           other.coefficients.size() < lens->coefficients.size() &&
           std::all_of(other.coefficients.begin(), other.coefficients.end(),
                       [lens](std::string_view name) { return holds(lens->coefficients, name); });
  });
  std::stable_sort(simpler.begin(), simpler.end(), [](const LensTraits* a, const LensTraits* b) {
    return a->coefficients.size() > b->coefficients.size();
  });
  std::vector<std::string_view> names;
  for (const LensTraits* other : simpler) names.push_back(other->model);
  return names;
}

bool leaves_open(const Result<Solution>& asked, ImageSize image_size) {
  constexpr double kLittle = 0.002;  // of the image width
  if (!asked) return asked.error().code == ErrorCode::kDegenerate;
  // Of a distortion that folds back where corners are nothing is promised.
  return asked->calibration.expected_error.value_or(HUGE_VAL) > kLittle * image_size.width;
}

Result<Solution> solve_simpler(Result<Solution> asked, const std::vector<PointSet>& views,
                               const BoardShape& shape, ImageSize image_size,
                               const SolveOptions& options, const std::stop_token& stop) {
  for (const std::string_view model : simpler_models(options.model)) {
    if (stop.stop_requested()) break;
    auto simpler = solve_points(views, shape, image_size, for_model(options, model), stop);
    if (!simpler) continue;
    if (simpler->misfit.cause == Misfit::Cause::kModel) break;
    if (asked && !is_surer(*simpler, *asked)) continue;
    auto& remarks = simpler->calibration.remarks;
    remarks.insert(
        remarks.begin(),
        fmt::format("The views do not determine the model {}, so that {} was taken: show the board "
                    "nearer, at the borders of the picture and tilted 30 to 45 degrees.",
                    options.model, model));
    return simpler;
  }
  return asked;
}

}  // namespace calvin
