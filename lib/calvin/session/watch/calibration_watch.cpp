// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the frames of a stream say of a calibration.

#include "calvin/session/watch/calibration_watch.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "calvin/geometry/convex_hull.hpp"

namespace calvin {

namespace {

// That of another size may be of another mode of the sensor.
ReadoutTime readout_of(const Camera& camera, const Calibration& calibration) {
  constexpr double kFrame = 1.0 / 30;  // s; no frame takes longer where one follows the other
  if (!calibration.readout || camera.image_size() != calibration.image_size) return {0, kFrame};
  return {*calibration.readout, calibration.readout_sigma.value_or(0)};
}

// Neighbouring frames see the same boards: what matters little has to be surer.
bool is_change(const RecheckReport& report) {
  constexpr double kMatters = 0.3;  // px
  constexpr double kSure = 4;       // sigma
  return report.displacement > kMatters || report.displacement > kSure * report.displacement_sigma;
}

// Whether a board is so far from where it was that these are stills, each of a board at rest.
bool has_jumped(const CornerMotion& moved, const Observation& seen, double seconds) {
  constexpr double kFastest = 4;  // of the board's size in the image, each second
  const double size = std::sqrt(polygon_area(convex_hull(seen.uv)));
  return moved.shared == 0 || moved.all > kFastest * seconds * size;
}

}  // namespace

CalibrationWatch::CalibrationWatch(const Camera& camera, const Calibration& calibration)
    : readout_(readout_of(camera, calibration)), recheck_(camera, calibration, readout_) {}

double CalibrationWatch::longest_readout() const {
  return std::abs(readout_.value) + readout_.sigma;
}

Result<RecheckReport> CalibrationWatch::add(const View& view, int place) {
  constexpr int kSteady = 4;  // views
  const std::optional<View> known = at_rest_or_moving(view, place);
  auto report = known ? recheck_.add(*known) : without_telling(view);
  if (!report) return report;
  if (known) in_a_row_ = is_change(*report) ? in_a_row_ + 1 : 0;
  if (in_a_row_ < kSteady) {
    report->displacement = 0;
    report->displacement_sigma = report->region_sigma;
  }
  return report;
}

Result<RecheckReport> CalibrationWatch::without_telling(const View& view) const {
  Recheck alone = recheck_;
  const RecheckReport before = alone.add(std::span<const View>());
  auto report = alone.add(view);
  if (!report || !(before.region_sigma > 0)) return report;  // there was no view before
  report->displacement = before.displacement;
  report->displacement_sigma = before.displacement_sigma;
  report->region_sigma = before.region_sigma;
  return report;
}

std::optional<View> CalibrationWatch::at_rest_or_moving(const View& view, int place) {
  constexpr double kAtRest = 0.1;  // px while a frame is read out
  Sighting now = {view.observation, std::nullopt, std::nullopt};
  const auto known = before_.find(place);
  if (known == before_.end()) {
    before_.emplace(place, std::move(now));
    return std::nullopt;
  }
  Sighting before = std::exchange(known->second, {});
  const double between = seconds_between(before.seen, now.seen);
  const CornerMotion moved = corner_motion(before.seen, now.seen);
  const auto velocities = velocities_of(now, before);
  known->second = std::move(now);
  const bool are_stills =
      !(between > 0) || between > kFarApart || has_jumped(moved, view.observation, between);
  // The first of several stills was one, too.
  if (are_stills && !before.before) (void)recheck_.add({std::move(before.seen), view.board});
  if (are_stills || longest_readout() / between * moved.all <= kAtRest) return view;
  if (!velocities ||
      left_of_motion(view.observation, velocities->sigma, longest_readout()) > kAtRest) {
    return std::nullopt;
  }
  return is_significant(*velocities) ? moving(view, *velocities, longest_readout()) : view;
}

}  // namespace calvin
