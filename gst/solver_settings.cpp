// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The properties of calibsolve, and what they mean once they are read.

#include "solver_settings.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/remap/fit.hpp"

namespace calvin::gst {

SessionOptions SolverPlan::session_options(bool live) const {
  CaptureMode mode = live ? CaptureMode::kAuto : CaptureMode::kAll;
  if (settings.capture_mode == kCaptureAll) mode = CaptureMode::kAll;
  if (settings.capture_mode == kCaptureAuto) mode = CaptureMode::kAuto;
  if (settings.capture_mode == kCaptureManual) mode = CaptureMode::kManual;
  return {mode, settings.min_views, settings.max_views};
}

Result<SolverPlan> make_plan(const SolverSettings& settings) {
  SolverPlan plan;
  plan.settings = settings;
  plan.options.model = settings.model;
  plan.options.warp = settings.warp;
  plan.options.skew = settings.skew;
  for (const std::string_view name : split(settings.fix, ',')) {
    if (!name.empty()) plan.options.fix.emplace_back(name);
  }
  if (!settings.initial.empty()) {
    auto initial = parse_calibration_setting(settings.initial);
    if (!initial) {
      return make_error(initial.error().code,
                        "The calibration to start from (initial): " + initial.error().message);
    }
    plan.initial = *std::move(initial);
  }
  SolveOptions complete = plan.options;
  complete.initial = plan.initial;
  if (const Status usable = check(complete); !usable) {
    return tl::unexpected<Error>(usable.error());
  }
  if (settings.max_views > 0 && settings.max_views < settings.min_views) {
    return make_error(ErrorCode::kInvalidArgument,
                      fmt::format("max-views={} is less than min-views={}: raise max-views, or set "
                                  "it to 0 for no limit.",
                                  settings.max_views, settings.min_views));
  }
  auto files = parse_calibration_files(settings.location, settings.exports);
  if (!files) return tl::unexpected<Error>(files.error());
  plan.files = *std::move(files);
  return plan;
}

bool solves_differently(const SolverSettings& a, const SolverSettings& b) {
  return a.model != b.model || a.fix != b.fix || a.initial != b.initial || a.warp != b.warp ||
         a.skew != b.skew || a.runs != b.runs;
}

bool writes_elsewhere(const SolverSettings& a, const SolverSettings& b) {
  return a.location != b.location || a.exports != b.exports || a.camera != b.camera;
}

FittedInitial fit_initial(const SolverPlan& plan, ImageSize frames) {
  FittedInitial fitted;
  if (!plan.initial || frames.width == 0) return fitted;
  const auto camera = fit_to_frame(*plan.initial, frames);
  if (!camera) {
    fitted.news = {camera.error().code, "The calibration to start from (initial) is not used: " +
                                            camera.error().message};
    return fitted;
  }
  fitted.calibration = camera->camera.to_calibration();
  if (camera->scaled) {
    fitted.news = {ErrorCode::kInvalidArgument,
                   fmt::format("The calibration to start from (initial) is for {}x{} px and is "
                               "scaled to the frames of {}x{}.",
                               plan.initial->image_size.width, plan.initial->image_size.height,
                               frames.width, frames.height)};
  }
  return fitted;
}

}  // namespace calvin::gst
