// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Holds the first views of a session against the calibration that is there already.

#include "calvin/session/earlier_calibration.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/core/file.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/io/calibration_io.hpp"

namespace calvin {

namespace {

constexpr std::size_t kFewestViews = 5;
constexpr double kMoved = 4;   // sigma
constexpr double kSeen = 0.2;  // of the picture, where boards were
// That nothing has moved is told where it has by no more than kAsExact times the expected error of
// the calibration, which is kUsual where that does not tell; within these limits, px.
constexpr double kAsExact = 4;
constexpr double kUsual = 0.25;
constexpr double kLeastBound = 0.5;
constexpr double kMostBound = 2;

// px: two sigma more than what may be seen.
double most_moved(const RecheckReport& report) {
  return report.displacement + 2 * report.displacement_sigma;
}

// The share of the picture that corners of the views surround.
double share_seen(const Session::Views& views, ImageSize size) {
  std::vector<Pixel> corners;
  for (const auto& view : views) {
    const std::vector<Pixel>& seen = view->observation.uv;
    corners.insert(corners.end(), seen.begin(), seen.end());
  }
  return polygon_area(convex_hull(std::move(corners))) / (1.0 * size.width * size.height);
}

// What holds in a corner of the picture may be off in the rest of it, and that it holds is worth
// being told where it holds about as exactly as it is known.
bool is_known(const EarlierVerdict& verdict, const Calibration& calibration, double seen) {
  if (!verdict.holds) return true;
  const double exact = kAsExact * calibration.expected_error.value_or(kUsual);
  return seen >= kSeen && most_moved(verdict.report) <= std::clamp(exact, kLeastBound, kMostBound);
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
  const std::optional<ReadoutTime>& readout = job.options.readout;
  Recheck recheck(fitted->camera, calibration, readout);
  EarlierVerdict verdict;
  for (const auto& view : job.views) {
    // One that moves is not where it is seen, by what nobody knows of the readout.
    if (!readout && !view->observation.velocity.empty()) continue;
    if (const auto report = recheck.add(*view)) verdict.report = *report;
  }
  if (!(verdict.report.displacement_sigma > 0)) return std::nullopt;
  verdict.holds = verdict.report.displacement <= kMoved * verdict.report.displacement_sigma;
  if (!is_known(verdict, calibration, share_seen(job.views, job.size))) return std::nullopt;
  verdict.words = words_for(verdict, name);
  return verdict;
}

bool contradict(const WriteJob& job, const Calibration& before) {
  const auto camera = Camera::make(before);
  if (!camera) return true;
  std::vector<View> views;
  for (const auto& view : job.views) views.push_back(*view);
  return proved_displacement(*camera, before, views, job.readout).has_value();
}

}  // namespace calvin
