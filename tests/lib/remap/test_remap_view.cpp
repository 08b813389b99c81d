// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The camera that an undistorted picture shows, and how a calibration fits a frame.
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "calvin/camera/frame_fit.hpp"
#include "calvin/remap/view.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

using reference::Lens;

struct Case {
  Lens lens;
  ImageSize size;
  double focal, cx, cy;
  double fold = reference::fold(lens);
};

const std::vector<Case> kCases = {
    {{"pinhole", "pinhole", {}}, {640, 480}, 500, 322, 236},
    {{"barrel", "brown4", {-0.28, 0.09, 5e-4, -7e-4}}, {641, 479}, 480, 330, 230},
    {{"barrel, off centre", "brown4", {-0.28, 0.09, 0, 0}}, {640, 480}, 480, 250, 290},
    {{"pincushion", "brown4", {0.2, 0.05, -2e-3, 1e-3}}, {322, 242}, 240, 165, 118},
    {{"pincushion, off centre", "brown5", {0.25, 0, 0, 0, 0}}, {640, 480}, 480, 400, 200},
    {{"moustache", "brown5", {-0.3, 0.35, 1e-3, -5e-4, -0.05}}, {640, 480}, 400, 315, 243},
    {{"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}}, {640, 480}, 300, 322, 238},
};

Camera source_of(const Case& c) { return reference::camera(c.lens, c.size, c.focal, c.cx, c.cy); }

// How far inside the source the pixel of the output comes from, px; negative outside.
double inside(const Case& c, const Camera& output, double x, double y) {
  const auto [at, radius] = reference::source_place(c.lens, source_of(c), output, x, y);
  if (radius > c.fold) return -1;
  return std::min({at.u, at.v, c.size.width - 1 - at.u, c.size.height - 1 - at.v});
}

template <typename F>
void for_border(ImageSize size, F f) {
  for (int x = 0; x < size.width; ++x) f(x, 0), f(x, size.height - 1);
  for (int y = 0; y < size.height; ++y) f(0, y), f(size.width - 1, y);
}

double worst_on_border(const Case& c, const Camera& output) {
  double worst = std::numeric_limits<double>::infinity();
  for_border(c.size, [&](int x, int y) { worst = std::min(worst, inside(c, output, x, y)); });
  return worst;
}

bool wider_than_a_view(const Camera& view, Pixel at) {
  return std::hypot((at.u - view.cx()) / view.fx(), (at.v - view.cy()) / view.fy()) >
         std::tan(75 * std::numbers::pi / 180);
}

// The same view with lengths on the plane z = 1 multiplied by `factor` and moved by (dx, dy) px.
Camera changed(const Camera& view, double factor, double dx, double dy) {
  const double mx = (view.image_size().width - 1) / 2.0;
  const double my = (view.image_size().height - 1) / 2.0;
  return Camera::make("pinhole", view.image_size(),
                      {view.fx() / factor, view.fy() / factor, mx + (view.cx() - mx) / factor + dx,
                       my + (view.cy() - my) / factor + dy})
      .value();
}

TEST(OutputCamera, AtAlphaZeroShowsNoInvalidPixelAndIsTight) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.lens.name);
    const Camera view = output_camera(source_of(c), {0, {}}).value();
    EXPECT_EQ(view.model(), "pinhole");
    EXPECT_EQ(view.image_size(), c.size);
    EXPECT_NEAR(view.fx() / view.fy(), 1 / 0.98, 1e-9);
    double worst = std::numeric_limits<double>::infinity();
    for (int y = 0; y < c.size.height; ++y) {
      for (int x = 0; x < c.size.width; ++x) worst = std::min(worst, inside(c, view, x, y));
    }
    EXPECT_GE(worst, -1e-3);
    EXPECT_LT(worst_on_border(c, changed(view, 1.005, 0, 0)), -1e-3);
  }
}

TEST(OutputCamera, AtAlphaZeroIsTheLargestOfAllPlaces) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.lens.name);
    const Camera view = output_camera(source_of(c), {0, {}}).value();
    for (int i = -20; i <= 20; ++i) {
      for (int j = -20; j <= 20; ++j) {
        const double dx = i * std::abs(i) * 0.15;
        const double dy = j * std::abs(j) * 0.15;
        const Camera larger = changed(view, 1.005, dx, dy);
        // Corners and middles of the sides tell most; only survivors are looked at closely.
        const double right = c.size.width - 1;
        const double bottom = c.size.height - 1;
        if (std::min({inside(c, larger, 0, 0), inside(c, larger, right, 0),
                      inside(c, larger, 0, bottom), inside(c, larger, right, bottom),
                      inside(c, larger, right / 2, 0), inside(c, larger, right / 2, bottom),
                      inside(c, larger, 0, bottom / 2), inside(c, larger, right, bottom / 2)}) <
            -1e-3) {
          continue;
        }
        EXPECT_LT(worst_on_border(c, larger), -1e-3) << dx << " " << dy;
      }
    }
  }
}

// What the middle of the output shows, px of the source.
Pixel middle_of(const Camera& source, const OutputView& view) {
  const ImageSize size = view.camera.image_size();
  return transfer(view.camera, VirtualCamera(source),
                  {(size.width - 1) / 2.0, (size.height - 1) / 2.0})
      .value();
}

// A wide lens shows more of the plane beside its axis than at it, and an output of another shape
// has room at the sides: the largest view of all is there, at one side or at the other.
TEST(OutputCamera, AtAlphaZeroIsAboutTheMiddleOfThePicture) {
  const ImageSize size = {1280, 720};
  for (const Projection projection : {Projection::kRectilinear, Projection::kStereographic,
                                      Projection::kPanini, Projection::kCylindrical}) {
    for (const ImageSize output : {ImageSize{}, {360, 640}, {1280, 160}}) {
      std::optional<Pixel> before;
      for (double cx = 632; cx <= 648; cx += 0.5) {
        const Camera source =
            Camera::make("fisheye", size, {500, 500, cx, 361, 0, 0, 0, 0}).value();
        ViewOptions options;
        options.output = output;
        options.projection = projection;
        const Pixel middle = middle_of(source, output_view(source, options).value());
        EXPECT_NEAR(middle.u, 639.5, 24) << static_cast<int>(projection) << " " << cx;
        EXPECT_NEAR(middle.v, 359.5, 8) << static_cast<int>(projection) << " " << cx;
        if (before) {
          EXPECT_NEAR(middle.u, before->u, 8) << static_cast<int>(projection) << " " << cx;
        }
        before = middle;
      }
    }
  }
}

TEST(OutputCamera, AtAlphaOneShowsEverySourcePixel) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.lens.name);
    const Camera source = source_of(c);
    const Camera view = output_camera(source, {1, {}}).value();
    EXPECT_NEAR(view.fx() / view.fy(), 1 / 0.98, 1e-9);
    double nearest = std::numeric_limits<double>::infinity();
    int shown = 0;
    const auto look = [&](int x, int y) {
      const auto at = transfer(source, view, {static_cast<double>(x), static_cast<double>(y)});
      if (!at || wider_than_a_view(view, *at)) return;
      ++shown;
      // The formulae agree that this is where the pixel belongs.
      const auto back = reference::source_place(c.lens, source, view, at->u, at->v);
      EXPECT_NEAR(back.pixel.u, x, 1e-6);
      EXPECT_NEAR(back.pixel.v, y, 1e-6);
      const double in =
          std::min({at->u, at->v, c.size.width - 1 - at->u, c.size.height - 1 - at->v});
      EXPECT_GE(in, -0.02);
      nearest = std::min(nearest, in);
    };
    for_border(c.size, look);
    EXPECT_GE(shown, c.size.width + c.size.height);
    EXPECT_LT(nearest, 0.1);  // and no more than that
  }
}

TEST(OutputCamera, GrowsWithAlpha) {
  const auto edges = [](const Camera& c) {
    return Eigen::Array4d(c.cx() / c.fx(), c.cy() / c.fy(),
                          (c.image_size().width - 1 - c.cx()) / c.fx(),
                          (c.image_size().height - 1 - c.cy()) / c.fy());
  };
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.lens.name);
    const Camera source = source_of(c);
    const Eigen::Array4d inner = edges(output_camera(source, {0, {}}).value());
    const Eigen::Array4d outer = edges(output_camera(source, {1, {}}).value());
    EXPECT_TRUE((outer >= inner - 1e-9).all());
    const Eigen::Array4d between = edges(output_camera(source, {0.3, {}}).value());
    EXPECT_TRUE(((0.7 * inner + 0.3 * outer - between).abs() < 1e-9).all());
    // Out of range and not a number are taken as what they are nearest to.
    EXPECT_TRUE(((edges(output_camera(source, {7, {}}).value()) - outer).abs() < 1e-12).all());
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(((edges(output_camera(source, {nan, {}}).value()) - inner).abs() < 1e-12).all());
  }
}

TEST(OutputCamera, OfALensWithoutDistortionIsTheSameCamera) {
  const Camera source = source_of(kCases[0]);
  for (const double alpha : {0.0, 0.5, 1.0}) {
    const Camera view = output_camera(source, {alpha, {}}).value();
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(view.parameters()[i], source.parameters()[i], 1e-8);
    }
  }
}

TEST(OutputCamera, OfAWiderLensThanAPlaneCanShowIsLimited) {
  // 190 degrees from the left to the right border; an equidistant lens.
  const double focal = 640 / (190 * std::numbers::pi / 180);
  const Lens lens = {"190 degrees", "fisheye", {0, 0, 0, 0}};
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{640, 640}}) {
    const Camera source = reference::camera(lens, size, focal, 319.5, size.height / 2.0 - 0.5);
    for (const double alpha : {0.0, 0.4, 1.0}) {
      const Camera view = output_camera(source, {alpha, {}}).value();
      for (const double p : view.parameters()) ASSERT_TRUE(std::isfinite(p));
      const double field = 2 * std::atan(std::max((size.width - 1) / 2.0 / view.fx(),
                                                  (size.height - 1) / 2.0 / view.fy()));
      EXPECT_LE(field, 150.01 * std::numbers::pi / 180);
      EXPECT_GE(field, 80 * std::numbers::pi / 180);
      if (alpha == 1) {
        EXPECT_NEAR(field, 150 * std::numbers::pi / 180, 1e-3);
      }
    }
  }
}

TEST(Transfer, MakesStraightLinesStraight) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.lens.name);
    const Camera source = source_of(c);
    const Camera view = output_camera(source, {1, {}}).value();
    for (double angle = 0; angle < 3; angle += 0.37) {
      const Pixel direction = {std::cos(angle), std::sin(angle)};
      double worst = 0;
      double bend = 0;
      int points = 0;
      for (double t = -0.5; t <= 0.5; t += 0.05) {
        // A line of the scene, off the axis, pictured by the formulae.
        const double x = t * direction.u - 0.15 * direction.v;
        const double y = t * direction.v + 0.15 * direction.u;
        const Pixel d = reference::distort(c.lens, x, y);
        const Pixel seen = {source.fx() * d.u + source.cx(), source.fy() * d.v + source.cy()};
        const auto at = transfer(source, view, seen);
        ASSERT_TRUE(at.has_value());
        const Pixel n = {(at->u - view.cx()) / view.fx(), (at->v - view.cy()) / view.fy()};
        worst = std::max(worst, std::abs(-direction.v * n.u + direction.u * n.v - 0.15));
        bend = std::max(bend, std::abs(-direction.v * d.u + direction.u * d.v - 0.15));
        ++points;
      }
      EXPECT_GT(points, 10);
      EXPECT_LT(worst, 1e-10);
      // It was not straight before.
      EXPECT_EQ(bend > 1e-3, !c.lens.k.empty());
    }
  }
}

TEST(FitToFrame, ScalesCropsAndRefuses) {
  Calibration calibration;
  calibration.model = "brown4";
  calibration.image_size = {640, 480};
  for (const auto& [name, value] : std::vector<std::pair<const char*, double>>{{"fx", 500},
                                                                               {"fy", 510},
                                                                               {"cx", 319.5},
                                                                               {"cy", 239.5},
                                                                               {"k1", -0.2},
                                                                               {"k2", 0.05},
                                                                               {"p1", 1e-3},
                                                                               {"p2", 2e-3},
                                                                               {"skew", 0.5}}) {
    calibration.parameters.push_back({name, value, {}});
  }
  const auto same = fit_to_frame(calibration, {640, 480}).value();
  EXPECT_FALSE(same.scaled);
  EXPECT_EQ(same.camera.parameters(), Camera::make(calibration)->parameters());

  // Twice the size: a point of the scene is seen at twice the distance from the corner.
  const auto twice = fit_to_frame(calibration, {1280, 960}).value();
  EXPECT_TRUE(twice.scaled);
  const Eigen::Vector3d point(0.3, -0.2, 1.1);
  const Pixel a = same.camera.project(point).value();
  const Pixel b = twice.camera.project(point).value();
  EXPECT_NEAR(b.u + 0.5, 2 * (a.u + 0.5), 1e-9);
  EXPECT_NEAR(b.v + 0.5, 2 * (a.v + 0.5), 1e-9);

  // A third of the width rounds: still the same aspect.
  EXPECT_TRUE(fit_to_frame(calibration, {213, 160}).has_value());
  const auto wide = fit_to_frame(calibration, {640, 360});
  ASSERT_FALSE(wide.has_value());
  EXPECT_NE(wide.error().message.find("640x480"), std::string::npos);
  EXPECT_NE(wide.error().message.find("640x360"), std::string::npos);

  // The frames are the middle of the calibrated image, at twice its resolution.
  calibration.sensor_crop = Rectangle{0, 60, 640, 360};
  const auto cropped = fit_to_frame(calibration, {1280, 720}).value();
  const Pixel d = cropped.camera.project(point).value();
  EXPECT_NEAR(d.u + 0.5, 2 * (a.u + 0.5), 1e-9);
  EXPECT_NEAR(d.v + 0.5, 2 * (a.v + 0.5 - 60), 1e-9);
  const auto whole = fit_to_frame(calibration, {640, 480});
  ASSERT_FALSE(whole.has_value());
  EXPECT_NE(whole.error().message.find("sensor_crop of the calibration is a part of 640x360 px"),
            std::string::npos)
      << whole.error().message;
  calibration.sensor_crop = Rectangle{0, 0, 0, 360};
  EXPECT_FALSE(fit_to_frame(calibration, {640, 480}).has_value());

  // Of the upright picture, 360x640, while the frames lie on a side: a quarter turn clockwise takes
  // the pixel (u, v) of a frame to (height - 1 - v, u), and x to -y.
  const Orientation clockwise = {true, true, false};
  calibration.sensor_crop = Rectangle{60, 0, 360, 480};
  EXPECT_FALSE(fit_to_frame(calibration, {1280, 960}).has_value());
  const auto turned = fit_to_frame(calibration, {1280, 960}, clockwise);
  ASSERT_FALSE(turned.has_value()) << "it has skew";
  calibration.parameters.pop_back();
  const auto upright = fit_to_frame(calibration, {960, 1280}).value().camera;
  const auto lying = fit_to_frame(calibration, {1280, 960}, clockwise).value();
  EXPECT_TRUE(lying.turned);
  EXPECT_EQ(lying.camera.image_size(), (ImageSize{1280, 960}));
  const Pixel e = upright.project(point).value();
  const Pixel f = lying.camera.project({point[1], -point[0], point[2]}).value();
  EXPECT_NEAR(e.u, 960 - 1 - f.v, 1e-9);
  EXPECT_NEAR(e.v, f.u, 1e-9);

  calibration.sensor_crop.reset();
  calibration.image_size = {640, 480};
  // Where the frames themselves have the aspect, the orientation does not matter.
  EXPECT_FALSE(fit_to_frame(calibration, {640, 480}, clockwise).value().turned);
  calibration.image_size = {0, 0};
  const auto unknown = fit_to_frame(calibration, {800, 200}).value();
  EXPECT_FALSE(unknown.scaled);
  EXPECT_EQ(unknown.camera.fx(), 500);
}

// A point of the scene is seen where the whole picture shows it, less the corner of the part; a
// calibration that is of the part itself stays as it is.
TEST(FitToPart, TellsWhichPictureTheCalibrationIsOf) {
  const Camera whole =
      Camera::make("brown4", {640, 480}, {500, 510, 322, 236, -0.2, 0.05, 1e-3, 2e-3}).value();
  const FramePart part = {{1280, 960}, 300, 200, {640, 360}};
  const Eigen::Vector3d point(0.1, -0.05, 1);
  const Pixel in_whole = whole.project(point).value();
  const auto cut = fit_to_part(whole.to_calibration(), part).value();
  EXPECT_TRUE(cut.scaled);
  EXPECT_EQ(cut.camera.image_size(), part.size);
  const Pixel in_part = cut.camera.project(point).value();
  EXPECT_NEAR(in_part.u + 0.5, 2 * (in_whole.u + 0.5) - 300, 1e-9);
  EXPECT_NEAR(in_part.v + 0.5, 2 * (in_whole.v + 0.5) - 200, 1e-9);
  // Another shape than the whole: of the part, or of nothing.
  const Camera wide = whole.cropped(0, 60, {640, 360});
  EXPECT_EQ(fit_to_part(wide.to_calibration(), part)->camera.parameters(), wide.parameters());
  EXPECT_FALSE(fit_to_part(whole.cropped(0, 0, {480, 480}).to_calibration(), part).has_value());
  // Both have the shape: exactly the size of the part decides, and else what it says itself.
  const FramePart half = {{1280, 960}, 100, 80, {640, 480}};
  EXPECT_EQ(fit_to_part(whole.to_calibration(), half)->camera.parameters(), whole.parameters());
  Calibration says = whole.scaled({320, 240}).to_calibration();
  EXPECT_GT(std::abs(fit_to_part(says, half)->camera.fx() - 500), 100);
  says.sensor_crop = Rectangle{0, 0, 320, 240};
  EXPECT_NEAR(fit_to_part(says, half)->camera.fx(), 500, 1e-9);
}

}  // namespace
}  // namespace calvin
