// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Each camera is held against its own views, without the others: what a wrong lens does to them is
// not what a wrong place does.

#include "calvin/rig/lenses/lens_check.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "calvin/solve/recheck.hpp"

namespace calvin::rig {

namespace {

constexpr double kFrame = 0.033;  // s, of which a readout may take all

std::optional<ReadoutTime> readout_of(const std::vector<View>& views) {
  const bool moves = std::ranges::any_of(
      views, [](const View& view) { return !view.observation.velocity.empty(); });
  return moves ? std::optional(ReadoutTime{0, kFrame}) : std::nullopt;
}

}  // namespace

std::vector<std::string> lens_remarks(const std::vector<RigCameraViews>& seen,
                                      const std::vector<Camera>& cameras) {
  std::vector<std::string> remarks;
  for (std::size_t c = 0; c < seen.size(); ++c) {
    const auto& [calibration, views] = seen[c];
    const auto report = proved_displacement(cameras[c], calibration, views, readout_of(views));
    if (!report) continue;
    remarks.push_back(fmt::format(
        "The views of '{}' contradict its intrinsics by {:.2g} +- {:.1g} px: they are of another "
        "camera, its lens has moved, or the board is bent, and the rig is off by more than its "
        "sigmas say. Calibrate "
        "'{}' again, or let the rig find its intrinsics (estimate-intrinsics=free).",
        calibration.camera, report->displacement, report->displacement_sigma, calibration.camera));
  }
  return remarks;
}

}  // namespace calvin::rig
