// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Takes the text apart from its end, where the lengths are.

#include "calvin/io/camera_baselines.hpp"

#include <optional>
#include <string>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/target/board.hpp"

namespace calvin {

namespace {

std::optional<CameraBaseline> to_baseline(std::string_view text) {
  auto fields = split(text, ':');
  CameraBaseline baseline;
  if (fields.size() > 2) {
    baseline.a = fields[0];
    baseline.b = fields[1];
    if (baseline.a.empty() || baseline.b.empty() || baseline.a == baseline.b) return std::nullopt;
    fields.erase(fields.begin(), fields.begin() + 2);
  }
  if (fields.size() > 2) return std::nullopt;
  const auto distance = parse_length(fields[0]);
  if (!distance || !(*distance > 0)) return std::nullopt;
  baseline.distance = *distance;
  if (fields.size() == 1) return baseline;
  const auto sigma = parse_length(fields[1]);
  if (!sigma || !(*sigma > 0)) return std::nullopt;
  baseline.sigma = *sigma;
  return baseline;
}

}  // namespace

Result<std::vector<CameraBaseline>> parse_camera_baselines(std::string_view text) {
  std::vector<CameraBaseline> all;
  if (trim(text).empty()) return all;
  for (const std::string_view part : split(text, ',')) {
    auto baseline = to_baseline(part);
    if (!baseline) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("'{}' is no known distance between cameras: name two cameras, their distance "
                      "and, if you like, its sigma, as left:right:110.03mm:0.05mm, or of a rig of "
                      "two cameras 110.03mm. Several are separated by commas.",
                      shortened(part, 80)));
    }
    all.push_back(*std::move(baseline));
  }
  return all;
}

}  // namespace calvin
