// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/remap/view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

namespace calvin {

namespace {

constexpr int kSamplesPerSide = 256;

// A view on the plane, of the aspect of the output: the centres of its border pixels lie at
// x +- size * extent_x and y +- size * extent_y.
struct Frame {
  double x = 0;
  double y = 0;
  double size = 0;
};

struct Extent {
  double x;
  double y;
};

// The source camera as the plane of a projection sees it.
struct Scene {
  const Camera& source;
  Projection projection;

  // The ideal point of a source pixel, absent where the view cannot show it.
  [[nodiscard]] std::optional<Pixel> ideal_point(Pixel pixel) const {
    const auto ray = source.unproject(pixel);
    return ray ? to_plane(projection, *ray) : std::nullopt;
  }
};

Pixel between(Pixel a, Pixel b, double t) { return {a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)}; }

// A valid source pixel to look around from: near the principal point, or else wherever there is
// one.
std::optional<Pixel> find_centre(const Scene& scene) {
  const Camera& source = scene.source;
  const Pixel last = {source.image_size().width - 1.0, source.image_size().height - 1.0};
  const Pixel axis = {std::clamp(source.cx(), 0.0, last.u), std::clamp(source.cy(), 0.0, last.v)};
  const Pixel middle = {last.u / 2, last.v / 2};
  constexpr int kSteps = 16;
  for (int i = 0; i <= kSteps; ++i) {
    const Pixel pixel = between(axis, middle, static_cast<double>(i) / kSteps);
    if (scene.ideal_point(pixel)) return pixel;
  }
  for (int i = 0; i <= kSteps * kSteps; ++i) {
    const Pixel pixel = {last.u * (i % kSteps + 0.5) / kSteps,
                         last.v * (i / kSteps + 0.5) / kSteps};
    if (scene.ideal_point(pixel)) return pixel;
  }
  return std::nullopt;
}

// The ideal point furthest from `centre` on the way to `edge` that is still valid.
Pixel last_valid(const Scene& scene, Pixel centre, Pixel edge) {
  if (const auto point = scene.ideal_point(edge)) return *point;
  Pixel found = *scene.ideal_point(centre);
  double low = 0;
  double high = 1;
  for (int i = 0; i < 40; ++i) {
    const double t = (low + high) / 2;
    const auto point = scene.ideal_point(between(centre, edge, t));
    (point ? low : high) = t;
    if (point) found = *point;
  }
  return found;
}

// The border of the region that the source sees, on the plane; empty where there is none.
std::vector<Pixel> seen_border(const Scene& scene) {
  const Camera& source = scene.source;
  std::vector<Pixel> border;
  const auto centre = find_centre(scene);
  if (!centre) return border;
  const double right = source.image_size().width - 1.0;
  const double bottom = source.image_size().height - 1.0;
  const Pixel corners[] = {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kSamplesPerSide; ++i) {
      const Pixel edge =
          between(corners[side], corners[(side + 1) % 4], static_cast<double>(i) / kSamplesPerSide);
      border.push_back(last_valid(scene, *centre, edge));
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
Frame outer_frame(const Box& box, Extent extent, Projection projection) {
  const double needed =
      std::max((box.high.u - box.low.u) / extent.x, (box.high.v - box.low.v) / extent.y) / 2;
  return {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2,
          std::min(needed, widest(projection) / std::max(extent.x, extent.y))};
}

// The largest size of a view at (x, y) that no border point lies in, or anything below `enough`
// where it is no larger than that.
double free_size(const std::vector<Pixel>& border, Extent extent, double x, double y,
                 double enough) {
  double size = std::numeric_limits<double>::infinity();
  for (const Pixel& p : border) {
    size = std::min(size, std::max(std::abs(p.u - x) / extent.x, std::abs(p.v - y) / extent.y));
    if (size <= enough) break;
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
Frame inner_frame(const std::vector<Pixel>& border, const Box& box, Extent extent) {
  constexpr int kGrid = 4;
  Frame best = {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2, 0};
  const auto consider = [&](double x, double y) {
    const double size = free_size(border, extent, x, y, best.size);
    // Strictly better by more than rounding: where the place does not matter the view stays put.
    if (size > best.size * (1 + 1e-13) && encloses(border, x, y)) best = {x, y, size};
  };
  consider(best.x, best.y);
  double half_x = (box.high.u - box.low.u) / 2;
  double half_y = (box.high.v - box.low.v) / 2;
  for (int round = 0; round < 40; ++round) {
    const Frame centre = best;
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

Result<Camera> to_camera(const Camera& source, ImageSize size, const Frame& view) {
  const double zoom = 0.5 / view.size;
  const double fx = source.fx() * zoom;
  const double fy = source.fy() * zoom;
  return Camera::make(
      "pinhole", size,
      {fx, fy, (size.width - 1) / 2.0 - fx * view.x, (size.height - 1) / 2.0 - fy * view.y});
}

// Whether the rays of the output's border pixels meet the source within the centres of its own, or
// miss it by rounding only.
bool border_is_inside(const Scene& scene, const Camera& plane) {
  const ImageSize size = plane.image_size();
  const ImageSize seen = scene.source.image_size();
  const Eye eye(scene.projection, plane, Eigen::Matrix3d::Identity());
  const auto valid = [&](double x, double y) {
    constexpr double kSlack = 0.5 / 1024;
    const auto ray = eye.ray({x, y});
    const auto pixel = ray ? scene.source.project(*ray) : std::nullopt;
    return pixel && pixel->u >= -kSlack && pixel->v >= -kSlack &&
           pixel->u <= seen.width - 1 + kSlack && pixel->v <= seen.height - 1 + kSlack;
  };
  for (int x = 0; x < size.width; ++x) {
    if (!valid(x, 0) || !valid(x, size.height - 1)) return false;
  }
  for (int y = 0; y < size.height; ++y) {
    if (!valid(0, y) || !valid(size.width - 1, y)) return false;
  }
  return true;
}

// Takes the little off that slipped between the samples of the border.
Frame shrink_to_valid(const Scene& scene, ImageSize output, Frame view) {
  const auto fits = [&](double size) {
    const auto camera = to_camera(scene.source, output, {view.x, view.y, size});
    return camera && border_is_inside(scene, *camera);
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

double part_of(double alpha) { return std::isfinite(alpha) ? std::clamp(alpha, 0.0, 1.0) : 0.0; }

Error no_view(const char* what) {
  return {ErrorCode::kDegenerate, fmt::format("The calibration is valid for {}; calibrate the "
                                              "camera again.",
                                              what)};
}

Result<Frame> frame_of(const Scene& scene, ImageSize size, double alpha) {
  const std::vector<Pixel> border = seen_border(scene);
  if (border.empty()) return tl::unexpected(no_view("no pixel of its image"));
  const Extent extent = {std::max(size.width - 1, 1) / scene.source.fx(),
                         std::max(size.height - 1, 1) / scene.source.fy()};
  const Box box = bounds(border);
  Frame view = outer_frame(box, extent, scene.projection);
  if (alpha < 1) {
    const Frame inner = shrink_to_valid(scene, size, inner_frame(border, box, extent));
    view = {std::lerp(inner.x, view.x, alpha), std::lerp(inner.y, view.y, alpha),
            std::lerp(inner.size, view.size, alpha)};
  }
  if (!(view.size > 0)) {
    return tl::unexpected(no_view("too small a part of its image to make a picture of"));
  }
  return view;
}

// cv::getOptimalNewCameraMatrix() of OpenCV 4: the inner and the outer rectangle around 9 x 9
// points, and a pinhole between those that fill the picture with them.
Result<Camera> opencv_plane(const Scene& scene, ImageSize size, double alpha) {
  constexpr int kPoints = 9;
  const ImageSize seen = scene.source.image_size();
  const double infinity = std::numeric_limits<double>::infinity();
  Box inner = {{-infinity, -infinity}, {infinity, infinity}};
  Box outer = {{infinity, infinity}, {-infinity, -infinity}};
  for (int j = 0; j < kPoints; ++j) {
    for (int i = 0; i < kPoints; ++i) {
      // One column and one row further than the last pixels.
      const auto p = scene.ideal_point(
          {i * (0.0 + seen.width) / (kPoints - 1), j * (0.0 + seen.height) / (kPoints - 1)});
      if (!p) continue;
      outer.low = {std::min(outer.low.u, p->u), std::min(outer.low.v, p->v)};
      outer.high = {std::max(outer.high.u, p->u), std::max(outer.high.v, p->v)};
      if (i == 0) inner.low.u = std::max(inner.low.u, p->u);
      if (i == kPoints - 1) inner.high.u = std::min(inner.high.u, p->u);
      if (j == 0) inner.low.v = std::max(inner.low.v, p->v);
      if (j == kPoints - 1) inner.high.v = std::min(inner.high.v, p->v);
    }
  }
  const auto filled = [&](double inner_low, double inner_high, double outer_low, double outer_high,
                          int length) {
    const double f0 = (length - 1) / (inner_high - inner_low);
    const double f1 = (length - 1) / (outer_high - outer_low);
    return std::pair(std::lerp(f0, f1, alpha), std::lerp(-f0 * inner_low, -f1 * outer_low, alpha));
  };
  const auto [fx, cx] = filled(inner.low.u, inner.high.u, outer.low.u, outer.high.u, size.width);
  const auto [fy, cy] = filled(inner.low.v, inner.high.v, outer.low.v, outer.high.v, size.height);
  if (!(fx > 0 && fy > 0 && std::isfinite(fx + fy + cx + cy))) {
    return tl::unexpected(no_view("too small a part of its image to make a picture of"));
  }
  return Camera::make("pinhole", size, {fx, fy, cx, cy});
}

// Enlarged around the middle of the picture, but not to less than `widest` on each side of it.
Result<Camera> zoomed(const Camera& plane, double zoom, double widest_half, bool& limited) {
  const ImageSize size = plane.image_size();
  const double least =
      std::max((size.width - 1) / 2.0 / plane.fx(), (size.height - 1) / 2.0 / plane.fy()) /
      widest_half;
  if (!(zoom > 0) || !std::isfinite(zoom)) zoom = 1;
  limited = zoom < least * (1 - 1e-9);
  const double factor = std::max(zoom, least);
  const double u = (size.width - 1) / 2.0;
  const double v = (size.height - 1) / 2.0;
  return Camera::make("pinhole", size,
                      {factor * plane.fx(), factor * plane.fy(), u + factor * (plane.cx() - u),
                       v + factor * (plane.cy() - v)});
}

Eigen::Matrix3d rotation_of(const ViewOptions& options) {
  const auto angle = [](double value) { return std::isfinite(value) ? value : 0.0; };
  return (Eigen::AngleAxisd(angle(options.pan), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angle(options.tilt), Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(angle(options.roll), Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

}  // namespace

Result<OutputView> output_view(const Camera& source, const ViewOptions& options) {
  const bool given = options.output.width > 0 && options.output.height > 0;
  const ImageSize size = given ? options.output : source.image_size();
  const Scene scene = {source, options.projection};
  const double alpha = part_of(options.alpha);
  Result<Camera> plane = tl::unexpected(Error{});
  if (options.alpha_mode == AlphaMode::kOpenCv) {
    plane = opencv_plane(scene, size, alpha);
  } else {
    const auto frame = frame_of(scene, size, alpha);
    if (!frame) return tl::unexpected(frame.error());
    plane = to_camera(source, size, *frame);
  }
  bool limited = false;
  if (plane && options.zoom != 1) {
    plane = zoomed(*plane, options.zoom, widest(options.projection), limited);
  }
  if (!plane) return tl::unexpected(plane.error());
  return OutputView{Eye(options.projection, *std::move(plane), rotation_of(options)), limited};
}

Result<Camera> output_camera(const Camera& source, const ViewOptions& options) {
  const auto view = output_view(source, options);
  if (!view) return tl::unexpected(view.error());
  return view->eye.plane();
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
