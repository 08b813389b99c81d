// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras and rigs in COLMAP's text models: pixels by the formulas of COLMAP.
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/camera_places.hpp"
#include "calvin/io/rig_io.hpp"
#include "rig_files.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

using test::expect_same;
using test::put;
using test::random_rig;
using test::with;

constexpr char kCameras[] = R"(# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 6
1 SIMPLE_RADIAL 640 480 520 320.5 240.5 -0.1
2 OPENCV 640 480 520 518 325.5 236.5 -0.28 0.09 0.0005 -0.0007
7 OPENCV_FISHEYE 640 480 260 261 322 238 -0.02 0.005 -0.003 0.0005
4 FULL_OPENCV 640 480 520 518 325.5 236.5 -0.28 0.09 0.0005 -0.0007 0.01 0.02 -0.01 0.001
5 FOV 640 480 300 301 320 240 0.9
6 RADIAL_FISHEYE 640 480 260 322 238 -0.02 0.005
)";
constexpr char kImages[] = R"(# Image list with two lines of data per image:
#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
#   POINTS2D[] as (X, Y, POINT3D_ID)
# Number of images: 7, mean observations per image: 1
1 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 1 P1180141.JPG
2362.39 248.498 58396 1784.7 268.254 59027 1784.7 268.254 -1
2 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 2 left/P1180142.JPG

3 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 7 wide angle.png

4 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 4 d

5 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 5 e

6 0.5 0.5 -0.5 0.5 0.1 -0.2 0.3 6 f

9 -1 0 0 0 0 0 0 1 again
)";

// By the formulas of COLMAP's sensor/models.h, with the corner of the picture at (0, 0): a pixel's
// centre is half a pixel from there.
TEST(Colmap, PicturesAreCamerasOfARig) {
  const TemporaryFolder folder;
  put(folder.path("cameras.txt"), kCameras);
  put(folder.path("images.txt"), kImages);
  const auto rig = read_rig(folder.path(""));
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 7U);
  EXPECT_FALSE(rig->is_metric);
  EXPECT_EQ(rig->world, "again");
  EXPECT_EQ(rig->cameras[1].calibration.camera, "left/P1180142.JPG");
  EXPECT_EQ(rig->cameras[2].calibration.camera, "wide angle.png");
  // COLMAP's Quaterniond(w, x, y, z), world to camera.
  const Eigen::Quaterniond q(0.5, 0.5, -0.5, 0.5);
  const double fov = 2 * std::tan(0.45);
  for (const double scale : {1.0, 0.3}) {
    const Eigen::Vector3d in_camera(0.3 * scale, -0.2 * scale, 1);
    const Eigen::Vector3d point = q.conjugate() * (in_camera - Eigen::Vector3d(0.1, -0.2, 0.3));
    const double x = in_camera.x();
    const double y = in_camera.y();
    const double r = std::hypot(x, y);
    const double by_fov = std::atan(r * fov) / (r * 0.9);
    const Pixel expected[] = {
        test::brown(x, y, {520, 520, 320.5, 240.5, -0.1, 0, 0, 0}),
        test::brown(x, y, {520, 518, 325.5, 236.5, -0.28, 0.09, 0.0005, -0.0007}),
        test::fisheye(x, y, {260, 261, 322, 238, -0.02, 0.005, -0.003, 0.0005}),
        test::brown(
            x, y, {520, 518, 325.5, 236.5, -0.28, 0.09, 0.0005, -0.0007, 0.01, 0.02, -0.01, 0.001}),
        {300 * x * by_fov + 320, 301 * y * by_fov + 240},
        test::fisheye(x, y, {260, 260, 322, 238, -0.02, 0.005, 0, 0}),
    };
    for (std::size_t n = 0; n < 6; ++n) {
      const Camera camera = Camera::make(rig->cameras[n].calibration).value();
      const auto at = camera.project(to_se3(rig->cameras[n].rig_from_camera).inverse() * point);
      ASSERT_TRUE(at.has_value()) << n;
      EXPECT_NEAR(at->u + 0.5, expected[n].u, 1e-9) << n;
      EXPECT_NEAR(at->v + 0.5, expected[n].v, 1e-9) << n;
    }
  }
}

TEST(Colmap, ReadsBackAsTheSameRig) {
  Rig rig = random_rig({"pinhole", "brown4", "brown5", "rational8", "fisheye", "fov"}, 2);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_rig(folder.path("c"), rig, "colmap").has_value());
  EXPECT_TRUE(std::filesystem::exists(folder.path("c/points3D.txt")));
  const auto read = read_rig(folder.path("c"));
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_TRUE(read->is_metric);
  EXPECT_EQ(read->cameras[1].calibration.camera, "the_brown4");
  expect_same(rig, *read);
  rig.is_metric = false;
  ASSERT_TRUE(write_rig(folder.path("c"), rig, "colmap").has_value());
  EXPECT_FALSE(read_rig(folder.path("c"))->is_metric);
}

// What takes known places of cameras takes the model.
TEST(Colmap, PicturesArePlacesOfCameras) {
  const Rig rig = random_rig({"brown4", "fisheye"}, 8);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_rig(folder.path("c"), rig, "colmap").has_value());
  const auto places = read_camera_places(folder.path("c"));
  ASSERT_TRUE(places.has_value()) << places.error().message;
  ASSERT_EQ(places->size(), 2U);
  EXPECT_EQ((*places)[1].camera, "the_fisheye");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR((*places)[1].place[k], rig.cameras[1].rig_from_camera.translation[k], 1e-12);
  }
  ASSERT_TRUE(write_rig(folder.path("rig.json"), rig).has_value());
  EXPECT_EQ(read_camera_places(folder.path("rig.json"))->size(), 2U);
}

TEST(Colmap, OneLineOfCamerasIsACalibration) {
  const std::string all = kCameras;
  const auto second = all.find("2 OPENCV");
  const std::string one = "# a comment\n\n" + all.substr(second, all.find('\n', second) - second);
  const auto read = parse_calibration(one);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->model, "brown4");
  EXPECT_EQ(read->find("cx")->value, 325);
  EXPECT_EQ(read->find("p2")->value, -0.0007);
  const auto several = parse_calibration(all);
  ASSERT_FALSE(several.has_value());
  EXPECT_NE(several.error().message.find("6 cameras"), std::string::npos);
  EXPECT_NE(parse_rig(all).error().message.find("give the folder"), std::string::npos);
}

// Likewise.
TEST(Colmap, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const test::BrokenText of_cameras[] = {
      {"1 SIMPLE_RADIAL", "x SIMPLE_RADIAL", "cameras.txt, line 4: it is not 'CAMERA_ID MODEL"},
      {"SIMPLE_RADIAL", "DIVISION", "line 4: no camera model here is like DIVISION"},
      {"520 320.5 240.5 -0.1", "520 320.5 240.5", "SIMPLE_RADIAL has a width, a height and 4"},
      {"520 320.5 240.5 -0.1", "520 320.5 240.5 nan", "SIMPLE_RADIAL has a width"},
      {"2 OPENCV", "1 OPENCV", "line 5: an earlier line has that camera"},
      {"1 SIMPLE_RADIAL 640 480 520", "1 SIMPLE_RADIAL 640 480 -520", "cameras.txt, line 4: "},
  };
  put(folder.path("c/images.txt"), kImages);
  test::expect_broken(folder.path("c/cameras.txt"), kCameras, of_cameras);
  const test::BrokenText of_images[] = {
      {"1 0.5 0.5", "1 0.5", "images.txt, line 5: "},
      {"1 0.5 0.5", "1 0.9 0.5", "no quaternion of length 1"},
      {"0.3 1 P", "0.3 3 P", "cameras.txt has no camera 3"},
      {"0.1 -0.2 0.3 1 P", "1e9 -0.2 0.3 1 P", "TX TY TZ is out of range"},
      {"4 d", "4 e", "images.txt has 'e' twice"},
  };
  put(folder.path("c/cameras.txt"), kCameras);
  test::expect_broken(folder.path("c/images.txt"), kImages, of_images);
  put(folder.path("c/images.txt"), "# nothing\n");
  EXPECT_NE(read_rig(folder.path("c")).error().message.find("images.txt has no picture"),
            std::string::npos);
  std::filesystem::remove(folder.path("c/cameras.txt"));
  EXPECT_EQ(read_rig(folder.path("c")).error().code, ErrorCode::kNotFound);
  std::filesystem::create_directories(folder.path("empty"));
  const auto empty = read_rig(folder.path("empty"));
  EXPECT_NE(empty.error().message.find("*.cameramodel"), std::string::npos)
      << empty.error().message;
  EXPECT_NE(empty.error().message.find("Give a file"), std::string::npos);
}

}  // namespace
}  // namespace calvin
