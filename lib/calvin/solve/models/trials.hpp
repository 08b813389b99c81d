// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Solves of one set of views by several models, and how well each predicts views held out.
// Internal.
#pragma once

#include <cstddef>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "calvin/solve/judge/solve_points.hpp"

namespace calvin {

// Models whose corners held out are so many times as far off as those of the best are as good.
inline constexpr double kAsPredictive = 1.03;

struct Trial {
  std::string model;
  Solution solution;
  std::map<std::size_t, double> held_out;  // by the index of the view
};

// The models that are tried, from simple to rich; lenses about a plane come first, which most other
// programs read.
[[nodiscard]] std::vector<std::string> candidates();

// px^2 per corner, by the index of the view.
[[nodiscard]] std::map<std::size_t, double> held_out_of(const std::vector<PointSet>& views,
                                                        const Solution& solution);

// Those that can be solved, as the options ask for but for their model.
[[nodiscard]] std::vector<Trial> try_all(const std::vector<std::string>& models,
                                         const std::vector<PointSet>& views,
                                         const BoardShape& shape, ImageSize size,
                                         SolveOptions options, const std::stop_token& stop);

[[nodiscard]] double held_out_rms(const Trial& trial);  // px

// Whether `b` predicts views held out better than `a` does, by more than chance: the signed ranks
// of the differences (F. Wilcoxon, Biometrics Bulletin 1, 1945). A model that is far from right is
// so by much in a few views, which their ranks bound.
[[nodiscard]] bool is_better_by_ranks(const Trial& a, const Trial& b);

}  // namespace calvin
