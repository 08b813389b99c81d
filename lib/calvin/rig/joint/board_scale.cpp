// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the cameras of known distances, and puts what came of these into words.

#include "calvin/rig/joint/board_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin::rig {

namespace {

constexpr double kMillimetre = 1e-3;

std::optional<std::size_t> find(const std::vector<std::string>& names, const std::string& name) {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) return std::nullopt;
  return static_cast<std::size_t>(at - names.begin());
}

bool has_names(const CameraBaseline& baseline) {
  return !baseline.a.empty() || !baseline.b.empty();
}

Result<KnownDistance> known_distance(const CameraBaseline& baseline,
                                     const std::vector<std::string>& names) {
  const auto invalid = [](std::string message) {
    return make_error(ErrorCode::kInvalidArgument, std::move(message));
  };
  if (!(baseline.distance > 0 && baseline.distance < 1e6) ||
      !(baseline.sigma >= 0 && baseline.sigma < 1e6)) {
    return invalid("A known distance between two cameras is a length, and its sigma is one or 0.");
  }
  KnownDistance known = {0, 1, baseline.distance, baseline.sigma};
  if (!has_names(baseline)) {
    if (names.size() == 2) return known;
    return invalid(
        fmt::format("A known distance without names is that of two cameras, and the rig "
                    "has {}: name two of them, as '{}:{}:110mm'.",
                    names.size(), names.front(), names.back()));
  }
  const auto a = find(names, baseline.a);
  const auto b = find(names, baseline.b);
  if (!a || !b || a == b) {
    return invalid(fmt::format("There is no distance between '{}' and '{}': the cameras are '{}'.",
                               shortened(baseline.a, 64), shortened(baseline.b, 64),
                               join(names, "', '")));
  }
  known.a = *a;
  known.b = *b;
  return known;
}

}  // namespace

Result<std::vector<KnownDistance>> known_distances(const std::vector<CameraBaseline>& baselines,
                                                   const std::vector<std::string>& names) {
  std::vector<KnownDistance> all;
  for (const CameraBaseline& baseline : baselines) {
    const auto one = known_distance(baseline, names);
    if (!one) return tl::unexpected(one.error());
    all.push_back(*one);
  }
  return all;
}

std::vector<std::string> drop_unknown(std::vector<CameraBaseline>& baselines,
                                      const std::vector<std::string>& names) {
  std::vector<std::string> remarks;
  std::erase_if(baselines, [&](const CameraBaseline& one) {
    if (find(names, one.a) && find(names, one.b)) return false;
    remarks.push_back(
        fmt::format("The known distance {}does not count: a camera is not in the rig.",
                    has_names(one) ? fmt::format("between '{}' and '{}' ", one.a, one.b) : ""));
    return true;
  });
  return remarks;
}

std::vector<std::string> scale_remarks(const ScaledCameras& scaled,
                                       const std::vector<KnownDistance>& distances,
                                       const std::vector<std::string>& names, double cell) {
  constexpr double kDiffers = 3;      // sigmas
  constexpr double kContradicts = 4;  // sigmas
  std::vector<std::string> remarks;
  if (std::abs(scaled.scale - 1) > kDiffers * scaled.sigma) {
    remarks.push_back(fmt::format(
        "By the known distance between cameras boards are {:.2f} % {} than their text says (+-{} "
        "%): what is to be {:.4g} mm on them measures {:.4g} mm. The rig is as large as that says.",
        100 * std::abs(scaled.scale - 1), scaled.scale > 1 ? "larger" : "smaller",
        two_digits(100 * scaled.sigma), cell / kMillimetre, cell * scaled.scale / kMillimetre));
  }
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (std::abs(scaled.misses[i]) <= kContradicts) continue;
    remarks.push_back(fmt::format(
        "The known distance between '{}' and '{}', {:.5g} mm, is {:.1f} sigmas from what boards "
        "say: measure it, and the board, again.",
        names[distances[i].a], names[distances[i].b], distances[i].distance / kMillimetre,
        std::abs(scaled.misses[i])));
  }
  return remarks;
}

}  // namespace calvin::rig
