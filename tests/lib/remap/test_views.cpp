// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Virtual cameras: projections, turning and zooming, the way back, and how pixels are sampled.
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/remap/opencv_rectangles.hpp"
#include "calvin/remap/undistorter.hpp"
#include "calvin/remap/view_range.hpp"
#include "remap_reference.hpp"

namespace calvin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Projection kProjections[] = {Projection::kRectilinear,     Projection::kCylindrical,
                                       Projection::kEquirectangular, Projection::kStereographic,
                                       Projection::kPanini,          Projection::kFisheye};

const reference::Lens kBarrel = {"barrel", "brown5", {-0.28, 0.09, 5e-4, -7e-4, 0}};
const reference::Lens kWide = {"fisheye", "fisheye", {-0.02, 0.005, -0.003, 0.0005}};

Camera barrel() { return reference::camera(kBarrel, {640, 480}, 480, 330, 230); }
Camera wide() { return reference::camera(kWide, {640, 480}, 200, 322, 238); }

TEST(Projection, LaysOutKnownDirections) {
  // 60 degrees to the right, and 30 degrees down, by the formulae of each.
  const Eigen::Vector3d right(std::sin(kPi / 3), 0, std::cos(kPi / 3));
  const Eigen::Vector3d down(0, 0.5, std::sqrt(0.75));
  const double at_right[] = {std::sqrt(3),     kPi / 3,          kPi / 3,
                             2 / std::sqrt(3), 2 / std::sqrt(3), kPi / 3};
  const double at_down[] = {std::sqrt(1.0 / 3),     std::sqrt(1.0 / 3), kPi / 6,
                            2 * std::tan(kPi / 12), std::sqrt(1.0 / 3), kPi / 6};
  for (std::size_t i = 0; i < std::size(kProjections); ++i) {
    EXPECT_NEAR(to_plane(kProjections[i], right)->u, at_right[i], 1e-12) << i;
    EXPECT_NEAR(to_plane(kProjections[i], right)->v, 0, 1e-12) << i;
    EXPECT_NEAR(to_plane(kProjections[i], down)->v, at_down[i], 1e-12) << i;
    EXPECT_NEAR(to_plane(kProjections[i], down)->u, 0, 1e-12) << i;
  }
}

TEST(Projection, GoesThereAndBack) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const Projection projection : kProjections) {
    int shown = 0;
    for (int i = 0; i < 2000; ++i) {
      const auto direction =
          Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
      const auto point = to_plane(projection, direction);
      if (!point) continue;
      ++shown;
      const auto back = from_plane(projection, *point);
      ASSERT_TRUE(back.has_value());
      EXPECT_LT((back->normalized() - direction).norm(), 1e-9);
    }
    EXPECT_GT(shown, 600);
  }
  EXPECT_FALSE(to_plane(Projection::kRectilinear, {1, 0, 0.2}).has_value());
  EXPECT_FALSE(to_plane(Projection::kCylindrical, {0, 1, 0.1}).has_value());
  EXPECT_FALSE(from_plane(Projection::kFisheye, {4, 0}).has_value());
}

// 75 degrees off the axis for a plane, and of latitude where its tangent is drawn; 150 degrees
// where the picture of what lies behind would be without end; everything for the others.
TEST(Projection, EndsWhereItSays) {
  const auto across = [](double degrees, double direction) {
    const double angle = degrees * kPi / 180;
    return Eigen::Vector3d(std::sin(angle) * std::cos(direction),
                           std::sin(angle) * std::sin(direction), std::cos(angle));
  };
  const auto at = [](double longitude, double latitude) {
    const double l = longitude * kPi / 180;
    const double b = latitude * kPi / 180;
    return Eigen::Vector3d(std::sin(l) * std::cos(b), std::sin(b), std::cos(l) * std::cos(b));
  };
  const auto shows = [](Projection projection, const Eigen::Vector3d& direction) {
    return to_plane(projection, 2.5 * direction).has_value();
  };
  for (const double sign : {-1.0, 1.0}) {
    for (const double direction : {0.0, 0.7, 2.0, 4.0}) {
      EXPECT_TRUE(shows(Projection::kRectilinear, across(74.9, direction)));
      EXPECT_FALSE(shows(Projection::kRectilinear, across(75.1, direction)));
      EXPECT_FALSE(shows(Projection::kRectilinear, across(179, direction)));
      EXPECT_TRUE(shows(Projection::kStereographic, across(149.9, direction)));
      EXPECT_FALSE(shows(Projection::kStereographic, across(150.1, direction)));
      EXPECT_TRUE(shows(Projection::kFisheye, across(179.9, direction)));
    }
    for (const double longitude : {-149.9, -90.0, 0.0, 20.0, 149.9}) {
      EXPECT_TRUE(shows(Projection::kCylindrical, at(longitude, sign * 74.9)));
      EXPECT_FALSE(shows(Projection::kCylindrical, at(longitude, sign * 75.1)));
      EXPECT_TRUE(shows(Projection::kPanini, at(longitude, sign * 74.9)));
      EXPECT_FALSE(shows(Projection::kPanini, at(longitude, sign * 75.1)));
    }
    EXPECT_TRUE(shows(Projection::kCylindrical, at(sign * 179.9, 0)));
    EXPECT_TRUE(shows(Projection::kEquirectangular, at(sign * 179.9, -sign * 89.9)));
    EXPECT_FALSE(shows(Projection::kPanini, at(sign * 150.1, 0)));
    // And what is drawn there leads nowhere.
    EXPECT_TRUE(from_plane(Projection::kCylindrical, {sign * 0.999 * kPi, 0}));
    EXPECT_FALSE(from_plane(Projection::kCylindrical, {sign * 1.001 * kPi, 0}));
    EXPECT_FALSE(from_plane(Projection::kEquirectangular, {sign * 1.001 * kPi, 0}));
    EXPECT_FALSE(from_plane(Projection::kEquirectangular, {0, sign * 0.501 * kPi}));
    EXPECT_FALSE(from_plane(Projection::kFisheye, {0, sign * 1.001 * kPi}));
  }
}

TEST(OutputView, AtAlphaZeroHasNoInvalidPixelInAnyProjection) {
  for (const Projection projection : kProjections) {
    for (const Camera& source : {barrel(), wide()}) {
      ViewOptions options;
      options.projection = projection;
      const VirtualCamera camera = output_view(source, options).value().camera;
      int invalid = 0;
      for (int y = 0; y < 480; y += 3) {
        for (int x = 0; x < 640; x += 3) {
          const auto ray = camera.ray({0.0 + x, 0.0 + y});
          const auto at = ray ? source.project(*ray) : std::nullopt;
          if (!at || at->u < -1e-3 || at->v < -1e-3 || at->u > 639.001 || at->v > 479.001) {
            ++invalid;
          }
        }
      }
      EXPECT_EQ(invalid, 0) << static_cast<int>(projection) << " " << source.model();
    }
  }
}

TEST(OutputView, PansRightTiltsUpAndZoomsAroundTheMiddle) {
  const Camera source = barrel();
  const VirtualCamera plain = output_view(source, {}).value().camera;
  const Pixel middle = {319.5, 239.5};
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  ViewOptions options;
  options.pan = 0.2;
  const VirtualCamera right = output_view(source, options).value().camera;
  const auto axis = [](const VirtualCamera& camera) {
    return camera.ray({camera.plane().cx(), camera.plane().cy()})->normalized();
  };
  EXPECT_NEAR(axis(right).x(), std::sin(0.2), 1e-12);
  options.pan = 0;
  options.tilt = 0.1;
  EXPECT_NEAR(axis(output_view(source, options)->camera).y(), -std::sin(0.1), 1e-12);
  options.tilt = 0;
  options.roll = 0.3;
  const VirtualCamera turned = output_view(source, options).value().camera;
  EXPECT_NEAR(angle(axis(turned), axis(plain)), 0, 1e-12);
  // What lies to the right of its axis is, seen upright, to the right and below.
  const auto aside = turned.ray({turned.plane().cx() + 100, turned.plane().cy()});
  EXPECT_NEAR(std::atan2(aside->y(), aside->x()), 0.3, 1e-12);
  options.roll = 0;
  options.zoom = 2;
  const VirtualCamera closer = output_view(source, options).value().camera;
  EXPECT_NEAR(angle(*closer.ray(middle), *plain.ray(middle)), 0, 1e-12);
  EXPECT_NEAR(angle(*closer.ray({419.5, 239.5}), *plain.ray({369.5, 239.5})), 0, 1e-12);
}

TEST(OutputView, WiderThanTheProjectionCanShowIsLimitedAndSaysSo) {
  ViewOptions options;
  options.alpha = 1;
  options.zoom = 0.05;
  const OutputView view = output_view(wide(), options).value();
  EXPECT_TRUE(view.limited);
  const double half = 319.5 / view.camera.plane().fx();
  EXPECT_NEAR(2 * std::atan(half) * 180 / kPi, 150, 1e-6);
  // All that this lens sees is wider than a plane.
  options.zoom = 1;
  EXPECT_TRUE(output_view(wide(), options)->limited);
  options.alpha = 0.9;
  EXPECT_FALSE(output_view(wide(), options)->limited);
  options.alpha = 1;
  options.projection = Projection::kFisheye;
  EXPECT_FALSE(output_view(wide(), options)->limited);
  options.projection = Projection::kRectilinear;
  EXPECT_FALSE(output_view(barrel(), options)->limited);
  options.zoom = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(output_view(wide(), options).has_value());
}

// A matrix of OpenCV 4.7 that is published with the camera that it belongs to
// (github.com/opencv/opencv, issue 27156), and one that 4.10.0 printed: whichever OpenCV this was
// built with. Since 4.8 a picture without distortion stays as it is (issue 23304 there).
TEST(OpenCvGrids, AreThoseOfBothVersions) {
  const auto filled = [](const Camera& source, OpenCvGrid grid) {
    const PlaneBox r = opencv_rectangles(source, Projection::kRectilinear, grid).inner;
    const double fx = (source.image_size().width - 1) / (r.high.u - r.low.u);
    const double fy = (source.image_size().height - 1) / (r.high.v - r.low.v);
    return std::vector<double>{fx, fy, -fx * r.low.u, -fy * r.low.v};
  };
  const Camera published =
      Camera::make("brown4", {1920, 1080},
                   {2.08421566e+03, 2.08421566e+03, 9.82199407e+02, 6.46842288e+02, 0.05522256,
                    -0.36009276, 0.00062108, 0.00139739})
          .value();
  const double before[] = {2.07294434e+03, 2.08679199e+03, 9.84632052e+02, 6.46684370e+02};
  const auto old = filled(published, OpenCvGrid::kPastTheEdge);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(old[i], before[i], 1e-3);
  const double printed[] = {325.659789, 347.683299, 332.452911, 227.868841};
  const Camera source = reference::camera(kBarrel, {640, 480}, 400, 330, 230);
  const auto now = filled(source, OpenCvGrid::kPixels);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(now[i], printed[i], 1e-6);
  const Camera plain = Camera::make("pinhole", {101, 101}, {70, 80, 50, 45}).value();
  const auto same = filled(plain, OpenCvGrid::kPixels);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(same[i], plain.parameters()[i], 1e-9);
}

// OpenCV knows no skew: the rows of a skewed sensor lie aside by 5 y px.
TEST(OpenCvGrids, FollowASkew) {
  const Camera skewed = Camera::make("pinhole", {101, 101}, {70, 80, 50, 45}, 5).value();
  const auto found = opencv_rectangles(skewed, Projection::kRectilinear, OpenCvGrid::kPixels);
  const double top = -45.0 / 80;
  const double bottom = 55.0 / 80;
  EXPECT_NEAR(found.inner.low.u, (-50 - 5 * top) / 70, 1e-12);
  EXPECT_NEAR(found.inner.high.u, (50 - 5 * bottom) / 70, 1e-12);
  EXPECT_NEAR(found.outer.low.u, (-50 - 5 * bottom) / 70, 1e-12);
  EXPECT_NEAR(found.outer.high.u, (50 - 5 * top) / 70, 1e-12);
  for (const PlaneBox& box : {found.inner, found.outer}) {
    EXPECT_NEAR(box.low.v, top, 1e-12);
    EXPECT_NEAR(box.high.v, bottom, 1e-12);
  }
}

// What was found for one view serves all that differ in nothing but how they look around.
TEST(ViewRange, ServesEveryAlphaZoomAndDirection) {
  for (const Camera& source : {barrel(), wide()}) {
    for (const AlphaMode mode : {AlphaMode::kCalvin, AlphaMode::kOpenCv}) {
      ViewOptions options;
      options.alpha = 1;
      options.alpha_mode = mode;
      const ViewRange range = ViewRange::find(source, options).value();
      options.alpha = 0.3;
      options.zoom = 1.4;
      options.pan = -0.3;
      options.tilt = 0.2;
      options.roll = 1;
      ASSERT_TRUE(range.serves(options));
      const OutputView got = range.view(options).value();
      const OutputView want = output_view(source, options).value();
      EXPECT_EQ(got.camera.plane().parameters(), want.camera.plane().parameters());
      EXPECT_EQ(*got.camera.ray({100, 50}), *want.camera.ray({100, 50}));
      options.projection = Projection::kPanini;
      EXPECT_FALSE(range.serves(options));
      options.projection = Projection::kRectilinear;
      options.output = {641, 480};
      EXPECT_FALSE(range.serves(options));
    }
  }
}

// Random levels on a coarse lattice, with smooth transitions between them.
GrayImage soft_noise(int width, int height) {
  constexpr int kCell = 8;  // px
  std::mt19937 random(5);
  std::uniform_real_distribution<double> level(0, 255);
  const int across = width / kCell + 2;
  std::vector<double> levels(static_cast<std::size_t>(across * (height / kCell + 2)));
  for (double& l : levels) l = level(random);
  const auto eased = [](int i) { return (1 - std::cos(kPi * (i % kCell) / kCell)) / 2; };
  GrayImage noise(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double* at = &levels[static_cast<std::size_t>(y / kCell * across + x / kCell)];
      const double above = std::lerp(at[0], at[1], eased(x));
      const double below = std::lerp(at[across], at[across + 1], eased(x));
      noise.row(y)[x] = static_cast<std::uint8_t>(std::lround(std::lerp(above, below, eased(y))));
    }
  }
  return noise;
}

GrayImage applied(const Undistorter& undistorter, const GrayImage& in, const Sampling& sampling) {
  const ImageSize size = undistorter.output().image_size();
  GrayImage out(size.width, size.height, 77);
  undistorter.apply(0, {in.pixels.data(), in.width}, {out.pixels.data(), out.width}, sampling);
  return out;
}

TEST(Undistorter, DistortsBackToWhatTheCameraSaw) {
  const Camera camera = barrel();
  ViewOptions options;
  options.alpha = 1;
  options.output = {1000, 750};
  const auto there = Undistorter::make(camera, options, {PlaneLayout{}}).value();
  const auto back = Undistorter::make_back(camera, options, {PlaneLayout{}}).value();
  EXPECT_EQ(back.output().image_size(), camera.image_size());
  EXPECT_EQ(back.output_model()->model(), "brown5");
  const GrayImage picture = soft_noise(640, 480);
  const GrayImage again =
      applied(back, applied(there, picture, {Interpolation::kLanczos, Outside::kReplicate}),
              {Interpolation::kLanczos, Outside::kReplicate});
  int worst = 0;
  for (int y = 8; y < 472; ++y) {
    for (int x = 8; x < 632; ++x) {
      worst = std::max(worst, std::abs(again.view().at(x, y) - picture.view().at(x, y)));
    }
  }
  EXPECT_LT(worst, 6);
}

// A reference kernel at exact places, in double precision.
double kernel_at(Interpolation interpolation, double t) {
  t = std::abs(t);
  switch (interpolation) {
    case Interpolation::kNearest:
      return t < 0.5 ? 1 : 0;
    case Interpolation::kBilinear:
      return std::max(0.0, 1 - t);
    case Interpolation::kBicubic:
      if (t < 1) return 1.5 * t * t * t - 2.5 * t * t + 1;
      return t < 2 ? -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2 : 0;
    case Interpolation::kLanczos:
      if (t < 1e-12) return 1;
      return t < 3 ? std::sin(kPi * t) * std::sin(kPi * t / 3) / (kPi * kPi * t * t / 3) : 0;
  }
  return 0;
}

int folded(int i, int count, Outside outside) {
  if (outside != Outside::kMirror) return std::clamp(i, 0, count - 1);
  while (i < 0 || i >= count) i = i < 0 ? -i : 2 * (count - 1) - i;
  return i;
}

TEST(Undistorter, SamplesWithEveryKernelAndBeyondTheBorder) {
  const Camera camera = barrel();
  ViewOptions options;
  options.alpha = 1;
  const auto undistorter =
      Undistorter::make(camera, options, {PlaneLayout{{}, 1, 1, 1, {9}}}).value();
  const GrayImage picture = soft_noise(640, 480);
  const double fold = reference::fold(kBarrel);
  const int step = std::getenv("CALVIN_FULL") != nullptr ? 1 : 6;
  for (const auto interpolation : {Interpolation::kNearest, Interpolation::kBilinear,
                                   Interpolation::kBicubic, Interpolation::kLanczos}) {
    for (const auto outside : {Outside::kFill, Outside::kReplicate, Outside::kMirror}) {
      const GrayImage got = applied(undistorter, picture, {interpolation, outside});
      double worst = 0;
      int beyond = 0;
      for (int y = 0; y < 480; y += step) {
        for (int x = 0; x < 640; ++x) {
          const auto [at, radius] =
              reference::source_place(kBarrel, camera, undistorter.output(), x, y);
          const double inside = std::min({at.u, at.v, 639 - at.u, 479 - at.v});
          if (std::abs(inside) < 0.01 || radius > fold - 0.01) continue;
          if (inside < 0) ++beyond;
          if (inside < 0 && outside == Outside::kFill) {
            EXPECT_EQ(got.view().at(x, y), 9);
            continue;
          }
          const auto hold = [&](double p, double last) {
            if (outside == Outside::kMirror && p < 0) return -p;
            if (outside == Outside::kMirror && p > last) return 2 * last - p;
            return std::clamp(p, 0.0, last);
          };
          const double u = hold(at.u, 639);
          const double v = hold(at.v, 479);
          const double edge = std::abs(std::abs(u - std::floor(u)) - 0.5);
          const double fall = std::abs(std::abs(v - std::floor(v)) - 0.5);
          if (interpolation == Interpolation::kNearest && std::min(edge, fall) < 0.01) continue;
          double sum = 0;
          double weights = 0;
          for (int j = -3; j <= 3; ++j) {
            for (int i = -3; i <= 3; ++i) {
              const int column = static_cast<int>(std::floor(u)) + i;
              const int row = static_cast<int>(std::floor(v)) + j;
              const double w =
                  kernel_at(interpolation, u - column) * kernel_at(interpolation, v - row);
              weights += w;
              sum += w * picture.view().at(folded(column, 640, outside), folded(row, 480, outside));
            }
          }
          const double exact = std::clamp(sum / weights, 0.0, 255.0);
          worst = std::max(worst, std::abs(got.view().at(x, y) - exact));
        }
      }
      EXPECT_LE(worst, 1.0) << static_cast<int>(interpolation) << " " << static_cast<int>(outside);
      EXPECT_GT(beyond, 1000);
    }
  }
}

}  // namespace
}  // namespace calvin
