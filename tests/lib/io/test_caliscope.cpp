// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs in the files of caliscope, aniposelib, and of Kalibr with an inertial unit.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin_config.h"
#include "rig_files.hpp"

namespace calvin {
namespace {

using test::expect_same;
using test::random_rig;
using test::with;

class Caliscope : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  }
};

constexpr char kArray[] = R"([cameras.10]
cam_id = 10
size = [1280, 720]
rotation_count = 0
error = 0.541
matrix = [[903.55, 0.0, 618.5], [0.0, 907.875, 394.25], [0.0, 0.0, 1.0]]
distortions = [-0.33, 0.046, -0.0043, 0.0041, 0.0666]
translation = [0.1, -0.2, 0.7]
rotation = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]

[cameras.2]
cam_id = 2
size = [640, 480]
exposure = "null"
matrix = [[260.0, 0.0, 322.0], [0.0, 261.0, 238.0], [0.0, 0.0, 1.0]]
distortions = [-0.02, 0.005, -0.003, 0.0005]
translation = [-0.2, 0.0, 1.9]
rotation = [0.0, 0.0, 1.5707963267948966]
fisheye = true

[cameras.3]
cam_id = 3
size = [640, 480]
matrix = [[260.0, 0.0, 322.0], [0.0, 261.0, 238.0], [0.0, 0.0, 1.0]]
distortions = [0.0, 0.0, 0.0, 0.0, 0.0]
ignore = true
)";

TEST_F(Caliscope, CamerasAreReadAsTheyAreMeant) {
  EXPECT_TRUE(is_rig(kArray));
  const auto rig = parse_rig(kArray);
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 2U);  // one was taken out
  EXPECT_EQ(rig->cameras[0].calibration.camera, "cam_2");
  EXPECT_EQ(rig->cameras[1].calibration.camera, "cam_10");
  EXPECT_EQ(rig->world, kReferenceWorld);
  EXPECT_EQ(rig->cameras[0].calibration.model, "fisheye");
  // World to camera: a quarter turn about z, as a vector and as a matrix.
  const Eigen::Vector3d world(0.1, -0.3, 0.2);
  const Eigen::Vector3d turned(0.3, 0.1, 0.2);
  const auto seen_by = [&](std::size_t n) -> Eigen::Vector3d {
    return to_se3(rig->cameras[n].rig_from_camera).inverse() * world;
  };
  EXPECT_LT((seen_by(0) - turned - Eigen::Vector3d(-0.2, 0, 1.9)).norm(), 1e-12);
  EXPECT_LT((seen_by(1) - turned - Eigen::Vector3d(0.1, -0.2, 0.7)).norm(), 1e-12);
  const auto at = Camera::make(rig->cameras[1].calibration)->project(seen_by(1));
  const Eigen::Vector2d p = seen_by(1).hnormalized();
  const Pixel expected =
      test::brown(p.x(), p.y(),
                  {903.55, 907.875, 618.5, 394.25, -0.33, 0.046, -0.0043, 0.0041, 0.0666, 0, 0, 0});
  EXPECT_NEAR(at.value().u, expected.u, 1e-9);
  EXPECT_NEAR(at.value().v, expected.v, 1e-9);
}

// aniposelib's calibration.toml, as caliscope exports it, too.
TEST_F(Caliscope, AniposelibsCamerasHaveNames) {
  const std::string text = R"([cam_0]
name = "front"
size = [1280, 720]
matrix = [[903.5, 0.0, 618.3], [0.0, 907.8, 394.2], [0.0, 0.0, 1.0]]
distortions = [-0.332, 0.046, -0.004, 0.004, 0.066]
rotation = [1.234, -0.567, 0.89]
translation = [0.171, -0.032, 1.208]

[metadata]
adjusted = false
error = 0.0
)";
  const auto rig = parse_rig(text);
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 1U);
  EXPECT_EQ(rig->cameras[0].calibration.camera, "front");
  // One camera is a calibration too.
  const auto one = parse_calibration(text);
  ASSERT_TRUE(one.has_value()) << one.error().message;
  EXPECT_EQ(one->camera, "front");
  EXPECT_NE(parse_calibration(kArray).error().message.find("2 cameras"), std::string::npos);
}

TEST_F(Caliscope, ReadsBackAsTheSameRig) {
  const Rig rig =
      random_rig({"brown4", "brown5", "rational8", "thinprism12", "tilted14", "fisheye"}, 5);
  const auto text = print_rig(rig, "caliscope");
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto read = parse_rig(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message << *text;
  EXPECT_EQ(read->cameras[2].calibration.camera, "the rational8");
  expect_same(rig, *read);
  // Names that caliscope gives are numbers of its own.
  Rig own = random_rig({"brown4", "brown5"}, 6);
  own.cameras[0].calibration.camera = "cam_7";
  own.cameras[1].calibration.camera = "cam_3";
  const std::string printed = print_rig(own, "caliscope").value();
  EXPECT_NE(printed.find("[cameras.7]\ncam_id = 7\n"), std::string::npos) << printed;
  EXPECT_NE(printed.find("[cameras.3]\ncam_id = 3\n"), std::string::npos);
}

// The two files that one version of caliscope wrote of four cameras hold the same rig.
TEST_F(Caliscope, RealFilesOfFourCamerasAgree) {
  const char* data = std::getenv("CALVIN_DATA");
  const std::string folder = std::string(data == nullptr ? "" : data) + "/charuco-caliscope-4cam/";
  if (!std::filesystem::exists(folder + "camera_array.toml")) {
    GTEST_SKIP() << "no charuco-caliscope-4cam in $CALVIN_DATA";
  }
  const auto array = read_rig(folder + "camera_array.toml");
  ASSERT_TRUE(array.has_value()) << array.error().message;
  const auto config = read_rig(folder + "config.toml");
  ASSERT_TRUE(config.has_value()) << config.error().message;
  ASSERT_EQ(array->cameras.size(), 4U);
  EXPECT_EQ(array->cameras[3].calibration.camera, "cam_3");
  EXPECT_EQ(config->cameras[3].calibration.camera, "cam_3");
  expect_same(*array, *config);
  // The cameras stand where calvin-rig finds them by the ChArUco board in the videos (every second
  // frame, the intrinsics of this file; 1 sigma of 2 mm, and cameras that run freely): within a
  // percent of what they are apart.
  const Eigen::Vector3d found[] = {
      {-0.7676, -0.0434, 0.8455}, {-0.2548, -0.4493, 0.1773}, {0.2751, -0.3047, -0.1298}};
  const SE3 first_from_world = to_se3(array->cameras[0].rig_from_camera).inverse();
  for (std::size_t n = 0; n < 3; ++n) {
    const SE3 pose = first_from_world * to_se3(array->cameras[n + 1].rig_from_camera);
    EXPECT_LT((pose.translation - found[n]).norm(), 0.015) << n;
  }
}

TEST_F(Caliscope, SaysWhatIsWrong) {
  const std::pair<std::pair<const char*, const char*>, const char*> wrong[] = {
      {{"rotation = [0.0, 0.0, 1.57", "rotations = [0.0, 0.0, 1.57"},
       "'cameras.2.rotation' is missing: the camera was not placed yet"},
      {{"translation = [0.1", "translation = [1e9"}, "'cameras.10.translation' is out of range"},
      {{"translation = [0.1, -0.2, 0.7]", "translation = \"null\""}, "'cameras.10.translation'"},
      {{"[[0.0, -1.0, 0.0]", "[[0.0, -2.0, 0.0]"}, "a matrix, but of no rotation"},
      {{"[0.0, 907.875, 394.25], ", ""}, "'cameras.10.matrix' is not a matrix of 3x3"},
      {{"[903.55,", "[-903.55,"}, "'cameras.10.matrix' is wrong"},
      {{"-0.33, 0.046, -0.0043,", "-0.0043,"}, "'cameras.10.matrix' is wrong: there are 3"},
      {{"size = [1280, 720]", "size = [1280]"}, "'cameras.10.size'"},
      {{"cam_id = 10\n", "cam_id = 10\ncam_id = 10\n"}, "the TOML is broken in line 3"},
      {{"fisheye = true", "fisheye = maybe"}, "the TOML is broken in line"},
      {{"fisheye = true", "fisheye = 1"}, "'cameras.2.fisheye' is neither true nor false"},
  };
  for (const auto& [change, words] : wrong) {
    const auto read = parse_rig(with(kArray, change.first, change.second), "camera_array.toml");
    ASSERT_FALSE(read.has_value()) << words;
    EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find("'camera_array.toml' cannot be used"), std::string::npos);
  }
}

// camchain-imucam of a chain without T_cn_cnm1, as OpenVINS has it.
TEST_F(Caliscope, KalibrsCamerasAreJoinedByTheInertialUnit) {
  const std::string camera =
      "  camera_model: pinhole\n  intrinsics: [520, 518, 325, 236]\n  distortion_model: none\n"
      "  distortion_coeffs: []\n  resolution: [640, 480]\n";
  const std::string text = "cam0:\n" + camera +
                           "  T_cam_imu:\n  - [0, -1, 0, 0.1]\n  - [1, 0, 0, 0.2]\n"
                           "  - [0, 0, 1, 0.3]\n  - [0, 0, 0, 1]\ncam1:\n" +
                           camera +
                           "  T_imu_cam:\n  - [1, 0, 0, 0.5]\n  - [0, 1, 0, 0]\n"
                           "  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n";
  const auto rig = parse_rig(text);
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  // A point of the unit, in the frames of both.
  const Eigen::Vector3d in_cam0(-2 + 0.1, 1 + 0.2, 3 + 0.3);
  const Eigen::Vector3d in_cam1(1 - 0.5, 2, 3);
  EXPECT_LT((to_se3(rig->cameras[1].rig_from_camera).inverse() * in_cam0 - in_cam1).norm(), 1e-12);
  const auto neither = parse_rig(with(text, "T_imu_cam", "T_nothing"));
  ASSERT_FALSE(neither.has_value());
  EXPECT_NE(neither.error().message.find("cam1.T_cn_cnm1"), std::string::npos);
}

}  // namespace
}  // namespace calvin
