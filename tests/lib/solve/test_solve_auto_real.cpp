// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The model that model=auto takes for real pictures: it tells views held out as well as any other,
// halves of the views agree on it, and like cameras get the same one.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/lens_table.hpp"
#include "halves.hpp"
#include "real_sets.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using real::Set;

SolveOptions options_for(std::string_view model) {
  SolveOptions options;
  options.model = model;
  return options;
}

// What is known of a model without believing its own covariance.
struct Quality {
  double held_out = HUGE_VAL;  // px, RMS over views that took no part
  double halves = HUGE_VAL;    // px, the median of the largest differences where both covered
};

double median(std::vector<double> values) {
  if (values.empty()) return HUGE_VAL;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Quality quality_of(const real::Views& all, std::string_view model, int count) {
  const SolveOptions options = options_for(model);
  const auto solution = solve(all.views, all.size, options);
  if (!solution || solution->calibration.model != model) return {};
  const auto apart = scenes::halves(all.views, all.size, options, count);
  Quality quality = {solution->calibration.held_out_rms.value_or(HUGE_VAL), HUGE_VAL};
  if (apart.pixels.size() * 2 >= static_cast<std::size_t>(count)) {
    quality.halves = median(apart.pixels);
  }
  return quality;
}

std::vector<std::string_view> candidates() {
  std::vector<std::string_view> models;
  for (const LensTraits* lens : lenses_where([](const LensTraits& l) { return l.candidate; })) {
    models.push_back(lens->model);
  }
  return models;
}

// One set of which several models tell views held out alike, and one of a narrow lens.
bool is_telling(std::string_view name) { return name == "left" || name == "picam"; }

TEST(AutoOfRealSets, TakesAModelThatHalvesAgreeOn) {
  constexpr double kAsGood = 1.03;  // times the best distance of views held out
  constexpr double kAgree = 1.2;    // times the best difference of halves
  const int count = scenes::full_count() ? 40 : 12;
  // Halves are drawn by lot here and in the library: each other ones.
  const double luck = scenes::full_count() ? 1.1 : 1.4;
  std::string missing;
  for (const Set& set : real::kSets) {
    if (!scenes::full_count() && !is_telling(set.name)) continue;
    const real::Views all = real::read(set);
    if (all.views.empty()) {
      missing = std::string("CALVIN_DATA does not name a folder with ") + set.folder;
      continue;
    }
    const auto chosen = solve(all.views, all.size, options_for("auto"));
    ASSERT_TRUE(chosen) << set.name << ": " << chosen.error().message;
    const std::string& model = chosen->calibration.model;
    std::map<std::string, Quality> qualities;
    double best = HUGE_VAL;
    for (const auto name : candidates()) {
      const Quality quality = quality_of(all, name, count);
      best = std::min(best, quality.held_out);
      qualities[std::string(name)] = quality;
    }
    double least = HUGE_VAL;
    for (const auto& [name, quality] : qualities) {
      std::cout << "  " << set.name << (name == model ? " * " : "   ") << name << ": held out "
                << quality.held_out << ", halves " << quality.halves << "\n";
      if (quality.held_out <= kAsGood * best) least = std::min(least, quality.halves);
    }
    EXPECT_LE(qualities[model].held_out, kAsGood * best) << set.name << ": " << model;
    EXPECT_LE(qualities[model].halves, kAgree * luck * least) << set.name << ": " << model;
  }
  if (!missing.empty()) GTEST_SKIP() << missing;
}

const Set& set_of(std::string_view name) {
  return *std::find_if(real::kSets.begin(), real::kSets.end(),
                       [name](const Set& set) { return set.name == name; });
}

// How far the model that auto takes for the other camera is from its own one, where corners were,
// over its promise: twice the expected error.
double disagreement(const real::Views& all, const Calibration& own, const std::string& other) {
  const auto with_other = solve(all.views, all.size, options_for(other));
  if (!with_other) return HUGE_VAL;
  const auto apart =
      difference(Camera::make(own).value(), Camera::make(with_other->calibration).value(),
                 {.focus = {own.covered}});
  return apart ? apart->focus.max / (2 * own.expected_error.value()) : HUGE_VAL;
}

// Boards in the middle of a wide picture tell rational8 and fisheye about as well, and only one of
// them is known beyond.
TEST(AutoOfRealSets, KnowsMoreOfThePictureWhereCornersTellNoDifference) {
  const real::Views all = real::read(set_of("camodocal"));
  if (all.views.empty()) GTEST_SKIP() << "CALVIN_DATA does not name a folder with camodocal";
  const auto chosen = solve(all.views, all.size, options_for("auto"));
  const auto richer = solve(all.views, all.size, options_for("rational8"));
  ASSERT_TRUE(chosen && richer);
  EXPECT_LT(chosen->calibration.expected_error_anywhere.value_or(HUGE_VAL),
            0.8 * richer->calibration.expected_error_anywhere.value_or(HUGE_VAL))
      << chosen->calibration.model;
}

// Cameras of a pair are alike, and so is what auto says of them. Not of the pair stereo_left and
// stereo_right: views held out of the left one ask for rational8, by 3 to 4 %, those of the right
// one do not.
TEST(AutoOfRealSets, IsTheSameForLikeCameras) {
  const std::pair<const char*, const char*> pairs[] = {{"left", "right"}, {"yac0", "yac1"}};
  for (const auto& [first, second] : pairs) {
    const real::Views a = real::read(set_of(first));
    const real::Views b = real::read(set_of(second));
    if (a.views.empty() || b.views.empty()) {
      GTEST_SKIP() << "CALVIN_DATA does not name a folder with the sets " << first << " and "
                   << second;
    }
    const auto of_a = solve(a.views, a.size, options_for("auto"));
    const auto of_b = solve(b.views, b.size, options_for("auto"));
    ASSERT_TRUE(of_a && of_b) << first;
    const Calibration& one = of_a->calibration;
    const Calibration& other = of_b->calibration;
    if (one.model == other.model) continue;
    EXPECT_LT(disagreement(a, one, other.model), 1) << first << ": " << one.model;
    EXPECT_LT(disagreement(b, other, one.model), 1) << second << ": " << other.model;
  }
}

}  // namespace
}  // namespace calvin
