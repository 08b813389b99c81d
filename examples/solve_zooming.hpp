// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-solve --method sturm-maybank: a focal length for each view.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/zoom_table.hpp"
#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/zoom_io.hpp"
#include "calvin/rig/zoom/solve_zooming.hpp"
#include "calvin/solve/options.hpp"

#include "solve_views.hpp"

namespace solve_zooming {

inline constexpr const char* kMethod = "sturm-maybank";

// What of the options it can do; the others are refused.
inline calvin::Result<calvin::ZoomingOptions> options_of(const calvin::SolveOptions& given,
                                                         bool has_initial) {
  calvin::ZoomingOptions options;
  options.refine = given.refine;
  options.camera = given.camera;
  bool cx = false;
  bool cy = false;
  for (const std::string& fix : given.fix) {
    const std::string_view word = calvin::trim(fix);
    if (word == "center") options.centered = true;
    cx = cx || word == "cx";
    cy = cy || word == "cy";
    if (word == "aspect" || word == "fx=fy" || word == "fy=fx") options.square = true;
    constexpr std::string_view kKnown[] = {"center", "cx", "cy", "aspect", "fx=fy", "fy=fx"};
    if (std::ranges::find(kKnown, word) == std::end(kKnown)) {
      return calvin::make_error(
          calvin::ErrorCode::kInvalidArgument,
          fmt::format(
              "--method sturm-maybank holds center and aspect alone, not '{}': each view has "
              "its own f and k1.",
              word));
    }
  }
  options.centered = options.centered || (cx && cy);
  const bool other_model = given.model != "brown5" && given.model != "brown4";
  if (has_initial || given.skew || given.ellipse_centers || other_model || cx != cy) {
    return calvin::make_error(
        calvin::ErrorCode::kInvalidArgument,
        "--method sturm-maybank has the model brown4 with f and k1 for each view, and takes --fix "
        "center,aspect, --camera, --drop and --no-refine of the options of a solve. For more, "
        "calibrate each zoom by itself from several views, and put the files together with "
        "calvin-zoom.");
  }
  return options;
}

inline calvin::Status write(const std::string& path, std::vector<calvin::Calibration> all) {
  if (all.size() == 1) return calvin::write_calibration(path, all.front());
  auto table = calvin::make_zoom_table(std::move(all));
  if (!table) return tl::unexpected<calvin::Error>(table.error());
  return calvin::write_zoom_table(path, *table);
}

// Solves, writes a zoom table whose positions are the numbers of the views, and prints a line each.
inline calvin::Status run(const std::string& path, const solve_views::NamedViews& named,
                          const calvin::ZoomingOptions& options) {
  std::vector<calvin::View> views;
  for (const auto& view : named) views.push_back(view.view);
  auto solved = calvin::solve_zooming(views, views.front().observation.image_size, options);
  if (!solved) return tl::unexpected<calvin::Error>(solved.error());
  for (std::size_t v = 0; v < solved->size(); ++v) {
    calvin::Calibration& calibration = (*solved)[v];
    calibration.zoom = static_cast<double>(v);
    fmt::print("view {}:", named[v].name);
    for (const calvin::Parameter& p : calibration.parameters) {
      if (p.value == 0 && !p.sigma) continue;
      fmt::print(" {} {:.6g}", p.name, p.value);
      if (p.sigma) fmt::print(" +- {}", calvin::two_digits(*p.sigma));
    }
    if (calibration.rms) fmt::print(", rms {:.4f} px", *calibration.rms);
    fmt::print("\n");
  }
  return write(path, *std::move(solved));
}

}  // namespace solve_zooming
