// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Undistorted pictures of random sizes, lenses and views against a reference in double precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

#include "remap_planes.hpp"

namespace calvin {
namespace {

using namespace remap_planes;
using reference::Lens;
using reference::Place;

struct RandomCase {
  Lens lens;
  ImageSize size;
  double focal = 0;  // px
  Pixel centre;
  ViewOptions view;
};

RandomCase make_case(unsigned seed) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  RandomCase c;
  c.size.width = static_cast<int>(48 * std::exp(between(0, 3.4)));
  c.size.height = static_cast<int>(c.size.width * between(0.4, 1.2)) + 9;
  const bool fisheye = seed % 3 == 0;
  const bool rational = seed % 3 == 1 && seed % 2 == 0;
  if (rational) {
    c.lens = {"rational8",
              "rational8",
              {between(-0.2, 0.4), between(-0.05, 0.05), between(-2e-3, 2e-3), between(-2e-3, 2e-3),
               between(-0.01, 0.01), between(0, 0.7), between(0, 0.1), between(-4e-3, 4e-3)}};
  } else if (fisheye) {
    c.lens = {
        "fisheye",
        "fisheye",
        {between(-0.05, 0.05), between(-0.01, 0.01), between(-4e-3, 4e-3), between(-1e-3, 1e-3)}};
  } else {
    c.lens = {"brown5",
              "brown5",
              {between(-0.35, 0.2), between(-0.1, 0.15), between(-2e-3, 2e-3), between(-2e-3, 2e-3),
               between(-0.03, 0.01)}};
  }
  c.focal = c.size.width * (fisheye ? between(0.28, 0.8) : between(0.5, 1.5));
  c.centre = {c.size.width * between(0.45, 0.55), c.size.height * between(0.45, 0.55)};
  c.view.alpha = between(0, 1);
  if (seed % 4 != 0) {
    c.view.roll = between(-0.3, 0.3) * (seed % 7 == 0 ? 10 : 1);
    c.view.pan = between(-0.2, 0.2);
    c.view.tilt = between(-0.2, 0.2);
    c.view.zoom = std::exp(between(-1, 1));
  }
  return c;
}

// Where the pixels of an output with that view come from.
PlaceFunction place_function(const RandomCase& c, const Camera& source, const Camera& output) {
  const Eigen::Matrix3d turn = camera_from_view(c.view);
  return [=](double x, double y) -> Place {
    const Eigen::Vector3d ray =
        turn * Eigen::Vector3d((x - output.cx()) / output.fx(), (y - output.cy()) / output.fy(), 1);
    const double u = ray.x() / ray.z() * output.fx() + output.cx();
    const double v = ray.y() / ray.z() * output.fy() + output.cy();
    return reference::source_place(c.lens, source, output, u, v);
  };
}

// The reference knows nothing of what is behind the camera.
bool is_in_front(const RandomCase& c, const Camera& output) {
  const Eigen::Matrix3d turn = camera_from_view(c.view);
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) {
      const Eigen::Vector3d corner((x * c.size.width - output.cx()) / output.fx(),
                                   (y * c.size.height - output.cy()) / output.fy(), 1);
      if ((turn * corner).z() < 0.1) return false;
    }
  }
  return true;
}

std::string text_of(unsigned seed, const RandomCase& c, const NamedLayout& layout) {
  std::ostringstream text;
  text << "case " << seed << ": " << c.size.width << "x" << c.size.height << ", " << c.lens.model;
  for (const double k : c.lens.k) text << " " << k;
  text << ", focal " << c.focal / c.size.width << ", alpha " << c.view.alpha << ", zoom "
       << c.view.zoom << ", roll " << c.view.roll << ", " << layout.name;
  return text.str();
}

// Where the model ends a place changes at will from one pixel to the next.
constexpr double kNearFold = 0.08;

TEST(RemapRandom, EqualsBilinearInDoublePrecisionWithinOneGreyLevel) {
  const bool full = std::getenv("CALVIN_FULL") != nullptr;
  const unsigned cases = full ? 1000 : 60;
  int compared = 0;
  for (unsigned seed = 0; seed < cases; ++seed) {
    const RandomCase c = make_case(seed);
    const Camera source = reference::camera(c.lens, c.size, c.focal, c.centre.u, c.centre.v);
    const Undistorter undistorter = undistorter_for(source, c.view);
    if (!is_in_front(c, undistorter.output())) continue;
    const PlaceFunction place_of = place_function(c, source, undistorter.output());
    for (std::size_t i = seed % 3; i < kLayouts.size(); i += 3) {
      const NamedLayout& named = kLayouts[i];
      SCOPED_TRACE(text_of(seed, c, named));
      const Comparison result =
          compare(c.lens, c.size, place_of, named, undistort(undistorter, i), 3, kNearFold);
      EXPECT_LE(result.worst, 1);
      EXPECT_LE(result.sum, result.valid * (63.75 / named.max + 0.26));
      EXPECT_EQ(result.wrong_fill, 0);
      EXPECT_EQ(result.bytes_harmed, 0);
      ++compared;
    }
  }
  EXPECT_GT(compared, static_cast<int>(2 * cases));
}

}  // namespace
}  // namespace calvin
