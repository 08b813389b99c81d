// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Puts views between the two ends of alpha.

#include "calvin/remap/view_range.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calvin/remap/opencv_rectangles.hpp"

namespace calvin {

namespace {

double part_of(double alpha) { return std::isfinite(alpha) ? std::clamp(alpha, 0.0, 1.0) : 0.0; }

Error no_view(const char* what) {
  return {ErrorCode::kDegenerate, fmt::format("The calibration is valid for {}; calibrate the "
                                              "camera again.",
                                              what)};
}

// The plane of a view enlarged by `zoom` around the middle of the picture; a zoom below 1 ends
// where the view is `widest_half` on either side.
Result<Camera> zoomed(const Camera& plane, double zoom, double widest_half, bool& limited) {
  const ImageSize size = plane.image_size();
  const double least =
      std::max((size.width - 1) / 2.0 / plane.fx(), (size.height - 1) / 2.0 / plane.fy()) /
      widest_half;
  limited = zoom < least * (1 - 1e-9);
  const double factor = std::max(zoom, least);
  const double u = (size.width - 1) / 2.0;
  const double v = (size.height - 1) / 2.0;
  return Camera::make("pinhole", size,
                      {factor * plane.fx(), factor * plane.fy(), u + factor * (plane.cx() - u),
                       v + factor * (plane.cy() - v)});
}

// A pinhole that takes low..high of its plane, or of one axis of it, to 0..length-1.
struct Axis {
  double focal;
  double centre;
};
Axis filled(double low, double high, int length) {
  const double focal = std::max(length - 1, 1) / (high - low);
  return {focal, (length - 1) / 2.0 - focal * (low + high) / 2};
}

ImageSize size_of(const ViewOptions& options, const Camera& source) {
  const bool given = options.output.width > 0 && options.output.height > 0;
  return given ? options.output : source.image_size();
}

}  // namespace

Result<ViewRange> ViewRange::find(const Camera& source, const ViewOptions& options) {
  if (options.alpha_mode == AlphaMode::kCalvin) {
    const Sight own = {source};
    return find(std::span(&own, 1), options);
  }
  ViewRange range(options, size_of(options, source));
  range.as_opencv_ = true;
  const auto found = opencv_rectangles(source, options.projection, opencv_grid());
  range.frames_ = {found.inner, found.outer};
  range.camera_from_axes_.emplace_back(Eigen::Matrix3d::Identity());
  return range;
}

Result<ViewRange> ViewRange::find(std::span<const Sight> sights, const ViewOptions& options) {
  if (sights.size() > 1 && options.projection != Projection::kRectilinear) {
    return make_error(ErrorCode::kInvalidArgument,
                      "Rows of two cameras correspond in rectilinear pictures alone: rectification "
                      "wants projection=rectilinear.");
  }
  ViewRange range(options, size_of(options, sights.front().camera));
  const auto frames = find_view_frames(sights, options.projection, range.size_);
  if (!frames) return tl::unexpected(frames.error());
  range.frames_ = *frames;
  for (const Sight& sight : sights) range.camera_from_axes_.push_back(sight.camera_from_view);
  return range;
}

// The borders of the view move linearly; for OpenCV the focal lengths and the centre do.
Result<Camera> ViewRange::plane(double alpha) const {
  const auto axis = [&](double inner_low, double inner_high, double outer_low, double outer_high,
                        int length) {
    if (!as_opencv_) {
      return filled(std::lerp(inner_low, outer_low, alpha),
                    std::lerp(inner_high, outer_high, alpha), length);
    }
    const Axis small = filled(inner_low, inner_high, length);
    const Axis large = filled(outer_low, outer_high, length);
    return Axis{std::lerp(small.focal, large.focal, alpha),
                std::lerp(small.centre, large.centre, alpha)};
  };
  const PlaneBox& inner = frames_.inner;
  const PlaneBox& outer = frames_.outer;
  const Axis x = axis(inner.low.u, inner.high.u, outer.low.u, outer.high.u, size_.width);
  const Axis y = axis(inner.low.v, inner.high.v, outer.low.v, outer.high.v, size_.height);
  if (!(x.focal > 0 && y.focal > 0 && std::isfinite(x.focal + y.focal + x.centre + y.centre))) {
    return tl::unexpected(no_view("too small a part of its image to make a picture of"));
  }
  return Camera::make("pinhole", size_, {x.focal, y.focal, x.centre, y.centre});
}

Result<OutputView> ViewRange::view(const ViewOptions& options, std::size_t sight) const {
  const double alpha = part_of(options.alpha);
  const double zoom = options.zoom > 0 && std::isfinite(options.zoom) ? options.zoom : 1;
  auto shown = plane(alpha);
  bool limited = false;
  if (shown && zoom != 1) shown = zoomed(*shown, zoom, widest(asked_.projection), limited);
  if (!shown) return tl::unexpected(shown.error());
  limited = limited || (frames_.cut && alpha == 1 && zoom <= 1);
  return OutputView{VirtualCamera(asked_.projection, *std::move(shown),
                                  camera_from_axes_[sight] * camera_from_view(options)),
                    limited};
}

}  // namespace calvin
