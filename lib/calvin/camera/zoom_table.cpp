// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts calibrations in the order of a zoom table, and refuses what is not of one camera.

#include "calvin/camera/zoom_table.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"

namespace calvin {

namespace {

// Of the units of its control no lens has more, and its cubics need differences.
constexpr double kLargestPosition = 1e9;

// "the setting at zoom 120, focus 30"
std::string name_of(const Calibration& calibration) {
  std::string name = fmt::format("the setting at zoom {}", format_double(*calibration.zoom));
  if (calibration.focus) name += fmt::format(", focus {}", format_double(*calibration.focus));
  return name;
}

tl::unexpected<Error> refuse(std::string message) {
  return make_error(ErrorCode::kInvalidArgument, std::move(message));
}

Status check_position(const Calibration& calibration, std::size_t number) {
  const auto is_far = [](double x) { return !(std::abs(x) <= kLargestPosition); };
  if (!calibration.zoom) {
    return refuse(fmt::format(
        "Calibration {} of the zoom table does not say where the zoom of the lens stood: give it "
        "as ZOOM=FILE, or calibrate with calibsolve device=NODE, which reads it from the camera.",
        number));
  }
  if (is_far(*calibration.zoom) || is_far(calibration.focus.value_or(0))) {
    return refuse(fmt::format(
        "Calibration {} of the zoom table has a zoom or focus beyond 1e9; give it in the units of "
        "the camera's control.",
        number));
  }
  return {};
}

// What settings of one camera have in common with the first one.
Status check_kind(const Calibration& first, const Calibration& other) {
  const auto both = [&](std::string_view what, const std::string& a, const std::string& b,
                        std::string_view advice) {
    return refuse(fmt::format("A zoom table is of one {0}: {1} has {2}, {3} has {4}. {5}", what,
                              name_of(first), shortened(a, 64), name_of(other), shortened(b, 64),
                              advice));
  };
  if (first.model != other.model) {
    return both("camera model", first.model, other.model,
                "Between two models nothing can be interpolated: calibrate all settings with one, "
                "such as calibsolve model=brown5 or calvin-solve --model brown5.");
  }
  const auto text = [](ImageSize size) { return fmt::format("{}x{} px", size.width, size.height); };
  if (first.image_size != other.image_size) {
    return both("size of images", text(first.image_size), text(other.image_size),
                "Calibrate all settings in one mode of the camera; calibundistort scales the table "
                "to the frames that it gets.");
  }
  const auto crop = [](const Calibration& c) {
    const Rectangle r = c.sensor_crop.value_or(Rectangle{});
    return std::tuple(r.x, r.y, r.width, r.height);
  };
  if (crop(first) != crop(other)) {
    return both("sensor_crop", first.sensor_crop ? "one" : "none",
                other.sensor_crop ? "another one" : "none", "Give all of them the same.");
  }
  if (!first.camera.empty() && !other.camera.empty() && first.camera != other.camera) {
    return both("camera", "'" + first.camera + "'", "'" + other.camera + "'",
                "Where both are of one camera all the same, say its name with --camera.");
  }
  return {};
}

Status check_devices(const Calibration& first, const Calibration& other) {
  if (!first.device || !other.device) return {};
  const std::string& a = first.device->name;
  const std::string& b = other.device->name;
  if (a.empty() || b.empty() || a == b) return {};
  return refuse(fmt::format(
      "A zoom table is of one camera: {} is of '{}', {} of '{}'. Make a table for each of them.",
      name_of(first), shortened(a, 64), name_of(other), shortened(b, 64)));
}

std::pair<double, double> position(const Calibration& calibration) {
  return {*calibration.zoom, calibration.focus.value_or(0)};
}

// Whether two numbers are one position of a control that goes over `span`.
bool same(double a, double b, double span) {
  constexpr double kSame = 1e-9;  // of the span
  return std::abs(a - b) <= kSame * span;
}

// Of calibrations in order. Zooms that are the same but for rounding become one.
Status check_distances(std::vector<Calibration>& sorted) {
  const double zooms = *sorted.back().zoom - *sorted.front().zoom;
  const auto [least, most] =
      std::ranges::minmax(sorted, {}, [](const Calibration& c) { return c.focus.value_or(0); });
  const double focuses = most.focus.value_or(0) - least.focus.value_or(0);
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const Calibration& before = sorted[i - 1];
    if (!same(*before.zoom, *sorted[i].zoom, zooms)) continue;
    sorted[i].zoom = before.zoom;
    if (!same(before.focus.value_or(0), sorted[i].focus.value_or(0), focuses)) continue;
    return refuse(fmt::format(
        "The zoom table has {} twice. Keep the calibration that is known better; where the focus "
        "differs, give it too (ZOOM,FOCUS=FILE).",
        name_of(sorted[i])));
  }
  return {};
}

Status check(std::vector<Calibration>& calibrations) {
  if (calibrations.size() < 2) {
    return refuse(
        "A zoom table needs the calibrations of two settings of the lens or more; of one alone its "
        "file is the calibration.");
  }
  for (std::size_t i = 0; i < calibrations.size(); ++i) {
    if (const Status good = check_position(calibrations[i], i + 1); !good) return good;
    if (const auto camera = Camera::make(calibrations[i]); !camera) {
      return tl::unexpected(camera.error());
    }
  }
  std::ranges::stable_sort(calibrations, {}, position);
  const Calibration& first = calibrations.front();
  for (const Calibration& other : calibrations) {
    if (first.focus.has_value() != other.focus.has_value()) {
      return refuse(fmt::format(
          "Some settings of the zoom table say where the focus stood, and {} does not: give the "
          "focus of all of them (ZOOM,FOCUS=FILE), or take it out of all.",
          name_of(first.focus ? other : first)));
    }
    if (const Status good = check_kind(first, other); !good) return good;
    if (const Status good = check_devices(first, other); !good) return good;
  }
  return check_distances(calibrations);
}

}  // namespace

std::vector<ZoomGroup> groups_of(const ZoomTable& table) {
  std::vector<ZoomGroup> groups;
  for (std::size_t i = 0; i < table.settings.size(); ++i) {
    const auto zoom = table.settings[i].calibration.zoom;
    if (i == 0 || table.settings[i - 1].calibration.zoom != zoom) groups.push_back({i, i});
    groups.back().end = i + 1;
  }
  return groups;
}

bool depends_on_focus(const ZoomTable& table) {
  return std::ranges::any_of(groups_of(table),
                             [](const ZoomGroup& g) { return g.end - g.begin > 1; });
}

Result<ZoomTable> make_zoom_table(std::vector<Calibration> calibrations) {
  if (const Status good = check(calibrations); !good) return tl::unexpected(good.error());
  // Zooms that became one are in the order of their focus.
  std::ranges::stable_sort(calibrations, {}, position);
  ZoomTable table;
  for (Calibration& calibration : calibrations) {
    if (table.camera.empty()) table.camera = calibration.camera;
    table.settings.push_back({std::move(calibration), std::nullopt});
  }
  for (ZoomSetting& setting : table.settings) setting.calibration.camera = table.camera;
  return table;
}

}  // namespace calvin
