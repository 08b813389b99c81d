// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Manual points on the picture: crosses that leave the pixel itself in sight, and their numbers.

#include <algorithm>
#include <cmath>
#include <string>

#include "calvin/camera/image_transform.hpp"
#include "calvin/draw/overlay_layout.hpp"
#include "calvin/draw/overlay_shapes.hpp"

namespace calvin {

namespace {

// In px of the frame, those of which some is in it. A program may write any place.
std::vector<PlacedPoint> points_on(ImageSize frame, const Progress& progress) {
  std::vector<PlacedPoint> points;
  for (const PlacedPoint& point : progress.points) {
    const Pixel& part = point.at;
    const bool is_in_view = part.u >= 0 && part.u <= 1 && part.v >= 0 && part.v <= 1;
    if (!is_in_view || points.size() == Progress::kMostPoints) continue;
    points.push_back(
        {point.id, {coordinate_at(part.u, frame.width), coordinate_at(part.v, frame.height)}});
  }
  return points;
}

}  // namespace

void add_points(std::vector<Shape>& shapes, ImageSize frame, const Progress& progress) {
  const double unit = unit_of(frame);
  const double pen = std::max(1.0, 1.3 * unit);
  const double near = 3.5 * unit;
  const double far = 8 * unit;
  const std::vector<PlacedPoint> points = points_on(frame, progress);
  for (const PlacedPoint& point : points) {
    // What the last click did.
    const Colour& colour = &point == &points.back() ? kGreen : kWhite;
    for (const Pixel way : {Pixel{1, 1}, {1, -1}, {-1, 1}, {-1, -1}}) {
      shapes.push_back({Shape::Kind::kLine,
                        {point.at.u + near * way.u, point.at.v + near * way.v},
                        {point.at.u + far * way.u, point.at.v + far * way.v},
                        0,
                        pen,
                        colour,
                        unit});
    }
  }
}

std::vector<OverlayWords> overlay_point_numbers(ImageSize frame, const Progress& progress) {
  const double unit = unit_of(frame);
  const double size = 10 * unit;
  std::vector<OverlayWords> numbers;
  for (const PlacedPoint& point : points_on(frame, progress)) {
    std::string text = std::to_string(point.id);
    const double width = size * static_cast<double>(text.size());
    const double right = point.at.u + 9 * unit;
    const double left = right + width > frame.width ? point.at.u - 9 * unit - 0.7 * width : right;
    numbers.push_back({std::move(text), {left, point.at.v}, width, size});
  }
  return numbers;
}

}  // namespace calvin
