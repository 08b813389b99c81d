// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A calibration in words and numbers, as the tools print it.
#pragma once

#include <string>

#include <fmt/format.h>

#include "calvin/core/calibration.hpp"

namespace calvin_tools {

inline std::string number(double value) { return fmt::format("{:.6g}", value); }

inline void print_row(const calvin::Parameter& p, const calvin::Calibration* truth) {
  fmt::print("{:<6} {:>12} {:>12}", p.name, number(p.value), p.sigma ? number(*p.sigma) : "");
  if (const auto* t = truth != nullptr ? truth->find(p.name) : nullptr) {
    fmt::print(" {:>12}", number(t->value));
    if (p.sigma && *p.sigma > 0) fmt::print(" {:>8.2f}", (p.value - t->value) / *p.sigma);
  }
  fmt::print("\n");
}

inline void print_verdict(const calvin::Calibration& c) {
  if (c.expected_error) {
    fmt::print("accurate to {:.4f} px where corners were seen (2 sigma)\n", 2 * *c.expected_error);
  }
  if (c.expected_error_anywhere) {
    fmt::print("accurate to {:.4f} px anywhere in the picture", 2 * *c.expected_error_anywhere);
    if (c.worst_place) fmt::print(", worst at {:.0f}, {:.0f}", c.worst_place->u, c.worst_place->v);
    fmt::print("\n");
  }
  if (c.split_half_ratio) {
    const bool held = *c.split_half_ratio > 1 && c.systematic.value_or(0) > 0;
    fmt::print("halves of the views differ by {:.2f} times what the noise of corners explains{}\n",
               *c.split_half_ratio, held ? "; sigmas and accuracy hold the rest too" : "");
  }
  if (!c.misfit.empty() && c.misfit != "none") fmt::print("misfit: {}\n", c.misfit);
  for (const std::string& remark : c.remarks) fmt::print("{}\n", remark);
}

// `truth` beside it, where it is known.
inline void print(const calvin::Calibration& c, const calvin::Calibration* truth = nullptr) {
  fmt::print("{} {}x{}, model {}", c.camera.empty() ? "camera" : c.camera, c.image_size.width,
             c.image_size.height, c.model);
  if (!c.views.empty()) fmt::print(", {} views", c.views.size());
  if (!c.board.empty()) fmt::print(" of {}", c.board);
  fmt::print("\n{:<6} {:>12} {:>12}", "", "value", "sigma");
  if (truth != nullptr) fmt::print(" {:>12} {:>8}", "truth", "sigmas");
  fmt::print("\n");
  for (const calvin::Parameter& p : c.parameters) print_row(p, truth);
  if (c.readout) {
    fmt::print("readout {:.2f} ms", 1e3 * *c.readout);
    if (c.readout_sigma) fmt::print(", sigma {:.2f} ms", 1e3 * *c.readout_sigma);
    fmt::print("\n");
  }
  if (c.rms) fmt::print("RMS reprojection error {:.4f} px\n", *c.rms);
  print_verdict(c);
}

}  // namespace calvin_tools
