// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "calvin/remap/map.hpp"

namespace calvin {

namespace {

constexpr double kWidestTangent = 3.7320508075688772;  // tan(75 degrees)
constexpr int kSamplesPerSide = 256;

// A view on the plane z = 1, of the aspect of the output: the centres of its border pixels lie at
// x +- size * extent_x and y +- size * extent_y.
struct View {
  double x = 0;
  double y = 0;
  double size = 0;
};

struct Extent {
  double x;
  double y;
};

// The ideal point of a source pixel, absent where the view cannot show it.
std::optional<Pixel> ideal_point(const Camera& source, Pixel pixel) {
  const auto ray = source.unproject(pixel);
  if (!ray || !(ray->z() * kWidestTangent >= std::hypot(ray->x(), ray->y()))) return std::nullopt;
  return Pixel{ray->x() / ray->z(), ray->y() / ray->z()};
}

Pixel between(Pixel a, Pixel b, double t) { return {a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)}; }

// A valid source pixel to look around from: near the principal point, or else wherever there is
// one.
std::optional<Pixel> find_centre(const Camera& source) {
  const Pixel last = {source.image_size().width - 1.0, source.image_size().height - 1.0};
  const Pixel axis = {std::clamp(source.cx(), 0.0, last.u), std::clamp(source.cy(), 0.0, last.v)};
  const Pixel middle = {last.u / 2, last.v / 2};
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const Pixel pixel = between(axis, middle, static_cast<double>(i) / kSteps);
    if (ideal_point(source, pixel)) return pixel;
  }
  for (int i = 0; i <= kSteps * kSteps; ++i) {
    const Pixel pixel = {last.u * (i % kSteps + 0.5) / kSteps,
                         last.v * (i / kSteps + 0.5) / kSteps};
    if (ideal_point(source, pixel)) return pixel;
  }
  return std::nullopt;
}

// The ideal point furthest from `centre` on the way to `edge` that is still valid.
Pixel last_valid(const Camera& source, Pixel centre, Pixel edge) {
  if (const auto point = ideal_point(source, edge)) return *point;
  Pixel found = *ideal_point(source, centre);
  double low = 0;
  double high = 1;
  for (int i = 0; i < 40; ++i) {
    const double t = (low + high) / 2;
    const auto point = ideal_point(source, between(centre, edge, t));
    (point ? low : high) = t;
    if (point) found = *point;
  }
  return found;
}

// The border of the region that the source sees, on the plane z = 1; empty where there is none.
std::vector<Pixel> seen_border(const Camera& source) {
  std::vector<Pixel> border;
  const auto centre = find_centre(source);
  if (!centre) return border;
  const double right = source.image_size().width - 1.0;
  const double bottom = source.image_size().height - 1.0;
  const Pixel corners[] = {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kSamplesPerSide; ++i) {
      const Pixel edge =
          between(corners[side], corners[(side + 1) % 4], static_cast<double>(i) / kSamplesPerSide);
      border.push_back(last_valid(source, *centre, edge));
    }
  }
  return border;
}

struct Box {
  Pixel low;
  Pixel high;
};

Box bounds(const std::vector<Pixel>& points) {
  Box box = {points.front(), points.front()};
  for (const Pixel& p : points) {
    box.low = {std::min(box.low.u, p.u), std::min(box.low.v, p.v)};
    box.high = {std::max(box.high.u, p.u), std::max(box.high.v, p.v)};
  }
  return box;
}

// The smallest view that shows the whole border, or as much of it as the widest view does.
View outer_view(const Box& box, Extent extent) {
  const double needed =
      std::max((box.high.u - box.low.u) / extent.x, (box.high.v - box.low.v) / extent.y) / 2;
  return {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2,
          std::min(needed, kWidestTangent / std::max(extent.x, extent.y))};
}

// The largest size of a view at (x, y) that no border point lies in.
double free_size(const std::vector<Pixel>& border, Extent extent, double x, double y) {
  double size = std::numeric_limits<double>::infinity();
  for (const Pixel& p : border) {
    size = std::min(size, std::max(std::abs(p.u - x) / extent.x, std::abs(p.v - y) / extent.y));
  }
  return size;
}

// Even-odd rule over the border as a polygon.
bool encloses(const std::vector<Pixel>& border, double x, double y) {
  bool inside = false;
  Pixel a = border.back();
  for (const Pixel& b : border) {
    if ((a.v > y) != (b.v > y) && x < a.u + (y - a.v) / (b.v - a.v) * (b.u - a.u)) inside = !inside;
    a = b;
  }
  return inside;
}

// The largest view within the border: a grid of centres, refined around its best one.
View inner_view(const std::vector<Pixel>& border, const Box& box, Extent extent) {
  constexpr int kGrid = 4;
  View best = {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2, 0};
  const auto consider = [&](double x, double y) {
    const double size = free_size(border, extent, x, y);
    // Strictly better by more than rounding: where the place does not matter the view stays put.
    if (size > best.size * (1 + 1e-13) && encloses(border, x, y)) best = {x, y, size};
  };
  consider(best.x, best.y);
  double half_x = (box.high.u - box.low.u) / 2;
  double half_y = (box.high.v - box.low.v) / 2;
  for (int round = 0; round < 40; ++round) {
    const View centre = best;
    for (int i = -kGrid; i <= kGrid; ++i) {
      for (int j = -kGrid; j <= kGrid; ++j) {
        consider(centre.x + half_x * i / kGrid, centre.y + half_y * j / kGrid);
      }
    }
    half_x /= 2;
    half_y /= 2;
  }
  return best;
}

Result<Camera> to_camera(const Camera& source, ImageSize size, const View& view) {
  const double zoom = 0.5 / view.size;
  const double fx = source.fx() * zoom;
  const double fy = source.fy() * zoom;
  return Camera::make(
      "pinhole", size,
      {fx, fy, (size.width - 1) / 2.0 - fx * view.x, (size.height - 1) / 2.0 - fy * view.y});
}

bool border_is_inside(const Camera& source, const Camera& output) {
  const ImageSize size = output.image_size();
  const auto valid = [&](int x, int y) { return is_inside(source, output, x, y); };
  for (int x = 0; x < size.width; ++x) {
    if (!valid(x, 0) || !valid(x, size.height - 1)) return false;
  }
  for (int y = 0; y < size.height; ++y) {
    if (!valid(0, y) || !valid(size.width - 1, y)) return false;
  }
  return true;
}

// Takes the little off that slipped between the samples of the border.
View shrink_to_valid(const Camera& source, ImageSize output, View view) {
  const auto fits = [&](double size) {
    const auto camera = to_camera(source, output, {view.x, view.y, size});
    return camera && border_is_inside(source, *camera);
  };
  if (fits(view.size)) return view;
  double low = view.size * 0.99;
  double high = view.size;
  for (int i = 0; i < 100 && !fits(low); ++i) {
    high = low;
    low *= 0.9;
  }
  for (int i = 0; i < 12; ++i) {
    const double middle = (low + high) / 2;
    (fits(middle) ? low : high) = middle;
  }
  view.size = low;
  return view;
}

}  // namespace

Result<Camera> output_camera(const Camera& source, const ViewOptions& options) {
  const bool given = options.output.width > 0 && options.output.height > 0;
  const ImageSize size = given ? options.output : source.image_size();
  const std::vector<Pixel> border = seen_border(source);
  if (border.empty()) {
    return make_error(
        ErrorCode::kDegenerate,
        "The calibration is valid for no pixel of its image; calibrate the camera again.");
  }
  const Extent extent = {std::max(size.width - 1, 1) / source.fx(),
                         std::max(size.height - 1, 1) / source.fy()};
  const Box box = bounds(border);
  const double alpha = std::isfinite(options.alpha) ? std::clamp(options.alpha, 0.0, 1.0) : 0.0;
  View view = outer_view(box, extent);
  if (alpha < 1) {
    const View inner = shrink_to_valid(source, size, inner_view(border, box, extent));
    view = {std::lerp(inner.x, view.x, alpha), std::lerp(inner.y, view.y, alpha),
            std::lerp(inner.size, view.size, alpha)};
  }
  if (!(view.size > 0)) {
    return make_error(
        ErrorCode::kDegenerate,
        "The calibration is valid for too small a part of its image to make a picture of; "
        "calibrate the camera again.");
  }
  return to_camera(source, size, view);
}

std::optional<Pixel> transfer(const Camera& from, const Camera& to, Pixel pixel) noexcept {
  const auto ray = from.unproject(pixel);
  return ray ? to.project(*ray) : std::nullopt;
}

Result<Camera> moved(const Camera& camera, const Camera& from, const Camera& to) {
  const double sx = to.fx() / from.fx();
  const double sy = to.fy() / from.fy();
  std::vector<double> values = camera.parameters();
  values[0] *= sx;
  values[1] *= sy;
  values[2] = sx * (values[2] - from.cx()) + to.cx();
  values[3] = sy * (values[3] - from.cy()) + to.cy();
  return Camera::make(camera.model(), to.image_size(), values, sx * camera.skew());
}

Result<Camera> plain_camera(ImageSize size) {
  const double f = std::max(size.width, size.height);
  return Camera::make("pinhole", size, {f, f, (size.width - 1) / 2.0, (size.height - 1) / 2.0});
}

}  // namespace calvin
