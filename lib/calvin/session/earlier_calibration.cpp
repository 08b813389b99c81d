// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Holds the first views of a session against the calibration that is there already.

#include "calvin/session/earlier_calibration.hpp"

#include <utility>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestViews = 5;
constexpr std::size_t kEnoughViews = 12;  // whatever they tell
constexpr double kWellKnown = 0.5;        // px, that nothing has moved by more
constexpr double kMoved = 4;              // sigma

// px: two sigma more than what may be seen.
double most_moved(const RecheckReport& report) {
  return report.displacement + 2 * report.displacement_sigma;
}

bool is_known(const EarlierVerdict& verdict, std::size_t views) {
  return !verdict.holds || views >= kEnoughViews || most_moved(verdict.report) <= kWellKnown;
}

std::string words_for(const EarlierVerdict& verdict, const std::string& name) {
  const RecheckReport& report = verdict.report;
  if (verdict.holds) {
    return fmt::format(
        "{} still holds: where the board was seen nothing has moved by more than {:.2g} px. There "
        "is nothing to do; to make a better one, go on.",
        name, most_moved(report));
  }
  return fmt::format(
      "{} does not hold any more: the picture is off by {:.2g} +- {:.1g} px where the board was "
      "seen. Go on, and a new one takes its place.",
      name, report.displacement, report.displacement_sigma);
}

}  // namespace

std::shared_ptr<const EarlierCalibration> find_earlier(const SessionSettings& settings,
                                                       const std::optional<Calibration>& initial) {
  if (!settings.location.empty() && !is_stream(settings.location)) {
    if (auto held = read_calibration(settings.location)) {
      return std::make_shared<const EarlierCalibration>(EarlierCalibration{
          *std::move(held), fmt::format("The calibration in '{}'", settings.location)});
    }
  }
  if (!initial) return nullptr;
  return std::make_shared<const EarlierCalibration>(
      EarlierCalibration{*initial, "The calibration to start from (initial)"});
}

std::optional<EarlierVerdict> judge_earlier(const SolveJob& job) {
  if (!job.earlier || job.views.size() < kFewestViews) return std::nullopt;
  const auto& [calibration, name] = *job.earlier;
  const std::string& camera = job.options.camera;
  if (!camera.empty() && !calibration.camera.empty() && camera != calibration.camera) {
    return std::nullopt;
  }
  const auto fitted = fit_to_frame(calibration, job.size);
  // A size that was not calibrated may show another part of the sensor.
  if (!fitted || fitted->scaled) return std::nullopt;
  Recheck recheck(fitted->camera, calibration);
  EarlierVerdict verdict;
  for (const auto& view : job.views) {
    // One that moves is not where it is seen.
    if (!view->observation.velocity.empty()) continue;
    if (const auto report = recheck.add(*view)) verdict.report = *report;
  }
  if (!(verdict.report.displacement_sigma > 0)) return std::nullopt;
  verdict.holds = verdict.report.displacement <= kMoved * verdict.report.displacement_sigma;
  if (!is_known(verdict, job.views.size())) return std::nullopt;
  verdict.words = words_for(verdict, name);
  return verdict;
}

}  // namespace calvin
