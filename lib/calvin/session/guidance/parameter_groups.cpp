// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Splits the expected error by what the parameters mean.

#include "calvin/session/guidance/parameter_groups.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "calvin/solve/uncertainty.hpp"

namespace calvin {

namespace {

constexpr std::string_view kDistortion = "distortion";
constexpr std::array<std::string_view, 3> kGroups = {"focal length", "principal point",
                                                     kDistortion};

// What is none of the others bends the picture: skew is a distortion to a user as well.
std::string_view group_of(std::string_view parameter) {
  if (parameter == "fx" || parameter == "fy") return kGroups[0];
  if (parameter == "cx" || parameter == "cy") return kGroups[1];
  return kDistortion;
}

// The error that is left where every parameter of another group is known.
double error_of(Calibration calibration, std::string_view group) {
  std::vector<bool> is_in;
  for (const Parameter& p : calibration.parameters) {
    if (p.sigma) is_in.push_back(group_of(p.name) == group);
  }
  const std::size_t n = is_in.size();
  if (std::ranges::none_of(is_in, [](bool in) { return in; })) return 0;
  if (calibration.covariance.size() != n * n) return HUGE_VAL;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      if (!is_in[i] || !is_in[k]) calibration.covariance[i * n + k] = 0;
    }
  }
  return expected_error_anywhere(calibration).value_or(HUGE_VAL);
}

std::string line_of(const Parameter& p) {
  constexpr int kMostDigits = 4;  // behind the point
  const double sigma = p.sigma.value_or(0);
  if (!(sigma > 0) || !std::isfinite(sigma)) return fmt::format("{} {:.6g}", p.name, p.value);
  const int digits = -static_cast<int>(std::floor(std::log10(sigma)));
  if (digits > kMostDigits) return fmt::format("{} {:.2e} \u00b1 {:.0e}", p.name, p.value, sigma);
  const int shown = std::max(0, digits);
  return fmt::format("{} {:.{}f} \u00b1 {:.{}f}", p.name, p.value, shown, sigma, shown);
}

}  // namespace

std::vector<GroupError> parameter_errors(const Calibration& calibration) {
  const double whole = expected_error_anywhere(calibration).value_or(HUGE_VAL);
  std::vector<GroupError> errors;
  for (const std::string_view group : kGroups) {
    const auto is_of = [&](const Parameter& p) { return group_of(p.name) == group; };
    if (std::ranges::none_of(calibration.parameters, is_of)) continue;
    errors.push_back({std::string(group), std::min(whole, error_of(calibration, group))});
  }
  return errors;
}

std::vector<ParameterGroup> parameter_groups(const std::vector<GroupError>& errors, double wanted) {
  std::vector<ParameterGroup> groups;
  for (const GroupError& e : errors) {
    const double known = e.expected_error > wanted ? wanted / e.expected_error : 1;
    groups.push_back({e.name, std::clamp(known, 0.0, 1.0)});
  }
  return groups;
}

std::vector<std::string> parameter_lines(const Calibration& calibration) {
  std::vector<std::string> lines;
  for (const Parameter& p : calibration.parameters) lines.push_back(line_of(p));
  return lines;
}

}  // namespace calvin
