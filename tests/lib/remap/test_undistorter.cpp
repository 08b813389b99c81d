// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Points and boxes that follow the pixels of an undistorted picture.
#include <gtest/gtest.h>

#include "calvin/remap/undistorter.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

using reference::Lens;

constexpr ImageSize kSize = {640, 480};
const Lens kBarrel = {"brown4 barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}};
const Lens kPincushion = {"brown4 pincushion", "brown4", {0.12, -0.02, -1e-3, 1e-3}};
const Lens kFisheye = {"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}};

Undistorter undistorter_of(const Lens& lens, double focal, const ViewOptions& options) {
  const Camera source = reference::camera(lens, kSize, focal, 327, 233);
  return Undistorter::make(source, options, {PlaneLayout{}}).value();
}

TEST(Undistorter, PointsFollowThePixels) {
  const Undistorter undistorter = undistorter_of(kBarrel, 480, {0, {}});
  Observation seen;
  for (int i = 0; i < 7; ++i) {
    const Pixel ideal = {80.0 * i + 60, 60.0 * i + 50};
    const auto place = reference::source_place(kBarrel, undistorter.source(), undistorter.output(),
                                               ideal.u, ideal.v)
                           .pixel;
    seen.ids.push_back(i);
    seen.uv.push_back(place);
    seen.sigma.push_back(0.1);
    const auto back = undistorter.to_source(ideal);
    ASSERT_TRUE(back.has_value());
    EXPECT_NEAR(back->u, place.u, 1e-9);
    EXPECT_NEAR(back->v, place.v, 1e-9);
  }
  // A corner of the source that the view at alpha 0 cuts off.
  seen.ids.push_back(7);
  seen.uv.push_back({0, 0});
  seen.sigma.push_back(0.1);
  const Observation mapped = undistorter.to_output(seen);
  ASSERT_EQ(mapped.ids.size(), 7u);
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(mapped.ids[i], i);
    EXPECT_NEAR(mapped.uv[i].u, 80.0 * i + 60, 1e-7);
    EXPECT_NEAR(mapped.uv[i].v, 60.0 * i + 50, 1e-7);
  }
  // In the middle the picture is scaled by the ratio of the focal lengths.
  EXPECT_NEAR(mapped.sigma[3], 0.1 * undistorter.output().fx() / undistorter.source().fx(), 2e-3);
}

// px of the output -> px of the source, from the formulae of projection.hpp and view.hpp; `radius`
// as reference::source_place() has it, and without end behind the camera.
reference::Place place_of(const Lens& lens, const Undistorter& undistorter,
                          const ViewOptions& options, double u, double v) {
  const Camera& plane = undistorter.output();
  const Camera& source = undistorter.source();
  const double x = (u - plane.cx()) / plane.fx();
  const double y = (v - plane.cy()) / plane.fy();
  const double r = std::hypot(x, y);
  // Turned by the angle t from the axis, along (x, y).
  const auto at_angle = [&](double t) {
    const double along = r > 0 ? std::sin(t) / r : 1;
    return Eigen::Vector3d(along * x, along * y, std::cos(t));
  };
  // At the longitude l, with the tangent of the latitude.
  const auto at_longitude = [](double l, double tangent) {
    return Eigen::Vector3d(std::sin(l), tangent, std::cos(l));
  };
  Eigen::Vector3d seen(x, y, 1);
  if (options.projection == Projection::kCylindrical) seen = at_longitude(x, y);
  if (options.projection == Projection::kEquirectangular) seen = at_longitude(x, std::tan(y));
  if (options.projection == Projection::kStereographic) seen = at_angle(2 * std::atan(r / 2));
  if (options.projection == Projection::kPanini) {
    const double l = 2 * std::atan(x / 2);
    seen = at_longitude(l, y * (1 + std::cos(l)) / 2);
  }
  if (options.projection == Projection::kFisheye) seen = at_angle(r);
  // Clockwise, then up, then to the right.
  const auto turn = [](double& a, double& b, double angle) {
    const double old = a;
    a = std::cos(angle) * a - std::sin(angle) * b;
    b = std::sin(angle) * old + std::cos(angle) * b;
  };
  turn(seen.x(), seen.y(), options.roll);
  turn(seen.y(), seen.z(), options.tilt);
  turn(seen.z(), seen.x(), options.pan);
  if (!(seen.z() > 1e-3)) return {{0, 0}, INFINITY};
  seen /= seen.z();
  const Pixel d = reference::distort(lens, seen.x(), seen.y());
  const double radius = std::hypot(seen.x(), seen.y());
  return {{source.fx() * d.u + source.cx(), source.fy() * d.v + source.cy()},
          lens.model == "fisheye" ? std::atan(radius) : radius};
}

bool inside(Pixel p, ImageSize size) {
  return p.u >= -0.5 && p.v >= -0.5 && p.u <= size.width - 0.5 && p.v <= size.height - 0.5;
}

// Views of every kind, that look at once to the side, up and round.
std::vector<ViewOptions> views_aside() {
  std::vector<ViewOptions> all;
  for (const Projection projection :
       {Projection::kRectilinear, Projection::kCylindrical, Projection::kEquirectangular,
        Projection::kStereographic, Projection::kPanini, Projection::kFisheye}) {
    ViewOptions options;
    options.alpha = 0.3;
    options.projection = projection;
    options.zoom = 1.3;
    options.pan = 0.3;
    options.tilt = -0.2;
    options.roll = 0.5;
    all.push_back(options);
    options.output = {320, 200};
    options.pan = -0.2;
    options.tilt = 0.25;
    all.push_back(options);
  }
  return all;
}

// What a view shows of the source at some of its pixels, and how much larger it is there.
struct Shown {
  std::vector<Pixel> at;     // px of the output
  std::vector<Pixel> place;  // px of the source
  double larger = 0;         // the mean of sqrt(area in the output over that in the source)
};

Shown shown_by(const Lens& lens, const Undistorter& undistorter, const ViewOptions& options) {
  const double fold = reference::fold(lens);
  const ImageSize size = undistorter.output().image_size();
  Shown shown;
  double sum = 0;
  for (int v = 10; v < size.height; v += 37) {
    for (int u = 10; u < size.width; u += 41) {
      const auto [at, radius] = place_of(lens, undistorter, options, u, v);
      if (radius > 0.98 * fold || !inside(at, kSize)) continue;
      shown.at.push_back({0.0 + u, 0.0 + v});
      shown.place.push_back(at);
      const Pixel right = place_of(lens, undistorter, options, u + 0.01, v).pixel;
      const Pixel below = place_of(lens, undistorter, options, u, v + 0.01).pixel;
      sum += 0.01 / std::sqrt(std::abs((right.u - at.u) * (below.v - at.v) -
                                       (right.v - at.v) * (below.u - at.u)));
    }
  }
  shown.larger = sum / static_cast<double>(shown.at.size());
  return shown;
}

void expect_near(const std::optional<Pixel>& found, Pixel expected, double tolerance) {
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->u, expected.u, tolerance);
  EXPECT_NEAR(found->v, expected.v, tolerance);
}

// Places go the way of the pixels there and back, whatever the view looks at.
TEST(Undistorter, PointsFollowEveryView) {
  for (const auto& [lens, focal] : {std::pair(kBarrel, 480.0), std::pair(kFisheye, 260.0)}) {
    for (const ViewOptions& options : views_aside()) {
      SCOPED_TRACE(lens.name + ", projection " +
                   std::to_string(static_cast<int>(options.projection)));
      const Undistorter there = undistorter_of(lens, focal, options);
      const Undistorter back =
          Undistorter::make_back(there.source(), options, {PlaneLayout{}}).value();
      const Shown shown = shown_by(lens, there, options);
      ASSERT_GT(shown.at.size(), 10u);
      for (std::size_t i = 0; i < shown.at.size(); ++i) {
        expect_near(there.to_source(shown.at[i]), shown.place[i], 1e-8);
        expect_near(there.to_output(shown.place[i]), shown.at[i], 1e-6);
        expect_near(back.to_output(shown.at[i]), shown.place[i], 1e-8);
        expect_near(back.to_source(shown.place[i]), shown.at[i], 1e-6);
      }
    }
  }
}

// So do the corners of a board, of which those that the view does not show have no part in its
// blur either.
TEST(Undistorter, ABoardFollowsEveryView) {
  for (const ViewOptions& options : views_aside()) {
    const Undistorter undistorter = undistorter_of(kBarrel, 480, options);
    const Shown shown = shown_by(kBarrel, undistorter, options);
    Observation seen;
    seen.uv = shown.place;
    seen.uv.insert(seen.uv.end(), {{-2000, 0}, {0, 5000}, {2000, 2000}});
    for (std::size_t i = 0; i < seen.uv.size(); ++i) seen.ids.push_back(static_cast<int>(i));
    seen.sigma.assign(seen.uv.size(), 0.1);
    seen.blur = 0.8;
    const Observation mapped = undistorter.to_output(seen);
    ASSERT_EQ(mapped.ids.size(), shown.at.size());
    double sum = 0;
    for (std::size_t i = 0; i < shown.at.size(); ++i) {
      EXPECT_EQ(mapped.ids[i], static_cast<int>(i));
      expect_near(mapped.uv[i], shown.at[i], 1e-6);
      sum += mapped.sigma[i];
    }
    const auto count = static_cast<double>(shown.at.size());
    EXPECT_NEAR(sum / count / (0.1 * shown.larger), 1, 0.01);
    EXPECT_NEAR(mapped.blur / (0.8 * shown.larger), 1, 0.01);
  }
}

// An observation of one corner in the middle of the picture, with all that an observation can hold.
Observation seen_in_the_middle() {
  Observation seen;
  seen.ids = {0};
  seen.uv = {{327, 233}};
  seen.sigma = {0.1};
  seen.blur = 0.8;
  seen.patches = std::make_shared<CornerPatches>(
      CornerPatches{3, {{326, 232}}, std::make_shared<std::uint8_t[]>(9, std::uint8_t{7})});
  return seen;
}

TEST(Undistorter, LengthsAroundCornersGrowWithThePicture) {
  for (const ImageSize size : {kSize, ImageSize{320, 240}, ImageSize{1280, 960}}) {
    const Undistorter undistorter = undistorter_of(kBarrel, 480, {0, size});
    const Observation mapped = undistorter.to_output(seen_in_the_middle());
    ASSERT_EQ(mapped.ids.size(), 1u);
    // At the centre of the lens the picture is scaled by the ratio of the focal lengths.
    const double scale = undistorter.output().fx() / undistorter.source().fx();
    EXPECT_NEAR(mapped.sigma[0], 0.1 * scale, 1e-4 * scale);
    EXPECT_NEAR(mapped.blur, 0.8 * scale, 1e-3 * scale);
  }
}

// The pixels of patches are the source's: whoever looks at them again would take them for ours.
TEST(Undistorter, PatchesOfAnotherPictureAreLeftOut) {
  const Undistorter undistorter = undistorter_of(kBarrel, 480, {0, {}});
  EXPECT_EQ(undistorter.to_output(seen_in_the_middle()).patches, nullptr);
}

// The box around all output pixels that come from within a box of the source, found one by one.
std::optional<Rectangle> box_of_pixels(const Lens& lens, const Undistorter& undistorter,
                                       const ViewOptions& options, const Rectangle& box) {
  const ImageSize size = undistorter.output().image_size();
  int left = size.width, top = size.height, right = -1, bottom = -1;
  const double fold = reference::fold(lens);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto [at, radius] = place_of(lens, undistorter, options, x, y);
      if (radius > fold || !inside(at, kSize) || at.u + 0.5 < box.x ||
          at.u + 0.5 > box.x + box.width || at.v + 0.5 < box.y || at.v + 0.5 > box.y + box.height) {
        continue;
      }
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  }
  if (right < 0) return std::nullopt;
  return Rectangle{0.0 + left, 0.0 + top, right - left + 1.0, bottom - top + 1.0};
}

TEST(Undistorter, ABoxFollowsItsPixels) {
  const Rectangle boxes[] = {{100, 80, 60, 90},   {300, 200, 2, 2},    {0, 0, 640, 480},
                             {0, 0, 4, 4},        {-50, 100, 120, 70}, {500, 380, 300, 300},
                             {20, 200, 600, 100}, {700, 100, 50, 50},  {100, 100, 0, 50}};
  int shown = 0;
  for (const auto& [lens, focal] :
       {std::pair(kBarrel, 480.0), std::pair(kPincushion, 480.0), std::pair(kFisheye, 260.0)}) {
    for (const ViewOptions& options : {ViewOptions{0, {}}, ViewOptions{1, {}},
                                       ViewOptions{0.5, {320, 300}}, views_aside().front()}) {
      const Undistorter undistorter = undistorter_of(lens, focal, options);
      for (const Rectangle& box : boxes) {
        SCOPED_TRACE(lens.name + ", alpha " + std::to_string(options.alpha) + ", x " +
                     std::to_string(box.x) + ", width " + std::to_string(box.width));
        const auto expected = box_of_pixels(lens, undistorter, options, box);
        const auto found = undistorter.to_output(box);
        if (!expected) {
          // Between two pixels there is room for a little that none of them shows.
          EXPECT_TRUE(!found || found->width < 1 || found->height < 1);
          continue;
        }
        ++shown;
        ASSERT_TRUE(found.has_value());
        // The corner of a box that is turned points further between two pixels.
        const double near = options.roll != 0 ? 2.5 : 1.01;
        EXPECT_NEAR(found->x, expected->x, near);
        EXPECT_NEAR(found->y, expected->y, near);
        EXPECT_NEAR(found->x + found->width, expected->x + expected->width, near);
        EXPECT_NEAR(found->y + found->height, expected->y + expected->height, near);
      }
    }
  }
  EXPECT_GT(shown, 45);
}

// Where nothing is moved a box is what it was, cut to the picture, to a fraction of a pixel.
TEST(Undistorter, ABoxStaysInAPictureThatStays) {
  const Undistorter undistorter = undistorter_of({"pinhole", "pinhole", {}}, 480, {0, {}});
  for (const Rectangle& box : {Rectangle{100.3, 80.6, 60.2, 90.7},
                               {-50.3, 100.2, 120.1, 70.6},
                               {500.7, 380.4, 300, 300},
                               {20.2, -30.1, 200.6, 60.5},
                               {600.6, 50.3, 90, 40.4},
                               {30.7, 430.2, 80.6, 90}}) {
    const double right = std::min(box.x + box.width, 640.0);
    const double bottom = std::min(box.y + box.height, 480.0);
    const auto found = undistorter.to_output(box);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->x, std::max(box.x, 0.0), 1e-6);
    EXPECT_NEAR(found->y, std::max(box.y, 0.0), 1e-6);
    EXPECT_NEAR(found->x + found->width, right, 1e-6);
    EXPECT_NEAR(found->y + found->height, bottom, 1e-6);
  }
  EXPECT_FALSE(undistorter.to_output(Rectangle{-50, 100, 49, 70}));
}

TEST(Undistorter, APointerOutsideThePictureIsAtItsBorder) {
  const Undistorter undistorter = undistorter_of(kBarrel, 480, {1, {}});
  int outside = 0;
  for (int x = -40; x < kSize.width + 40; x += 7) {
    for (int y = -40; y < kSize.height + 40; y += 7) {
      const Pixel at = {0.0 + x, 0.0 + y};
      const Pixel place = undistorter.nearest_source(at);
      const auto exact = undistorter.to_source(at);
      const double inside = std::min({place.u + 0.5, place.v + 0.5, kSize.width - 0.5 - place.u,
                                      kSize.height - 0.5 - place.v});
      if (exact) {
        EXPECT_EQ(place.u, exact->u);
        EXPECT_EQ(place.v, exact->v);
      } else {
        ++outside;
        EXPECT_NEAR(inside, 0, 1e-3) << x << ", " << y;
      }
    }
  }
  EXPECT_GT(outside, 500);
}

TEST(PlainCamera, ScalesAnyPictureWithoutStretchingIt) {
  const Camera plain = plain_camera(kSize).value();
  for (const ImageSize size : {ImageSize{320, 240}, ImageSize{1000, 300}, ImageSize{200, 480}}) {
    for (const double alpha : {0.0, 1.0}) {
      const Undistorter scaler = Undistorter::make(plain, {alpha, size}, {PlaneLayout{}}).value();
      // Seen from the middle of the picture, which stays in the middle: one factor both ways.
      const double fill = std::max((size.width - 1) / 639.0, (size.height - 1) / 479.0);
      const double fit = std::min((size.width - 1) / 639.0, (size.height - 1) / 479.0);
      const double factor = alpha == 0 ? fill : fit;
      const Pixel at = scaler.to_output(Pixel{319.5 + 30, 239.5 + 20}).value();
      EXPECT_NEAR(at.u, (size.width - 1) / 2.0 + factor * 30, 1e-6);
      EXPECT_NEAR(at.v, (size.height - 1) / 2.0 + factor * 20, 1e-6);
      // A calibration follows.
      const Camera camera = reference::camera(kBarrel, kSize, 480, 327, 233);
      const Camera follows = reframed(camera, plain, scaler.output()).value();
      EXPECT_EQ(follows.image_size(), size);
      const Eigen::Vector3d point(0.1, -0.05, 1);
      const Pixel expected = scaler.to_output(camera.project(point).value()).value();
      const Pixel found = follows.project(point).value();
      EXPECT_NEAR(found.u, expected.u, 1e-9);
      EXPECT_NEAR(found.v, expected.v, 1e-9);
    }
  }
}

// A picture may be stretched on the way, as alpha-mode=opencv does.
TEST(MovedCamera, SeesWhatTheMovedPictureShows) {
  const Camera camera =
      Camera::make("brown4", kSize, {480, 470, 327, 233, -0.28, 0.09, 5e-4, -7e-4}, 1.5).value();
  const Camera from = Camera::make("pinhole", kSize, {500, 520, 300, 250}).value();
  const Camera to = Camera::make("pinhole", {800, 300}, {700, 310, 410, 140}).value();
  const Camera result = reframed(camera, from, to).value();
  EXPECT_EQ(result.image_size(), to.image_size());
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0, 0, 1), {0.3, 0.2, 1}, {-0.4, 0.1, 1}, {0.1, -0.3, 1}}) {
    const Pixel before = camera.project(point).value();
    const Pixel after = {(before.u - 300) / 500 * 700 + 410, (before.v - 250) / 520 * 310 + 140};
    expect_near(result.project(point), after, 1e-9);
  }
}

}  // namespace
}  // namespace calvin
