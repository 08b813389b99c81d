// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rectified views of stereo pairs: what both see lies in one row, as far apart as its distance
// says.
#include <cmath>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/rig/stereo.hpp"
#include "calvin/synth/render.hpp"
#include "rectified_pair.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;
using scenes::rectifier;
using scenes::rig_of;
using scenes::uniform;

// Two cameras of one size, up to 8 degrees turned to each other.
Rig random_pair(Random& random, bool is_vertical) {
  const char* model = uniform(random, 0, 1) < 0.3 ? "fisheye" : "brown5";
  const Camera first = scenes::random_camera(model, random);
  const Camera second = scenes::random_camera(model, random);
  const auto little = [&](double most) { return uniform(random, -most, most); };
  Eigen::Vector3d place(uniform(random, 0.05, 0.3), little(0.01), little(0.01));
  if (is_vertical) std::swap(place.x(), place.y());
  if (uniform(random, 0, 1) < 0.5) place = -place;
  return rig_of(first, second, {exp_so3({little(0.08), little(0.08), little(0.08)}), place});
}

Pixel pixel_of(const Undistorter& rectified, const Camera& camera, const SE3& camera_from_rig,
               const Eigen::Vector3d& point) {
  const auto seen = camera.project(camera_from_rig * point);
  const auto place = seen ? rectified.to_output(*seen) : std::nullopt;
  return place.value_or(Pixel{NAN, NAN});
}

class Pairs : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Rectification, Pairs, ::testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "OneAboveTheOther" : "SideBySide");
});

TEST_P(Pairs, SeeAPointInOneRow) {
  const bool is_vertical = GetParam();
  int points = 0;
  for (std::uint64_t trial = 0; trial < 30; ++trial) {
    Random random(trial);
    const Rig rig = random_pair(random, is_vertical);
    ViewOptions options;
    options.alpha = uniform(random, 0, 1);
    const StereoPair pair = stereo_pair(rig).value();
    EXPECT_EQ(pair.is_vertical, is_vertical);
    const auto left = rectifier(rig, StereoSide::kLeft, options);
    const auto right = rectifier(rig, StereoSide::kRight, options);
    ASSERT_TRUE(left && right) << trial;
    const SE3 left_from_rig = to_se3(rig.cameras[pair.left].rig_from_camera).inverse();
    const SE3 right_from_rig = to_se3(rig.cameras[pair.right].rig_from_camera).inverse();
    const double baseline = (left_from_rig * right_from_rig.inverse()).translation.norm();
    for (int n = 0; n < 200; ++n) {
      const double z = uniform(random, 0.5, 5);
      const Eigen::Vector3d point(uniform(random, -z, z), uniform(random, -z, z), z);
      Pixel a = pixel_of(*left, left->source(), left_from_rig, point);
      Pixel b = pixel_of(*right, right->source(), right_from_rig, point);
      if (!std::isfinite(a.u + b.u)) continue;
      if (is_vertical) {
        std::swap(a.u, a.v);
        std::swap(b.u, b.v);
      }
      ++points;
      EXPECT_NEAR(a.v, b.v, 1e-6) << trial;
      const double focal = is_vertical ? left->output().fy() : left->output().fx();
      const double depth = (pair.left_from_rectified.transpose() * (left_from_rig * point)).z();
      EXPECT_NEAR(a.u - b.u, focal * baseline / depth, 1e-6 * focal) << trial;
    }
  }
  EXPECT_GT(points, 1000);
}

TEST_P(Pairs, HaveOnePlaneWhicheverElementAsks) {
  for (std::uint64_t trial = 0; trial < 10; ++trial) {
    Random random(100 + trial);
    const Rig rig = random_pair(random, GetParam());
    for (const ImageSize frames : {scenes::kSize, ImageSize{641, 481}, ImageSize{1920, 1440}}) {
      const auto left = rectifier(rig, StereoSide::kLeft, {}, frames);
      const auto right = rectifier(rig, StereoSide::kRight, {}, frames);
      ASSERT_TRUE(left && right);
      EXPECT_EQ(left->output().parameters(), right->output().parameters());
      EXPECT_EQ(left->output().image_size(), frames);
    }
    Rig swapped = rig;
    std::swap(swapped.cameras[0], swapped.cameras[1]);
    EXPECT_EQ(camera_of_side(rig, StereoSide::kLeft).value(),
              1 - camera_of_side(swapped, StereoSide::kLeft).value());
  }
}

// The pixels at the border of a picture.
std::vector<Pixel> border_of(ImageSize size) {
  std::vector<Pixel> pixels;
  for (int x = 0; x < size.width; ++x) {
    pixels.push_back({0.0 + x, 0});
    pixels.push_back({0.0 + x, size.height - 1.0});
  }
  for (int y = 0; y < size.height; ++y) {
    pixels.push_back({0, 0.0 + y});
    pixels.push_back({size.width - 1.0, 0.0 + y});
  }
  return pixels;
}

bool is_within(const std::optional<Pixel>& pixel, ImageSize size) {
  constexpr double kSlack = 0.01;
  return pixel && pixel->u >= -kSlack && pixel->v >= -kSlack &&
         pixel->u <= size.width - 1 + kSlack && pixel->v <= size.height - 1 + kSlack;
}

TEST_P(Pairs, ShowWhatAlphaSaysOfBoth) {
  for (std::uint64_t trial = 0; trial < 10; ++trial) {
    Random random(200 + trial);
    const Rig rig = random_pair(random, GetParam());
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      ViewOptions options;
      const auto filled = rectifier(rig, side, options);
      ASSERT_TRUE(filled.has_value());
      for (const Pixel& pixel : border_of(filled->output().image_size())) {
        ASSERT_TRUE(is_within(filled->to_source(pixel), filled->source().image_size())) << trial;
      }
      options.alpha = 1;
      const auto all = rectifier(rig, side, options);
      ASSERT_TRUE(all.has_value());
      if (all->limited()) continue;
      for (const Pixel& pixel : border_of(all->source().image_size())) {
        if (!all->source().unproject(pixel)) continue;
        ASSERT_TRUE(is_within(all->to_output(pixel), all->output().image_size())) << trial;
      }
    }
  }
}

// Boards in rendered pictures, which the rig is solved from; their corners are found again in the
// rectified pictures.
TEST(Rectification, PutsFoundCornersOfRenderedPicturesIntoOneRow) {
  const int rigs = scenes::full_count() ? 20 : 3;
  constexpr int kInstants = 14;
  double squares = 0;
  int corners = 0;
  const auto detector = make_detector(scenes::kBoard).value();
  const auto found_in = [&](const GrayImage& image) {
    return detector->detect({image.pixels.data(), image.width, image.height, image.width, 1})
        .observation;
  };
  for (int trial = 0; trial < rigs; ++trial) {
    Random random(300 + static_cast<std::uint64_t>(trial));
    const scenes::SimulatedRig simulated = scenes::stereo_rig(random);
    std::vector<RigCameraViews> seen(2);
    std::vector<std::vector<GrayImage>> pictures(2);
    for (std::size_t c = 0; c < 2; ++c) {
      seen[c].calibration = simulated.cameras[c].to_calibration();
      seen[c].calibration.camera = c == 0 ? "left" : "right";
    }
    for (int n = 0; n < kInstants; ++n) {
      const SE3 world_from_board = scenes::held_board(simulated, 0.6, random);
      for (std::size_t c = 0; c < 2; ++c) {
        RenderOptions options;
        options.noise = 4;
        options.seed = static_cast<std::uint64_t>(100 * trial + 2 * n) + c;
        const SE3 pose = simulated.world_from_camera[c].inverse() * world_from_board;
        pictures[c].push_back(render_board(simulated.cameras[c], simulated.board, pose, options));
        Observation observation = found_in(pictures[c].back());
        observation.timestamp = static_cast<std::uint64_t>(n) * 1'000'000'000;
        if (observation.found()) seen[c].views.push_back({observation, simulated.board});
      }
    }
    const auto solved = solve_rig(seen);
    ASSERT_TRUE(solved.has_value()) << solved.error().message;
    EXPECT_LT(solved->links[0].epipolar_error.value(), 0.1);
    std::vector<Undistorter> rectified = {rectifier(solved->rig, StereoSide::kLeft).value(),
                                          rectifier(solved->rig, StereoSide::kRight).value()};
    for (std::size_t n = 0; n < kInstants; ++n) {
      std::vector<Observation> found;
      for (std::size_t c = 0; c < 2; ++c) {
        GrayImage straight(scenes::kSize.width, scenes::kSize.height);
        const GrayImage& picture = pictures[c][n];
        rectified[c].apply(0, {picture.pixels.data(), picture.width},
                           {straight.pixels.data(), straight.width});
        found.push_back(found_in(straight));
      }
      // A board with an odd and an even side: labels are those of the board where all of it is
      // seen.
      if (!found[0].ambiguous.empty() || !found[1].ambiguous.empty()) continue;
      for (std::size_t i = 0; i < found[0].ids.size(); ++i) {
        for (std::size_t j = 0; j < found[1].ids.size(); ++j) {
          if (found[0].ids[i] != found[1].ids[j]) continue;
          squares += std::pow(found[0].uv[i].v - found[1].uv[j].v, 2);
          ++corners;
        }
      }
    }
  }
  const double rms = std::sqrt(squares / corners);
  std::cout << corners << " corners, rows differ by " << rms << " px rms\n";
  ASSERT_GT(corners, 300 * rigs);
  EXPECT_LT(rms, 0.15);
}

// Turned away from each other by so many rad.
SE3 side_by_side(double angle) {
  return {exp_so3({0, angle, 0}), exp_so3({0, angle / 2, 0}) * Eigen::Vector3d(0.2, 0, 0)};
}

struct Refusal {
  const char* name;
  SE3 first_from_second;
  const char* word;
};
const Refusal kRefusals[] = {
    {"InOnePlace", {exp_so3({0, 0.1, 0}), {0, 0, 0}}, "one place"},
    {"OneBeforeTheOther", {Eigen::Matrix3d::Identity(), {0.01, 0, 0.2}}, "before the other"},
    {"BackToBack", side_by_side(3.0), "different directions"},
    {"NothingInCommon", side_by_side(1.6), "nothing in common"},
};
class Refused : public ::testing::TestWithParam<Refusal> {};
INSTANTIATE_TEST_SUITE_P(Rectification, Refused, ::testing::ValuesIn(kRefusals),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_P(Refused, WithTheReason) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  const Rig rig = rig_of(camera, camera, GetParam().first_from_second);
  const auto made = rectifier(rig, StereoSide::kLeft);
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(made.error().message.find(GetParam().word), std::string::npos) << made.error().message;
}

TEST(Rectification, IsOfTwoCamerasAndRectilinear) {
  const Camera camera = Camera::make("pinhole", {640, 480}, {600, 600, 319.5, 239.5}).value();
  Rig rig = rig_of(camera, camera, {Eigen::Matrix3d::Identity(), {0.1, 0, 0}});
  ViewOptions options;
  options.projection = Projection::kCylindrical;
  const auto bent = rectifier(rig, StereoSide::kLeft, options);
  ASSERT_FALSE(bent.has_value());
  EXPECT_NE(bent.error().message.find("projection=rectilinear"), std::string::npos);
  rig.cameras.push_back(rig.cameras[1]);
  const auto three = rectifier(rig, StereoSide::kLeft);
  ASSERT_FALSE(three.has_value());
  EXPECT_NE(three.error().message.find("has 3"), std::string::npos);
}

}  // namespace
}  // namespace calvin
