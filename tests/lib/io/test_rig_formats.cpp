// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs in the files of other programs: Kalibr's camchain, OpenCV's stereo parameters, ROS.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/stereo_io.hpp"
#include "calvin/remap/rectification.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"
#include "rectified_pair.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

class RigFormats : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  }
};

// As Kalibr writes it, of two cameras of a stereo pair and a wide one behind them.
constexpr char kCamchain[] = R"(cam0:
  cam_overlaps: [1, 2]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.09, 0.0005, -0.0007]
  distortion_model: radtan
  intrinsics: [520.0, 518.0, 325.0, 236.0]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
cam1:
  T_cn_cnm1:
  - [0.0, -1.0, 0.0, 0.01]
  - [1.0, 0.0, 0.0, 0.02]
  - [0.0, 0.0, 1.0, 0.03]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0, 2]
  camera_model: pinhole
  distortion_coeffs: [-0.02, 0.005, -0.003, 0.0005]
  distortion_model: equidistant
  intrinsics: [260.0, 261.0, 322.0, 238.0]
  resolution: [640, 480]
  rostopic: /cam1/image_raw
cam2:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, 0.5]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  cam_overlaps: [0, 1]
  camera_model: omni
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [1.5, 800.0, 801.0, 400.0, 300.0]
  resolution: [800, 600]
  rostopic: /cam2/image_raw
)";

TEST_F(RigFormats, KalibrsCamchainIsReadAsItIsMeant) {
  const auto rig = parse_rig(kCamchain);
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 3U);
  EXPECT_TRUE(is_rig(kCamchain));
  EXPECT_EQ(rig->world, "cam0");
  EXPECT_EQ(rig->cameras[0].calibration.model, "brown4");
  EXPECT_EQ(rig->cameras[0].calibration.find("p2")->value, -0.0007);
  EXPECT_EQ(rig->cameras[1].calibration.model, "fisheye");
  EXPECT_EQ(rig->cameras[1].calibration.find("k4")->value, 0.0005);
  // A point of cam0 in the frames of the others, by the matrices.
  const Eigen::Vector3d point(0.1, 0.2, 2);
  const Eigen::Vector3d in_cam1(0.01 - 0.2, 0.02 + 0.1, 2.03);
  const Eigen::Vector3d in_cam2 = in_cam1 + Eigen::Vector3d(0.5, 0, 0);
  const auto seen_by = [&](std::size_t n) -> Eigen::Vector3d {
    return to_se3(rig->cameras[n].rig_from_camera).inverse() * point;
  };
  EXPECT_LT((seen_by(1) - in_cam1).norm(), 1e-12);
  EXPECT_LT((seen_by(2) - in_cam2).norm(), 1e-12);
  // C. Mei: onto the unit sphere, then from a centre that is xi behind its middle.
  const Eigen::Vector3d ray = in_cam2.normalized();
  const auto pixel = Camera::make(rig->cameras[2].calibration)->project(in_cam2);
  EXPECT_NEAR(pixel.value().u, 800 * ray.x() / (ray.z() + 1.5) + 400, 1e-9);
  EXPECT_NEAR(pixel.value().v, 801 * ray.y() / (ray.z() + 1.5) + 300, 1e-9);
}

TEST_F(RigFormats, KalibrsCamchainOfOneCameraIsACalibration) {
  const std::string chain = kCamchain;
  const std::string one = chain.substr(0, chain.find("cam1:"));
  EXPECT_FALSE(is_rig(one));
  const auto calibration = parse_calibration(one);
  ASSERT_TRUE(calibration.has_value()) << calibration.error().message;
  EXPECT_EQ(calibration->camera, "cam0");
  EXPECT_EQ(calibration->image_size, (ImageSize{640, 480}));
  const auto several = parse_calibration(kCamchain);
  ASSERT_FALSE(several.has_value());
  EXPECT_NE(several.error().message.find("3 cameras"), std::string::npos);
}

// Every model that Kalibr has, in one chain.
TEST_F(RigFormats, KalibrsCamchainReadsBackAsTheSameCameras) {
  scenes::Random random(7);
  Rig rig;
  for (const char* model : {"pinhole", "brown4", "fisheye", "fov", "ucm", "eucm", "doublesphere"}) {
    RigCamera camera;
    camera.calibration = scenes::random_camera(model, random).to_calibration();
    const auto some = [&] { return scenes::uniform(random, -1, 1); };
    camera.rig_from_camera = to_pose({exp_so3({some(), some(), some()}), {some(), some(), some()}});
    if (rig.cameras.empty()) camera.rig_from_camera = {};
    rig.cameras.push_back(camera);
  }
  for (RigCamera& camera : rig.cameras) {
    camera.calibration.camera = "to the " + std::string(camera.calibration.model);
  }
  const auto text = print_rig(rig, "kalibr");
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto read = parse_rig(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message << *text;
  ASSERT_EQ(read->cameras.size(), rig.cameras.size());
  for (std::size_t n = 0; n < rig.cameras.size(); ++n) {
    const Camera before = Camera::make(rig.cameras[n].calibration).value();
    const Camera after = Camera::make(read->cameras[n].calibration).value();
    EXPECT_EQ(after.model(), before.model());
    EXPECT_EQ(read->cameras[n].calibration.camera, rig.cameras[n].calibration.camera);
    for (std::size_t i = 0; i < before.parameters().size(); ++i) {
      EXPECT_NEAR(after.parameters()[i], before.parameters()[i], 1e-12 * 2000) << after.model();
    }
    const SE3 moved =
        to_se3(rig.cameras[n].rig_from_camera).inverse() * to_se3(read->cameras[n].rig_from_camera);
    EXPECT_LT(log_so3(moved.rotation).norm() + moved.translation.norm(), 1e-12) << n;
  }
}

// brown5 has a k3, which Kalibr's radtan lacks; one of 0 is none.
TEST_F(RigFormats, KalibrHoldsABrownLensWithoutK3) {
  Calibration calibration = test::sample("brown5");
  EXPECT_EQ(print_calibration(calibration, "kalibr").error().code, ErrorCode::kUnsupported);
  EXPECT_FALSE(can_hold("kalibr", "brown5").has_value());
  EXPECT_TRUE(can_hold("kalibr", "brown4").has_value());
  for (Parameter& p : calibration.parameters) {
    if (p.name == "k3") p.value = 0;
  }
  const auto text = print_calibration(calibration, "kalibr");
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto read = parse_calibration(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->model, "brown4");
  EXPECT_EQ(read->image_size, calibration.image_size);
  for (const char* name : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}) {
    EXPECT_EQ(read->find(name)->value, calibration.find(name)->value) << name;
  }
}

TEST_F(RigFormats, WhatKalibrHasNotIsRefused) {
  const auto refusal = [](Rig rig) { return print_rig(rig, "kalibr").error().message; };
  scenes::Random random(8);
  const Camera brown5 = scenes::random_camera("brown5", random);
  EXPECT_NE(refusal(scenes::rig_of(brown5, brown5, {})).find("brown5"), std::string::npos);
  const Camera skewed = Camera::make("pinhole", {640, 480}, {500, 500, 319.5, 239.5}, 0.3).value();
  EXPECT_NE(refusal(scenes::rig_of(skewed, skewed, {})).find("skew"), std::string::npos);
  EXPECT_EQ(print_rig({}, "ply").error().code, ErrorCode::kInvalidArgument);
}

// A chain with one thing changed, and a word of what is said.
TEST_F(RigFormats, SayWhatIsWrong) {
  const std::string good = kCamchain;
  const std::pair<std::pair<const char*, const char*>, const char*> wrong[] = {
      {{"equidistant", "radtan8"}, "cam1.camera_model"},
      {{"[260.0, 261.0, 322.0, 238.0]", "[260.0, 261.0]"}, "cam1.intrinsics"},
      {{"[260.0,", "[-1.0,"}, "cam1.intrinsics"},
      {{"- [0.0, -1.0, 0.0, 0.01]", "- [0.0, -2.0, 0.0, 0.01]"}, "cam1.T_cn_cnm1"},
      {{"  - [0.0, -1.0, 0.0, 0.01]\n", ""}, "cam1.T_cn_cnm1"},
      {{"resolution: [800, 600]", "resolution: [0, 600]"}, "cam2.intrinsics"},
      {{"[-0.28, 0.09, 0.0005, -0.0007]", "[-0.28]"}, "cam0.distortion_coeffs"},
  };
  for (const auto& [change, word] : wrong) {
    std::string text = good;
    const auto at = text.find(change.first);
    ASSERT_NE(at, std::string::npos) << change.first;
    text.replace(at, std::string(change.first).size(), change.second);
    const auto read = parse_rig(text);
    ASSERT_FALSE(read.has_value()) << word;
    EXPECT_NE(read.error().message.find(word), std::string::npos) << read.error().message;
  }
}

// ---- Stereo -------------------------------------------------------------------------------------

Rig stereo(bool is_vertical, const char* model = "brown5") {
  scenes::Random random(11);
  const Camera first = scenes::random_camera(model, random);
  const Camera second = scenes::random_camera(model, random);
  Eigen::Vector3d place(0.12, 0.003, -0.004);
  if (is_vertical) std::swap(place.x(), place.y());
  return scenes::rig_of(first, second, {exp_so3({0.02, -0.03, 0.01}), place});
}

TEST_F(RigFormats, OpenCvsStereoParametersReadBackAsTheSamePair) {
  for (const char* model : {"brown5", "fisheye"}) {
    const Rig rig = stereo(false, model);
    const auto text = print_opencv_stereo(rig, rectified_pair(rig).value());
    ASSERT_TRUE(text.has_value()) << text.error().message;
    const auto read = parse_rig(*text);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    ASSERT_EQ(read->cameras.size(), 2U);
    for (std::size_t n = 0; n < 2; ++n) {
      EXPECT_EQ(Camera::make(read->cameras[n].calibration)->parameters(),
                Camera::make(rig.cameras[n].calibration)->parameters());
      const SE3 moved = to_se3(rig.cameras[n].rig_from_camera).inverse() *
                        to_se3(read->cameras[n].rig_from_camera);
      EXPECT_LT(log_so3(moved.rotation).norm() + moved.translation.norm(), 1e-9);
    }
    // A program that takes one camera gets the first one, as before.
    EXPECT_FALSE(is_rig(*text));
    EXPECT_TRUE(parse_calibration(*text).has_value());
  }
}

// The numbers of one matrix in YAML.
std::vector<double> matrix_of(const std::string& text, const std::string& name) {
  const auto at = text.find("data: [", text.find(name + ":"));
  std::vector<double> values;
  const char* next = text.c_str() + at + 7;
  for (char* end = nullptr; *next != ']'; next = *end == ',' ? end + 1 : end) {
    values.push_back(std::strtod(next, &end));
    while (*end == ' ') ++end;
  }
  return values;
}

// What users do with these: P takes a point of the rectified left camera to px of each picture, Q
// takes px and disparity back.
TEST_F(RigFormats, ProjectionsOfAStereoPairAreThoseOfItsPictures) {
  for (const bool is_vertical : {false, true}) {
    const Rig rig = stereo(is_vertical);
    const RectifiedPair pair = rectified_pair(rig).value();
    const std::string opencv = print_opencv_stereo(rig, pair).value();
    const auto q = matrix_of(opencv, "\nQ");
    const auto r1 = matrix_of(opencv, "\nR1");
    const SE3 left_from_rig = to_se3(rig.cameras[pair.left].rig_from_camera).inverse();
    const SE3 right_from_rig = to_se3(rig.cameras[pair.right].rig_from_camera).inverse();
    const Undistorter left = scenes::rectifier(rig, StereoSide::kLeft).value();
    const Undistorter right = scenes::rectifier(rig, StereoSide::kRight).value();
    const Eigen::Vector3d point(0.05, 0.08, 1.4);
    const Pixel u = left.to_output(left.source().project(left_from_rig * point).value()).value();
    const Pixel v = right.to_output(right.source().project(right_from_rig * point).value()).value();
    const Eigen::Vector3d own =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r1.data()) *
        (left_from_rig * point);
    for (const bool is_left : {true, false}) {
      const auto p = matrix_of(opencv, is_left ? "\nP1" : "\nP2");
      const auto ros = matrix_of(print_ros_stereo(rig, pair, is_left).value(), "projection_matrix");
      EXPECT_EQ(p, ros);
      const Eigen::Vector3d h =
          Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(p.data()) *
          own.homogeneous();
      EXPECT_NEAR(h.x() / h.z(), is_left ? u.u : v.u, 1e-6);
      EXPECT_NEAR(h.y() / h.z(), is_left ? u.v : v.v, 1e-6);
    }
    const double disparity = is_vertical ? u.v - v.v : u.u - v.u;
    EXPECT_GT(disparity, 1);
    const Eigen::Vector4d back =
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(q.data()) *
        Eigen::Vector4d(u.u, u.v, disparity, 1);
    EXPECT_LT((back.hnormalized() - own).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace calvin
