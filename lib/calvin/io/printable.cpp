// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Goes through the numbers of a calibration and of a rig, field by field.

#include "calvin/io/printable.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/utf8.hpp"
#include "calvin/geometry/covariance.hpp"
#include "calvin/io/native_fields.hpp"
#include "calvin/io/rig_fields.hpp"

namespace calvin::io {

namespace {

constexpr double kLargestNumber = std::numeric_limits<double>::max();

// The first thing that is wrong, as a clause: "its rms is nan".
using Why = std::optional<std::string>;

struct Field {
  std::string_view name;
  std::optional<double> value;
  double least = -kLargestNumber;
  double most = kLargestNumber;
};

Why first_wrong(const std::vector<Field>& fields) {
  for (const Field& field : fields) {
    if (!field.value || (*field.value >= field.least && *field.value <= field.most)) continue;
    return fmt::format("its {} is {}", field.name, *field.value);
  }
  return std::nullopt;
}

template <typename Numbers>
bool all_finite(const Numbers& numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

bool is_finite(const Pixel& p) { return std::isfinite(p.u) && std::isfinite(p.v); }

Why wrong_quality(const Calibration& c) {
  return first_wrong({{"rms", c.rms, 0},
                      {"held_out_rms", c.held_out_rms, 0},
                      {"chi", c.chi, 0},
                      {"expected_error", c.expected_error, 0},
                      {"expected_error_anywhere", c.expected_error_anywhere, 0},
                      {"split_half_ratio", c.split_half_ratio},
                      {"systematic", c.systematic, 0, 1},
                      {"readout", c.readout},
                      {"readout_sigma", c.readout_sigma, 0},
                      {"focus", c.focus},
                      {"zoom", c.zoom}});
}

Why wrong_estimates(const Calibration& c) {
  std::size_t size = 0;
  for (const Parameter& p : c.parameters) {
    if (!p.sigma) continue;
    ++size;
    if (auto why = first_wrong({{"sigma of " + p.name, p.sigma, 0}})) return why;
  }
  if (!all_finite(c.covariance)) return "its covariance has a number that is not finite";
  // One of another size is that of nothing, and not printed.
  if (c.covariance.size() != size * size) return std::nullopt;
  const auto why = no_covariance(c.covariance, size);
  return why ? Why("its covariance " + *why) : std::nullopt;
}

Why wrong_places(const Calibration& c) {
  if (c.worst_place && !is_finite(*c.worst_place)) return "its worst_place is not finite";
  if (!std::ranges::all_of(c.covered, is_finite)) return "a point of covered is not finite";
  for (const ViewRecord& view : c.views) {
    const Pose& pose = view.camera_from_board;
    if (std::isfinite(view.rms) && all_finite(pose.rotation) && all_finite(pose.translation)) {
      continue;
    }
    return "one of its views has a number that is not finite";
  }
  if (!c.warp) return std::nullopt;
  return first_wrong({{"warp kx", c.warp->kx},
                      {"warp ky", c.warp->ky},
                      {"warp kx_sigma", c.warp->kx_sigma},
                      {"warp ky_sigma", c.warp->ky_sigma}});
}

Why wrong_crop(const Calibration& c) {
  if (!c.sensor_crop) return std::nullopt;
  const Rectangle& r = *c.sensor_crop;
  const bool is_within = r.x >= 0 && r.y >= 0 && r.width > 0 && r.height > 0 &&
                         r.x + r.width <= c.image_size.width &&
                         r.y + r.height <= c.image_size.height;
  if (is_within) return std::nullopt;
  return fmt::format("its sensor_crop {},{} {}x{} is no part of the image", r.x, r.y, r.width,
                     r.height);
}

Why wrong(const Calibration& c) {
  for (const auto look : {wrong_quality, wrong_estimates, wrong_places, wrong_crop}) {
    if (auto why = look(c)) return why;
  }
  return std::nullopt;
}

Why wrong_place(const Pose& pose, const std::vector<double>& covariance) {
  constexpr std::size_t kUnknowns = 6;
  if (!is_possible(pose)) return "its place is out of range (1e6 m, 1e6 rad)";
  if (covariance.empty()) return std::nullopt;
  if (covariance.size() != kUnknowns * kUnknowns) return "the covariance of its place is not 6 x 6";
  if (!is_possible(covariance)) return "the covariance of its place is out of range (1e12)";
  const auto why = no_covariance(covariance, kUnknowns);
  return why ? Why("the covariance of its place " + *why) : std::nullopt;
}

Why wrong(const RigCamera& camera) {
  if (auto why = wrong(camera.calibration)) return why;
  if (auto why = wrong_place(camera.rig_from_camera, camera.covariance)) return why;
  if (auto why = first_wrong({{"rms", camera.rms}})) return why;
  if (!camera.time_offset) return std::nullopt;
  return first_wrong(
      {{"time_offset", camera.time_offset->seconds, -kMostTimeOffset, kMostTimeOffset},
       {"sigma of time_offset", camera.time_offset->sigma, 0, kMostTimeOffset}});
}

Status refuse(std::string_view what, std::string_view why) {
  return make_error(ErrorCode::kInvalidArgument,
                    fmt::format("{} cannot be written: {}, and no program could read it. Mend it, "
                                "or leave it out.",
                                what, why));
}

Status check_boards(const Rig& rig) {
  for (const RigBoard& board : rig.boards) {
    if (const auto why = wrong_place(board.rig_from_board, {})) {
      return refuse(fmt::format("The board {} of the rig", shortened(board.board, 64)), *why);
    }
  }
  for (const FixedBoard& board : rig.fixed_boards) {
    if (const auto why = wrong_place(board.on_from_board, board.covariance)) {
      return refuse(fmt::format("The board {} of the rig", shortened(board.board, 64)), *why);
    }
  }
  return {};
}

}  // namespace

Status check_printable(const Calibration& calibration) {
  const auto why = wrong(calibration);
  return why ? refuse("The calibration", *why) : Status();
}

Status check_printable(const Rig& rig) {
  if (rig.cameras.empty()) return refuse("The rig", "it has no cameras");
  if (const std::string* name = repeated_name(rig.cameras)) {
    return refuse("The rig", fmt::format("two cameras are called '{}'", shortened(*name, 64)));
  }
  for (const RigCamera& camera : rig.cameras) {
    if (const auto why = wrong(camera)) {
      return refuse(
          fmt::format("The camera '{}' of the rig", shortened(camera.calibration.camera, 64)),
          *why);
    }
  }
  if (const auto why = first_wrong({{"rms", rig.rms}})) return refuse("The rig", *why);
  return check_boards(rig);
}

}  // namespace calvin::io
