// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the calibration of a position between the settings of a zoom table, or says what is not
// known of the position.

#include "calvin/camera/zoom_interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/setting_mixture.hpp"
#include "calvin/camera/setting_weights.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

Result<Calibration> mixture(ZoomCurve curve, const ZoomTable& table, const LensPosition& position) {
  const Calibration& first = table.settings.front().calibration;
  const ZoomLaw law = zoom_law(table);
  Calibration calibration = mix_settings(table, law, setting_weights(table, law, curve, position));
  calibration.camera = table.camera;
  calibration.model = first.model;
  calibration.image_size = first.image_size;
  calibration.sensor_crop = first.sensor_crop;
  calibration.device = first.device;
  calibration.zoom = position.zoom;
  if (first.focus) calibration.focus = position.focus;
  if (const auto camera = Camera::make(calibration); !camera) {
    return tl::unexpected(camera.error());
  }
  return calibration;
}

struct Ends {
  double least = 0;
  double most = 0;
};

Ends ends_of(const ZoomTable& table, std::optional<double> Calibration::*control) {
  Ends ends = {*(table.settings.front().calibration.*control),
               *(table.settings.front().calibration.*control)};
  for (const ZoomSetting& setting : table.settings) {
    ends.least = std::min(ends.least, *(setting.calibration.*control));
    ends.most = std::max(ends.most, *(setting.calibration.*control));
  }
  return ends;
}

// How far the focus goes on both sides of a zoom: where the settings of one of them end, the table
// does.
Ends focus_ends(const ZoomTable& table, double zoom) {
  const auto groups = groups_of(table);
  const auto zoom_of = [&](const ZoomGroup& g) {
    return *table.settings[g.begin].calibration.zoom;
  };
  Ends ends = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const bool before = g + 1 < groups.size() && zoom_of(groups[g + 1]) <= zoom;
    const bool behind = g > 0 && zoom_of(groups[g - 1]) >= zoom;
    if (before || behind) continue;
    ends.least = std::max(ends.least, *table.settings[groups[g].begin].calibration.focus);
    ends.most = std::min(ends.most, *table.settings[groups[g].end - 1].calibration.focus);
  }
  return ends;
}

// Keeps one control within the table; a sentence where it was not.
std::string keep_within(const Ends& ends, std::string_view name, std::optional<double>& at) {
  // Where the settings of two zooms have no focus in common they end between them.
  const double asked = *at;
  at = std::min(std::max(asked, ends.least), ends.most);
  if (asked == *at) return "";
  return fmt::format(
      "The {0} of the lens stands at {1}, and the zoom table knows {2} to {3} alone: the "
      "calibration of {4} is used. Calibrate at {1} too, and make the table anew with calvin-zoom.",
      name, format_double(asked), format_double(ends.least), format_double(ends.most),
      format_double(*at));
}

tl::unexpected<Error> not_known(const ZoomTable& table, std::optional<double> Calibration::*control,
                                std::string_view name) {
  const Ends ends = ends_of(table, control);
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format(
          "The calibration is a table of {} settings of a zoom lens ({} {} to {}), and it is "
          "not known where the {} stands.",
          table.settings.size(), name, format_double(ends.least), format_double(ends.most), name));
}

bool is_known(const std::optional<double>& at) { return at && std::isfinite(*at); }

}  // namespace

Result<InterpolatedCalibration> interpolate(const ZoomTable& table, const LensPosition& position) {
  LensPosition at = position;
  if (!is_known(at.zoom)) return not_known(table, &Calibration::zoom, "zoom");
  std::vector<std::string> remarks = {
      keep_within(ends_of(table, &Calibration::zoom), "zoom", at.zoom)};
  const bool has_focus = table.settings.front().calibration.focus.has_value();
  if (!has_focus || !is_known(at.focus)) at.focus.reset();
  if (!at.focus && depends_on_focus(table)) return not_known(table, &Calibration::focus, "focus");
  auto calibration = mixture(ZoomCurve::kSmooth, table, at);
  // A smooth curve may leave what a model allows where its settings are at the edge of that.
  if (!calibration) calibration = mixture(ZoomCurve::kStraight, table, at);
  if (!calibration) return tl::unexpected(calibration.error());
  if (at.focus) {
    const Ends ends =
        depends_on_focus(table) ? focus_ends(table, *at.zoom) : ends_of(table, &Calibration::focus);
    remarks.push_back(keep_within(ends, "focus", calibration->focus));
  }
  std::erase(remarks, "");
  return InterpolatedCalibration{*std::move(calibration), join(remarks, " ")};
}

}  // namespace calvin
