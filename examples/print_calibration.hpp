// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A calibration in words and numbers, as the tools print it.
#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calvin/core/calibration.hpp"
#include "calvin/core/expected_error.hpp"

namespace calvin_tools {

inline std::string number(double value) { return fmt::format("{:.6g}", value); }

// How far two are apart, in the sigmas of both; a truth has none.
inline void print_row(const calvin::Parameter& p, const calvin::Calibration* other) {
  fmt::print("{:<6} {:>12} {:>12}", p.name, number(p.value), p.sigma ? number(*p.sigma) : "");
  if (const auto* o = other != nullptr ? other->find(p.name) : nullptr) {
    const double sigma = std::hypot(p.sigma.value_or(0), o->sigma.value_or(0));
    fmt::print(" {:>12}", number(o->value));
    if (sigma > 0) fmt::print(" {:>8.2f}", (p.value - o->value) / sigma);
  }
  fmt::print("\n");
}

inline bool has_misfit(const calvin::Calibration& c) {
  return !c.misfit.empty() && c.misfit != "none";
}

inline void print_accuracy(const calvin::Calibration& c) {
  if (c.expected_error) {
    fmt::print("accurate to {:.4f} px where corners were seen (2 sigma)\n", 2 * *c.expected_error);
  }
  if (c.expected_error_anywhere && *c.expected_error_anywhere > calvin::kNothingKnown) {
    fmt::print("nothing is known of a part of the picture");
    if (c.worst_place) fmt::print(", as at {:.0f}, {:.0f}", c.worst_place->u, c.worst_place->v);
    fmt::print("\n");
  } else if (c.expected_error_anywhere) {
    fmt::print("accurate to {:.4f} px anywhere in the picture", 2 * *c.expected_error_anywhere);
    if (c.worst_place) fmt::print(", worst at {:.0f}, {:.0f}", c.worst_place->u, c.worst_place->v);
    fmt::print("\n");
  }
  if (c.split_half_ratio) {
    const bool held = *c.split_half_ratio > 1 && c.systematic.value_or(0) > 0;
    fmt::print("halves of the views differ by {:.2f} times what the noise of corners explains{}\n",
               *c.split_half_ratio, held ? "; sigmas and accuracy hold the rest too" : "");
  }
  if (has_misfit(c)) fmt::print("misfit: {}\n", c.misfit);
  for (const std::string& remark : c.remarks) fmt::print("{}\n", remark);
}

// Of which camera and model the other one is, whose parameters are beside those of `c`.
inline void print_other(const calvin::Calibration& c, const calvin::Calibration& other) {
  fmt::print("beside {} {}x{}, model {}\n", other.camera.empty() ? "camera" : other.camera,
             other.image_size.width, other.image_size.height, other.model);
  if (c.model == other.model) return;
  fmt::print(
      "Parameters of two models can have one name and mean different things: calvin-compare tells "
      "how far the two are apart in the picture.\n");
}

// `other` beside it.
inline void print(const calvin::Calibration& c, const calvin::Calibration* other = nullptr) {
  fmt::print("{} {}x{}, model {}", c.camera.empty() ? "camera" : c.camera, c.image_size.width,
             c.image_size.height, c.model);
  if (!c.views.empty()) fmt::print(", {} views", c.views.size());
  if (!c.board.empty()) fmt::print(" of {}", c.board);
  fmt::print("\n");
  if (other != nullptr) print_other(c, *other);
  fmt::print("{:<6} {:>12} {:>12}", "", "value", "sigma");
  if (other != nullptr) fmt::print(" {:>12} {:>8}", "other", "sigmas");
  fmt::print("\n");
  for (const calvin::Parameter& p : c.parameters) print_row(p, other);
  if (c.readout) {
    fmt::print("readout {:.2f} ms", 1e3 * *c.readout);
    if (c.readout_sigma) fmt::print(", sigma {:.2f} ms", 1e3 * *c.readout_sigma);
    fmt::print("\n");
  }
  if (c.rms) fmt::print("RMS reprojection error {:.4f} px\n", *c.rms);
  print_accuracy(c);
}

// A file without a verdict, as of other tools, has none here either.
inline void print_verdict(const calvin::Calibration& c) {
  constexpr double kWeak = 1;  // px, 2 sigma
  const double accuracy = 2 * c.expected_error.value_or(0);
  if (has_misfit(c)) {
    fmt::print("verdict: not good, misfit {}\n", c.misfit);
  } else if (!c.misfit.empty() && accuracy > kWeak) {
    fmt::print(
        "verdict: weak, though nothing is wrong with it: {:.2g} px where corners were seen. More "
        "views from nearby, tilted to all sides, make it better.\n",
        accuracy);
  } else if (!c.misfit.empty()) {
    fmt::print("verdict: good where corners were seen\n");
  }
}

}  // namespace calvin_tools
