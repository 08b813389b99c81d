// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether promise and verdict are true on real pictures: halves of a set differ by what they
// predict, good sets are called good, and a model that lacks something is what is blamed.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "halves.hpp"
#include "real_sets.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using real::Set;
using scenes::Apart;

std::vector<Set> sets() {
  std::vector<Set> result = real::kSets;
  std::erase_if(result, [](const Set& set) { return !set.quick && !scenes::full_count(); });
  return result;
}

std::string absent(const Set& set) {
  return std::string("CALVIN_DATA does not name a folder with ") + set.folder;
}

SolveOptions model(const char* name) {
  SolveOptions options;
  options.model = name;
  return options;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double part_beyond(const std::vector<double>& values, double limit) {
  const auto beyond =
      std::count_if(values.begin(), values.end(), [limit](double x) { return x > limit; });
  return static_cast<double>(beyond) / static_cast<double>(values.size());
}

double rms(const std::vector<double>& squares) {
  double sum = 0;
  for (const double x : squares) sum += x;
  return std::sqrt(sum / static_cast<double>(squares.size()));
}

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

// The limits are those of issue 23; an ideal program was simulated and passes them.
TEST(RealSets, HalvesDifferByWhatTheyPredict) {
  // Forty halves tell little more than the draw: 5.9 % to 9.9 % beyond 2 were seen of one solver.
  const int count = scenes::full_count() ? 200 : 5;
  const double luck = scenes::full_count() ? 1 : 1.4;
  Apart pooled;
  std::string missing;
  for (const Set& set : sets()) {
    const real::Views all = real::read(set);
    if (all.views.empty()) {
      missing = absent(set);
      continue;
    }
    const Apart apart = scenes::halves(all.views, all.size, model(set.model), count);
    ASSERT_GE(apart.projections.size(), static_cast<std::size_t>(count) * 3 / 4) << set.name;
    const double middle = median(apart.projections);
    const double beyond = part_beyond(apart.projections, 2);
    const double spread = rms(apart.parameters);
    std::cout << "  " << set.name << ": median " << middle << ", beyond 2 in " << 100 * beyond
              << " %, parameters " << spread << "\n";
    EXPECT_GE(middle, 0.3 / luck) << set.name;
    EXPECT_LE(middle, 1.6 * luck) << set.name;
    EXPECT_LE(beyond, 0.3 * luck) << set.name;
    EXPECT_GE(spread, 0.6 / luck) << set.name;
    EXPECT_LE(spread, 1.6 * luck) << set.name;
    append(pooled.projections, apart.projections);
    append(pooled.parameters, apart.parameters);
  }
  if (pooled.projections.empty()) GTEST_SKIP() << missing;
  if (!missing.empty()) std::cout << "  not all sets: " << missing << "\n";
  std::cout << "  pooled: median " << median(pooled.projections) << ", beyond 2 in "
            << 100 * part_beyond(pooled.projections, 2) << " %, parameters "
            << rms(pooled.parameters) << "\n";
  // One set alone, as where only Debian's samples are there, has its own limits.
  if (!missing.empty()) return;
  const double chance = scenes::full_count() ? 0 : 0.03;
  EXPECT_LE(part_beyond(pooled.projections, 2), 0.09 + chance);
  EXPECT_GE(rms(pooled.parameters), 0.8 / luck);
  EXPECT_LE(rms(pooled.parameters), 1.25 * luck);
}

TEST(RealSets, TwoThirdsAtLeastAreGood) {
  double good = 0;
  double all = 0;
  std::string missing;
  for (const Set& set : sets()) {
    const real::Views views = real::read(set);
    if (views.views.empty()) {
      missing = absent(set);
      continue;
    }
    const auto solution = solve(views.views, views.size, model(set.model));
    ASSERT_TRUE(solution) << set.name << ": " << solution.error().message;
    const Calibration& c = solution->calibration;
    std::cout << "  " << set.name << ": " << c.misfit << ", accurate to " << 2 * *c.expected_error
              << " px\n";
    good += solution->misfit.found() ? 0 : 1;
    all += 1;
  }
  if (all == 0) GTEST_SKIP() << missing;
  EXPECT_GE(good, 2 * all / 3);
}

// A wide lens solved as a narrow one: neither the board nor a hand that moved it is to blame.
TEST(RealSets, TheModelIsBlamedWhereItIsThePoorPart) {
  std::string missing;
  for (const Set& set : real::kSets) {
    const std::string name = set.name;
    if (name != "ovplane" && (name != "camodocal" || !scenes::full_count())) continue;
    const real::Views views = real::read(set);
    if (views.views.empty()) {
      missing = absent(set);
      continue;
    }
    const auto solution = solve(views.views, views.size, model("brown5"));
    ASSERT_TRUE(solution) << solution.error().message;
    EXPECT_EQ(solution->calibration.misfit, "model") << set.name;
    EXPECT_NE(solution->calibration.remarks.front().find("fisheye"), std::string::npos)
        << solution->calibration.remarks.front();
  }
  if (!missing.empty()) GTEST_SKIP() << missing;
}

}  // namespace
}  // namespace calvin
