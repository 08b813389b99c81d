// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the largest view within what cameras see and the smallest view around it.

#include "calvin/remap/view_frames.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calvin/remap/virtual_camera.hpp"

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

// A source camera as the plane of a projection sees it.
struct Scene {
  const Sight& sight;
  Projection projection;

  [[nodiscard]] std::optional<Pixel> on_plane(const Eigen::Vector3d& ray) const {
    return to_plane(projection, sight.camera_from_view.transpose() * ray);
  }
  // The ideal point of a source pixel, absent where the view cannot show it.
  [[nodiscard]] std::optional<Pixel> ideal_point(Pixel pixel) const {
    const auto ray = sight.camera.unproject(pixel);
    return ray ? on_plane(*ray) : std::nullopt;
  }
};

Pixel between(Pixel a, Pixel b, double t) { return {a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)}; }

Pixel last_pixel(const Camera& source) {
  return {source.image_size().width - 1.0, source.image_size().height - 1.0};
}

// The pixel next to the optical axis.
Pixel axis_of(const Camera& source) {
  const Pixel last = last_pixel(source);
  return {std::clamp(source.cx(), 0.0, last.u), std::clamp(source.cy(), 0.0, last.v)};
}

// A valid source pixel to look around from: near the principal point, or else wherever there is
// one.
std::optional<Pixel> find_centre(const Scene& scene) {
  const Camera& source = scene.sight.camera;
  const Pixel last = last_pixel(source);
  const Pixel axis = axis_of(source);
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
  const Camera& source = scene.sight.camera;
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
      const auto point = ray ? scene.on_plane(*ray) : std::nullopt;
      seen.cut = seen.cut || (ray && !point);
      seen.border.push_back(point ? *point : last_valid(scene, *centre, edge));
    }
  }
  return seen;
}

// The smallest rectangle around points of the plane.
PlaneBox bounds(const std::vector<Pixel>& points) {
  PlaneBox box = {points.front(), points.front()};
  for (const Pixel& p : points) {
    box.low = {std::min(box.low.u, p.u), std::min(box.low.v, p.v)};
    box.high = {std::max(box.high.u, p.u), std::max(box.high.v, p.v)};
  }
  return box;
}

PlaneBox around(const PlaneBox& a, const PlaneBox& b) {
  return {{std::min(a.low.u, b.low.u), std::min(a.low.v, b.low.v)},
          {std::max(a.high.u, b.high.u), std::max(a.high.v, b.high.v)}};
}

PlaneBox within(const PlaneBox& a, const PlaneBox& b) {
  return {{std::max(a.low.u, b.low.u), std::max(a.low.v, b.low.v)},
          {std::min(a.high.u, b.high.u), std::min(a.high.v, b.high.v)}};
}

// Where the middle of the largest view may lie: from the optical axis to the middle of the picture
// and as far beyond it, for what lies at the border counts more on the plane. A wide lens, or an
// output of another shape, has larger views at one side: a few percent more for half of the scene,
// and at another side once the principal point moves by a pixel. Absent where the plane does not
// show those points.
std::optional<PlaneBox> middle_of(const Scene& scene) {
  const Camera& source = scene.sight.camera;
  const Pixel last = last_pixel(source);
  const auto axis = scene.ideal_point(axis_of(source));
  const auto middle = scene.ideal_point({last.u / 2, last.v / 2});
  if (!axis || !middle) return std::nullopt;
  return bounds({*axis, between(*axis, *middle, 2)});
}

// The smallest view that shows the whole border.
Frame outer_frame(const PlaneBox& box, HalfSize half_size) {
  return {
      (box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2,
      std::max((box.high.u - box.low.u) / half_size.x, (box.high.v - box.low.v) / half_size.y) / 2};
}

// The regions that cameras see: their borders are polygons.
using Borders = std::vector<std::vector<Pixel>>;

// The border point to look at first.
struct Nearest {
  std::size_t border = 0;
  std::size_t point = 0;
};

// The largest size of a view at (x, y) that no border point lies in; where that is no larger than
// `enough`, any number up to `enough`. `nearest` becomes the point that decided.
double free_size(const Borders& borders, HalfSize half_size, double x, double y, double enough,
                 Nearest& nearest) {
  const auto size_at = [&](const Pixel& p) {
    return std::max(std::abs(p.u - x) / half_size.x, std::abs(p.v - y) / half_size.y);
  };
  double size = size_at(borders[nearest.border][nearest.point]);
  for (std::size_t b = 0; b < borders.size(); ++b) {
    for (std::size_t i = 0; i < borders[b].size() && size > enough; ++i) {
      const double here = size_at(borders[b][i]);
      if (here >= size) continue;
      size = here;
      nearest = {b, i};
    }
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

// The largest view within all borders whose middle lies in the box: a grid of centres, refined
// around its best one.
Frame inner_frame(const Borders& borders, const PlaneBox& box, HalfSize half_size) {
  constexpr int kRounds = 40;
  constexpr int kWide = 8;  // rounds that look around widely: several maxima are possible
  Frame best = {(box.low.u + box.high.u) / 2, (box.low.v + box.high.v) / 2, 0};
  Nearest nearest;
  const auto consider = [&](double x, double y) {
    const double size = free_size(borders, half_size, x, y, best.size, nearest);
    // Better by more than rounding: where the centre does not matter the view stays put.
    if (!(size > best.size * (1 + 1e-13))) return;
    const bool is_seen = std::ranges::all_of(
        borders, [&](const std::vector<Pixel>& border) { return encloses(border, x, y); });
    if (is_seen) best = {x, y, size};
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

// Whether the rays of the output's border pixels meet each source within the centres of its own, or
// miss it by rounding only.
class BorderCheck {
 public:
  BorderCheck(std::span<const Sight> sights, Projection projection, ImageSize output)
      : sights_(sights), projection_(projection) {
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
    return {projection_, plane, Eigen::Matrix3d::Identity()};
  }
  [[nodiscard]] bool valid(const VirtualCamera& camera, Pixel at) const {
    const auto ray = camera.ray(at);
    return ray && std::ranges::all_of(sights_, [&](const Sight& sight) {
             constexpr double kSlack = 0.5 / 1024;
             const ImageSize seen = sight.camera.image_size();
             const auto pixel = sight.camera.project(sight.camera_from_view * *ray);
             return pixel && pixel->u >= -kSlack && pixel->v >= -kSlack &&
                    pixel->u <= seen.width - 1 + kSlack && pixel->v <= seen.height - 1 + kSlack;
           });
  }

  std::span<const Sight> sights_;
  Projection projection_;
  std::vector<Pixel> pixels_;
  std::vector<Pixel> some_;
};

// The largest size of a view with that middle, up to its own size, at which some_pass().
double largest_of_some(const BorderCheck& check, const Camera& source, ImageSize output,
                       Frame view) {
  const auto fits = [&](double size) {
    const auto camera = to_camera(source, output, {view.x, view.y, size});
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
Frame shrink_to_valid(std::span<const Sight> sights, Projection projection, ImageSize output,
                      Frame view) {
  BorderCheck check(sights, projection, output);
  const Camera& first = sights.front().camera;
  for (int i = 0; i < 50; ++i) {
    view.size = largest_of_some(check, first, output, view);
    const auto camera = to_camera(first, output, view);
    if (!camera || check.all_pass(*camera)) break;
  }
  return view;
}

Error nothing_seen() {
  return {ErrorCode::kDegenerate,
          "The calibration is valid for no pixel of its image; calibrate the camera again."};
}

Error nothing_common() {
  return {ErrorCode::kDegenerate,
          "The cameras look in directions that have nothing in common: no picture shows what both "
          "see. Turn them to what they are to look at, and calibrate where they stand again."};
}

}  // namespace

// The smallest view around all that is seen is that, or as much of it as the widest view shows.
Result<ViewFrames> find_view_frames(std::span<const Sight> sights, Projection projection,
                                    ImageSize size) {
  ViewFrames frames;
  Borders borders;
  PlaneBox all;
  PlaneBox common;
  std::vector<Pixel> middles;
  for (const Sight& sight : sights) {
    const Scene scene = {sight, projection};
    Seen seen = seen_region(scene);
    if (seen.border.empty()) return tl::unexpected(nothing_seen());
    const PlaneBox box = bounds(seen.border);
    all = borders.empty() ? box : around(all, box);
    common = borders.empty() ? box : within(common, box);
    frames.cut = frames.cut || seen.cut;
    borders.push_back(std::move(seen.border));
    if (const auto middle = middle_of(scene)) {
      middles.insert(middles.end(), {middle->low, middle->high});
    }
  }
  const Camera& first = sights.front().camera;
  const HalfSize half_size = {std::max(size.width - 1, 1) / first.fx(),
                              std::max(size.height - 1, 1) / first.fy()};
  Frame outer = outer_frame(all, half_size);
  const double most = widest(projection) / std::max(half_size.x, half_size.y);
  frames.cut = frames.cut || outer.size > most;
  outer.size = std::min(outer.size, most);
  Frame largest;
  if (!middles.empty()) largest = inner_frame(borders, bounds(middles), half_size);
  if (!(largest.size > 0)) largest = inner_frame(borders, common, half_size);
  if (sights.size() > 1 && !(largest.size > 0)) return tl::unexpected(nothing_common());
  const Frame inner = shrink_to_valid(sights, projection, size, largest);
  const auto box_of = [&](const Frame& f) {
    return PlaneBox{{f.x - f.size * half_size.x, f.y - f.size * half_size.y},
                    {f.x + f.size * half_size.x, f.y + f.size * half_size.y}};
  };
  frames.inner = box_of(inner);
  frames.outer = box_of(outer);
  return frames;
}

}  // namespace calvin
