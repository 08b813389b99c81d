// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the largest view within what a camera sees and the smallest view around it.

#include "calvin/remap/view_range.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/remap/opencv_rectangles.hpp"

namespace calvin {

namespace {

// Points along each side of the source's border; shrink_to_valid() makes up for what lies between.
constexpr int kSamplesPerSide = 256;

// A view on the plane, of the aspect of the output: the centres of its border pixels lie at
// x +- size * half_size.x and y +- size * half_size.y.
struct Frame {
  double x = 0;
  double y = 0;
  double size = 0;
};

// Half the size on the plane of a view of size 1.
struct HalfSize {
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
    const int row = i / kSteps;
    const int column = i % kSteps;
    const Pixel pixel = {last.u * (column + 0.5) / kSteps, last.v * (row + 0.5) / kSteps};
    if (scene.ideal_point(pixel)) return pixel;
  }
  return std::nullopt;
}

// The last valid ideal point on the way from `centre` to `edge`, which is not valid.
Pixel last_valid(const Scene& scene, Pixel centre, Pixel edge) {
  Pixel found = *scene.ideal_point(centre);
  double low = 0;
  double high = 1;
  for (int i = 0; i < 26; ++i) {  // 1e-5 px of the largest picture
    const double t = (low + high) / 2;
    const auto point = scene.ideal_point(between(centre, edge, t));
    (point ? low : high) = t;
    if (point) found = *point;
  }
  return found;
}

// The region of the plane that the source sees.
struct Seen {
  std::vector<Pixel> border;  // empty where there is none
  bool cut = false;           // rays of the source's border pixels are not on the plane
};

Seen seen_region(const Scene& scene) {
  const Camera& source = scene.source;
  Seen seen;
  const auto centre = find_centre(scene);
  if (!centre) return seen;
  const double right = source.image_size().width - 1.0;
  const double bottom = source.image_size().height - 1.0;
  const Pixel corners[] = {{0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kSamplesPerSide; ++i) {
      const Pixel edge =
          between(corners[side], corners[(side + 1) % 4], static_cast<double>(i) / kSamplesPerSide);
      const auto ray = source.unproject(edge);
      const auto point = ray ? to_plane(scene.projection, *ray) : std::nullopt;
      seen.cut = seen.cut || (ray && !point);
      seen.border.push_back(point ? *point : last_valid(scene, *centre, edge));
    }
  }
  return seen;
}

// The smallest rectangle around points of the plane.
struct Bounds {
  Pixel low;
  Pixel high;
};

Bounds bounds(const std::vector<Pixel>& points) {
  Bounds box = {points.front(), points.front()};
  for (const Pixel& p : points) {
    box.low = {std::min(box.low.u, p.u), std::min(box.low.v, p.v)};
    box.high = {std::max(box.high.u, p.u), std::max(box.high.v, p.v)};
  }
  return box;
}

// The smallest view that shows the whole border.
Frame outer_frame(const Bounds& box, HalfSize half_size) {
  return {
      (box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2,
      std::max((box.high.u - box.low.u) / half_size.x, (box.high.v - box.low.v) / half_size.y) / 2};
}

// The largest size of a view at (x, y) that no border point lies in; where that is no larger than
// `enough`, any number up to `enough`. `nearest` is the point to look at first, and becomes the
// point that decided.
double free_size(const std::vector<Pixel>& border, HalfSize half_size, double x, double y,
                 double enough, std::size_t& nearest) {
  const auto size_at = [&](const Pixel& p) {
    return std::max(std::abs(p.u - x) / half_size.x, std::abs(p.v - y) / half_size.y);
  };
  double size = size_at(border[nearest]);
  for (std::size_t i = 0; i < border.size() && size > enough; ++i) {
    const double here = size_at(border[i]);
    if (here >= size) continue;
    size = here;
    nearest = i;
  }
  return size;
}

// Whether the border, as a polygon, encloses a point: even-odd rule.
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
Frame inner_frame(const std::vector<Pixel>& border, const Bounds& box, HalfSize half_size) {
  constexpr int kRounds = 40;
  constexpr int kWide = 8;  // rounds that look around widely: several maxima are possible
  Frame best = {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2, 0};
  std::size_t nearest = 0;
  const auto consider = [&](double x, double y) {
    const double size = free_size(border, half_size, x, y, best.size, nearest);
    // Better by more than rounding: where the centre does not matter the view stays put.
    if (size > best.size * (1 + 1e-13) && encloses(border, x, y)) best = {x, y, size};
  };
  consider(best.x, best.y);
  double half_x = (box.high.u - box.low.u) / 2;
  double half_y = (box.high.v - box.low.v) / 2;
  for (int round = 0; round < kRounds; ++round) {
    const int grid = round < kWide ? 4 : 2;
    const Frame centre = best;
    for (int i = -grid; i <= grid; ++i) {
      for (int j = -grid; j <= grid; ++j) {
        consider(centre.x + half_x * i / grid, centre.y + half_y * j / grid);
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
class BorderCheck {
 public:
  BorderCheck(const Scene& scene, ImageSize output) : scene_(scene) {
    for (int x = 0; x < output.width; ++x) {
      pixels_.push_back({0.0 + x, 0});
      pixels_.push_back({0.0 + x, output.height - 1.0});
    }
    for (int y = 0; y < output.height; ++y) {
      pixels_.push_back({0, 0.0 + y});
      pixels_.push_back({output.width - 1.0, 0.0 + y});
    }
    constexpr std::size_t kSome = 16;
    for (std::size_t i = 0; i < pixels_.size(); i += kSome) some_.push_back(pixels_[i]);
  }

  // Looks at some of the pixels only, and at all pixels that have failed before.
  [[nodiscard]] bool some_pass(const Camera& plane) const {
    const VirtualCamera camera = camera_of(plane);
    return std::all_of(some_.rbegin(), some_.rend(), [&](Pixel p) { return valid(camera, p); });
  }
  bool all_pass(const Camera& plane) {
    const VirtualCamera camera = camera_of(plane);
    const auto it = std::find_if(pixels_.begin(), pixels_.end(),
                                 [&](const Pixel& p) { return !valid(camera, p); });
    if (it != pixels_.end()) some_.push_back(*it);
    return it == pixels_.end();
  }

 private:
  [[nodiscard]] VirtualCamera camera_of(const Camera& plane) const {
    return {scene_.projection, plane, Eigen::Matrix3d::Identity()};
  }
  [[nodiscard]] bool valid(const VirtualCamera& camera, Pixel at) const {
    constexpr double kSlack = 0.5 / 1024;
    const ImageSize seen = scene_.source.image_size();
    const auto ray = camera.ray(at);
    const auto pixel = ray ? scene_.source.project(*ray) : std::nullopt;
    return pixel && pixel->u >= -kSlack && pixel->v >= -kSlack &&
           pixel->u <= seen.width - 1 + kSlack && pixel->v <= seen.height - 1 + kSlack;
  }

  const Scene& scene_;
  std::vector<Pixel> pixels_;
  std::vector<Pixel> some_;
};

// The largest size of a view with that middle, up to its own size, at which some_pass().
double largest_of_some(const BorderCheck& check, const Scene& scene, ImageSize output, Frame view) {
  const auto fits = [&](double size) {
    const auto camera = to_camera(scene.source, output, {view.x, view.y, size});
    return camera && check.some_pass(*camera);
  };
  if (fits(view.size)) return view.size;
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
  return low;
}

// Shrinks a view by the little that the border juts in between its samples.
Frame shrink_to_valid(const Scene& scene, ImageSize output, Frame view) {
  BorderCheck check(scene, output);
  for (int i = 0; i < 50; ++i) {
    view.size = largest_of_some(check, scene, output, view);
    const auto camera = to_camera(scene.source, output, view);
    if (!camera || check.all_pass(*camera)) break;
  }
  return view;
}

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

}  // namespace

// The largest view within what the source sees, and the smallest around it or as much of that as
// the widest view shows.
Status ViewRange::find_frames(const Camera& source) {
  const Scene scene = {source, asked_.projection};
  const Seen seen = seen_region(scene);
  if (seen.border.empty()) return tl::unexpected(no_view("no pixel of its image"));
  const HalfSize half_size = {std::max(size_.width - 1, 1) / source.fx(),
                              std::max(size_.height - 1, 1) / source.fy()};
  const Bounds box = bounds(seen.border);
  Frame outer = outer_frame(box, half_size);
  const double most = widest(asked_.projection) / std::max(half_size.x, half_size.y);
  cut_ = seen.cut || outer.size > most;
  outer.size = std::min(outer.size, most);
  const Frame inner = shrink_to_valid(scene, size_, inner_frame(seen.border, box, half_size));
  const auto box_of = [&](const Frame& f) {
    return Box{{f.x - f.size * half_size.x, f.y - f.size * half_size.y},
               {f.x + f.size * half_size.x, f.y + f.size * half_size.y}};
  };
  inner_ = box_of(inner);
  outer_ = box_of(outer);
  return {};
}

Result<ViewRange> ViewRange::find(const Camera& source, const ViewOptions& options) {
  const bool given = options.output.width > 0 && options.output.height > 0;
  ViewRange range(options, given ? options.output : source.image_size());
  if (options.alpha_mode == AlphaMode::kOpenCv) {
    const auto found = opencv_rectangles(source, options.projection, opencv_grid());
    range.inner_ = {found.inner.low, found.inner.high};
    range.outer_ = {found.outer.low, found.outer.high};
  } else if (const Status found = range.find_frames(source); !found) {
    return tl::unexpected(found.error());
  }
  return range;
}

// The borders of the view move linearly; for OpenCV the focal lengths and the centre do.
Result<Camera> ViewRange::plane(double alpha) const {
  const auto axis = [&](double inner_low, double inner_high, double outer_low, double outer_high,
                        int length) {
    if (asked_.alpha_mode == AlphaMode::kCalvin) {
      return filled(std::lerp(inner_low, outer_low, alpha),
                    std::lerp(inner_high, outer_high, alpha), length);
    }
    const Axis inner = filled(inner_low, inner_high, length);
    const Axis outer = filled(outer_low, outer_high, length);
    return Axis{std::lerp(inner.focal, outer.focal, alpha),
                std::lerp(inner.centre, outer.centre, alpha)};
  };
  const Axis x = axis(inner_.low.u, inner_.high.u, outer_.low.u, outer_.high.u, size_.width);
  const Axis y = axis(inner_.low.v, inner_.high.v, outer_.low.v, outer_.high.v, size_.height);
  if (!(x.focal > 0 && y.focal > 0 && std::isfinite(x.focal + y.focal + x.centre + y.centre))) {
    return tl::unexpected(no_view("too small a part of its image to make a picture of"));
  }
  return Camera::make("pinhole", size_, {x.focal, y.focal, x.centre, y.centre});
}

Result<OutputView> ViewRange::view(const ViewOptions& options) const {
  const double alpha = part_of(options.alpha);
  const double zoom = options.zoom > 0 && std::isfinite(options.zoom) ? options.zoom : 1;
  auto shown = plane(alpha);
  bool limited = false;
  if (shown && zoom != 1) shown = zoomed(*shown, zoom, widest(asked_.projection), limited);
  if (!shown) return tl::unexpected(shown.error());
  limited = limited || (cut_ && alpha == 1 && zoom <= 1);
  return OutputView{VirtualCamera(asked_.projection, *std::move(shown), camera_from_view(options)),
                    limited};
}

}  // namespace calvin
