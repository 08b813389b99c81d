// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A stereo pair in the two files of OpenCV's sample stereo_calib, against cv::FileStorage.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "calvin/core/file.hpp"
#include "calvin/draw/scene/scene.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/remap/rectification.hpp"
#include "calvin/session/rig/rig_exports.hpp"
#include "calvin_config.h"
#include "rectified_pair.hpp"
#include "simulated_rig.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

class OpenCvStereo : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  }
  TemporaryFolder folder;
};

const cv::Matx33d kLeft(534, 0, 342, 0, 533, 235, 0, 0, 1);
const cv::Matx33d kRight(537, 0, 326, 0, 536, 250, 0, 0, 1);
const std::vector<double> kLeftBends = {-0.288, 0.097, 0.001, -0.0003, 0.01};
const std::vector<double> kRightBends = {-0.289, 0.107, -0.0006, 0.0001, -0.02};
const cv::Vec3d kTurn(0.007, 0.0045, -0.0035);
const cv::Vec3d kShift(-0.0998, 0.0011, 0.00005);

// As the sample leaves them: without the size of the pictures.
void write_intrinsics(const std::string& path) {
  cv::FileStorage file(path, cv::FileStorage::WRITE);
  file << "M1" << cv::Mat(kLeft) << "D1" << cv::Mat(kLeftBends).t();
  file << "M2" << cv::Mat(kRight) << "D2" << cv::Mat(kRightBends).t();
}
void write_extrinsics(const std::string& path, const cv::Vec3d& turn, const cv::Vec3d& shift) {
  cv::Mat r;
  cv::Rodrigues(cv::Mat(turn), r);
  const cv::Mat t(shift);
  cv::Mat r1;
  cv::Mat r2;
  cv::Mat p1;
  cv::Mat p2;
  cv::Mat q;
  cv::stereoRectify(kLeft, kLeftBends, kRight, kRightBends, {640, 480}, r, t, r1, r2, p1, p2, q);
  cv::FileStorage file(path, cv::FileStorage::WRITE);
  file << "R" << r << "T" << t << "R1" << r1 << "R2" << r2 << "P1" << p1 << "P2" << p2 << "Q" << q;
}

void expect_is_the_pair(const Result<Rig>& rig, const std::string& what) {
  ASSERT_TRUE(rig.has_value()) << what << ": " << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 2U) << what;
  const std::array<const std::vector<double>*, 2> bends = {&kLeftBends, &kRightBends};
  for (std::size_t c = 0; c < 2; ++c) {
    Calibration calibration = rig->cameras[c].calibration;
    EXPECT_EQ(calibration.image_size, ImageSize{}) << "nobody has said it";
    calibration.image_size = {640, 480};
    const Camera camera = Camera::make(calibration).value();
    for (const cv::Point3d& point : {cv::Point3d(0.2, -0.1, 1), cv::Point3d(-0.3, 0.25, 0.9)}) {
      std::vector<cv::Point2d> seen;
      cv::projectPoints(std::vector{point}, cv::Vec3d(), cv::Vec3d(), c == 0 ? kLeft : kRight,
                        *bends[c], seen);
      const Pixel own = camera.project({point.x, point.y, point.z}).value();
      EXPECT_NEAR(own.u, seen[0].x, 1e-9) << what;
      EXPECT_NEAR(own.v, seen[0].y, 1e-9) << what;
    }
  }
  const SE3 right_from_left =
      to_se3(rig->cameras[1].rig_from_camera).inverse() * to_se3(rig->cameras[0].rig_from_camera);
  EXPECT_LT(
      (log_so3(right_from_left.rotation) - Eigen::Vector3d(kTurn[0], kTurn[1], kTurn[2])).norm(),
      1e-9);
  EXPECT_LT((right_from_left.translation - Eigen::Vector3d(kShift[0], kShift[1], kShift[2])).norm(),
            1e-9);
}

TEST_F(OpenCvStereo, EitherOfTheTwoFilesIsThePair) {
  for (const char* extension : {"yml", "xml", "json"}) {
    const std::string intrinsics = folder.path(("intrinsics." + std::string(extension)).c_str());
    const std::string extrinsics = folder.path(("extrinsics." + std::string(extension)).c_str());
    write_intrinsics(intrinsics);
    write_extrinsics(extrinsics, kTurn, kShift);
    expect_is_the_pair(read_rig(intrinsics), intrinsics);
    expect_is_the_pair(read_rig(extrinsics), extrinsics);
    EXPECT_EQ(files_of_rig(extrinsics),
              (std::vector<std::filesystem::path>{extrinsics, intrinsics}));
  }
  expect_is_the_pair(read_rig(folder.path()), "the folder");
  EXPECT_TRUE(is_rig_folder(folder.path()));
}

TEST_F(OpenCvStereo, FilesOfAnyNamesAreNamedBoth) {
  write_intrinsics(folder.path("lenses.yml"));
  write_extrinsics(folder.path("where, they stand.yml"), kTurn, kShift);
  const std::string both = folder.path("lenses.yml") + "," + folder.path("where, they stand.yml");
  expect_is_the_pair(read_rig(both), both);
  expect_is_the_pair(
      read_rig(folder.path("where, they stand.yml") + "," + folder.path("lenses.yml")),
      "the other order");
  const auto setting = parse_camera_setting(both);
  ASSERT_TRUE(setting.has_value()) << setting.error().message;
  EXPECT_TRUE(std::holds_alternative<Rig>(*setting));
}

// The first file is a calibration too; the other one is none.
TEST_F(OpenCvStereo, SettingsTakeTheRigAndTheFirstCameraWhereThereIsOne) {
  write_intrinsics(folder.path("intrinsics.yml"));
  write_extrinsics(folder.path("extrinsics.yml"), kTurn, kShift);
  const auto places = parse_camera_setting(folder.path("extrinsics.yml"));
  ASSERT_TRUE(places.has_value()) << places.error().message;
  EXPECT_TRUE(std::holds_alternative<Rig>(*places));
  auto lens = parse_camera_setting(folder.path("intrinsics.yml"));
  ASSERT_TRUE(lens.has_value()) << lens.error().message;
  ASSERT_NE(one_camera_of(*lens), nullptr);
  EXPECT_EQ(one_camera_of(*lens)->find("cx")->value, 342);
  ASSERT_NE(rig_of(*lens), nullptr);
  expect_is_the_pair(*rig_of(*lens), "beside the other one");
}

// As calvin-rig writes it: the pair for whoever rectifies, the first camera for whoever does not.
TEST_F(OpenCvStereo, SettingsTakeOneFileAsAPairAndAsItsFirstCamera) {
  write_intrinsics(folder.path("intrinsics.json"));
  write_extrinsics(folder.path("extrinsics.json"), kTurn, kShift);
  Rig rig = read_rig(folder.path("intrinsics.json")).value();
  for (RigCamera& camera : rig.cameras) camera.calibration.image_size = {640, 480};
  const std::string file = folder.path("stereo.yml");
  ASSERT_TRUE(write_rig_export({"opencv", file}, rig).has_value());
  const std::string content = read_file(file, kMaxRigBytes).value();
  for (const std::string& text : {file, content}) {
    auto setting = parse_camera_setting(text);
    ASSERT_TRUE(setting.has_value()) << setting.error().message;
    ASSERT_NE(rig_of(*setting), nullptr) << text;
    EXPECT_EQ(print_rig(*rig_of(*setting)).value(), print_rig(read_rig(file).value()).value());
    ASSERT_NE(one_camera_of(*setting), nullptr) << text;
    EXPECT_EQ(one_camera_of(*setting)->find("cx")->value, 342);
  }
}

// Who has one camera needs no more than its lens; who has two is told what the file lacks.
TEST_F(OpenCvStereo, SettingsSayWhyAFileIsNoPair) {
  write_intrinsics(folder.path("intrinsics.yml"));
  auto setting = parse_camera_setting(folder.path("intrinsics.yml"));
  ASSERT_TRUE(setting.has_value()) << setting.error().message;
  EXPECT_NE(one_camera_of(*setting), nullptr);
  EXPECT_EQ(rig_of(*setting), nullptr);
  ASSERT_TRUE(std::holds_alternative<StereoFile>(*setting));
  const std::string message = std::get<StereoFile>(*setting).pair.error().message;
  EXPECT_NE(message.find("extrinsics.yml"), std::string::npos) << message;
}

TEST_F(OpenCvStereo, AHalfAloneSaysWhatIsMissing) {
  write_intrinsics(folder.path("intrinsics.yml"));
  write_extrinsics(folder.path("places.yml"), kTurn, kShift);
  const auto lenses = read_rig(folder.path("intrinsics.yml"));
  ASSERT_FALSE(lenses.has_value());
  EXPECT_NE(lenses.error().message.find("extrinsics.yml"), std::string::npos)
      << lenses.error().message;
  const auto places = read_rig(folder.path("places.yml"));
  ASSERT_FALSE(places.has_value());
  EXPECT_NE(places.error().message.find("M1 D1 M2 D2"), std::string::npos)
      << places.error().message;
  // Beside it lies another of its kind, or what is none at all.
  write_intrinsics(folder.path("extrinsics.yml"));
  EXPECT_FALSE(read_rig(folder.path("intrinsics.yml")).has_value());
  ASSERT_TRUE(write_file(folder.path("extrinsics.yml"), "%YAML:1.0\nR: [1").has_value());
  const auto broken = read_rig(folder.path("intrinsics.yml"));
  ASSERT_FALSE(broken.has_value());
  EXPECT_NE(broken.error().message.find("of the other one"), std::string::npos)
      << broken.error().message;
  ASSERT_TRUE(write_file(folder.path("extrinsics.yml"), "").has_value());
  EXPECT_FALSE(read_rig(folder.path("intrinsics.yml")).has_value());
}

// A whole rig beside which another file happens to lie is what it was.
TEST_F(OpenCvStereo, AWholeRigIsReadByItself) {
  scenes::Random random(4);
  const Camera camera = scenes::random_camera("brown5", random);
  const Rig rig = scenes::rig_of(camera, camera, {exp_so3({0, 0.1, 0}), {0.2, 0, 0}});
  ASSERT_TRUE(write_rig(folder.path("intrinsics.json"), rig).has_value());
  write_extrinsics(folder.path("extrinsics.json"), kTurn, kShift);
  const auto read = read_rig(folder.path("intrinsics.json"));
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(print_rig(*read).value(), print_rig(rig).value());
}

// Without a size lenses are of the frames that they meet; nothing but these is asked of the file.
TEST_F(OpenCvStereo, PicturesOfNoKnownSizeAreRectifiedAndShown) {
  write_intrinsics(folder.path("intrinsics.yml"));
  write_extrinsics(folder.path("extrinsics.yml"), kTurn, kShift);
  Rig rig = read_rig(folder.path("extrinsics.yml")).value();
  const auto sights = rectified_sights(rig, StereoSide::kRight, {640, 480});
  ASSERT_TRUE(sights.has_value()) << sights.error().message;
  EXPECT_EQ(sights->at(1).camera.image_size(), (ImageSize{640, 480}));
  EXPECT_FALSE(rectified_pair(rig).has_value());
  EXPECT_FALSE(print_rig(rig).has_value());
  const std::size_t paths = make_scene(rig).paths.size();
  for (RigCamera& camera : rig.cameras) camera.calibration.image_size = {640, 480};
  EXPECT_EQ(make_scene(rig).paths.size(), paths);
}

std::vector<double> numbers(const cv::FileStorage& file, const char* name) {
  cv::Mat matrix;
  file[name] >> matrix;
  return {matrix.begin<double>(), matrix.end<double>()};
}

// OpenCV reads what is written, and finds the same pictures rectified by it.
TEST_F(OpenCvStereo, OpenCvReadsBothFilesOfOurs) {
  for (const char* model : {"brown5", "fisheye"}) {
    scenes::Random random(11);
    const Camera first = scenes::random_camera(model, random);
    const Camera second = scenes::random_camera(model, random);
    const Rig rig =
        scenes::rig_of(first, second, {exp_so3({0.02, -0.03, 0.01}), {0.12, 0.003, -0.004}});
    const std::string there = folder.path(model) + "/";
    ASSERT_TRUE(write_rig_export({"opencv", there}, rig).has_value());
    const cv::FileStorage intrinsics(there + "intrinsics.yml", cv::FileStorage::READ);
    const cv::FileStorage extrinsics(there + "extrinsics.yml", cv::FileStorage::READ);
    ASSERT_TRUE(intrinsics.isOpened() && extrinsics.isOpened());
    EXPECT_TRUE(extrinsics["M1"].empty() && intrinsics["R"].empty());
    EXPECT_EQ(static_cast<int>(intrinsics["image_width"]), first.image_size().width);
    const auto m2 = numbers(intrinsics, "M2");
    ASSERT_EQ(m2.size(), 9U);
    EXPECT_EQ(m2[0], second.fx());
    EXPECT_EQ(m2[5], second.cy());
    EXPECT_EQ(numbers(intrinsics, "D1").size(), first.parameters().size() - 4);
    const SE3 right_from_left =
        to_se3(rig.cameras[1].rig_from_camera).inverse() * to_se3(rig.cameras[0].rig_from_camera);
    const auto t = numbers(extrinsics, "T");
    const auto r = numbers(extrinsics, "R");
    ASSERT_EQ(t.size(), 3U);
    ASSERT_EQ(r.size(), 9U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(t[i], right_from_left.translation[static_cast<int>(i)], 1e-12);
      EXPECT_NEAR(r[3 * i + 1], right_from_left.rotation(static_cast<int>(i), 1), 1e-12);
    }
    // The turns of OpenCV's own rectification, by its own Q the same depth.
    cv::Mat r1;
    cv::Mat r2;
    cv::Mat p1;
    cv::Mat p2;
    cv::Mat q;
    const cv::Mat rotation(3, 3, CV_64F, const_cast<double*>(r.data()));
    cv::stereoRectify(kLeft, cv::noArray(), kRight, cv::noArray(), {640, 480}, rotation, cv::Mat(t),
                      r1, r2, p1, p2, q);
    const auto own = numbers(extrinsics, "R1");
    ASSERT_EQ(own.size(), 9U);
    for (int i = 0; i < 9; ++i) {
      EXPECT_NEAR(own[static_cast<std::size_t>(i)], r1.at<double>(i / 3, i % 3), 1e-9) << i;
    }
    EXPECT_NEAR(numbers(extrinsics, "Q")[14], q.at<double>(3, 2), 1e-9);
    const auto read = read_rig(there);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_EQ(read->cameras[1].calibration.image_size, second.image_size());
    EXPECT_EQ(Camera::make(read->cameras[1].calibration)->parameters(), second.parameters());
  }
}

TEST_F(OpenCvStereo, OneFileOrTwoAsThePathSays) {
  scenes::Random random(5);
  const Camera camera = scenes::random_camera("brown5", random);
  const Rig rig = scenes::rig_of(camera, camera, {exp_so3({0, 0.01, 0}), {0.2, 0, 0}});
  ASSERT_TRUE(write_rig_export({"opencv", folder.path("stereo.yml")}, rig).has_value());
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.path("stereo.yml")));
  std::filesystem::create_directory(folder.path("there"));
  ASSERT_TRUE(write_rig_export({"opencv", folder.path("there")}, rig).has_value());
  EXPECT_TRUE(std::filesystem::is_regular_file(folder.path("there/extrinsics.yml")));
  EXPECT_FALSE(write_rig_export({"opencv", folder.path("stereo.yml/")}, rig).has_value());
}

// The lenses that OpenCV publishes with its samples, and what Bouguet has published of where the
// same cameras stand (om and T, mm).
TEST_F(OpenCvStereo, TheFileOfOpenCvsSamplesIsRead) {
  const char* data = std::getenv("CALVIN_DATA");
  const std::filesystem::path samples =
      std::filesystem::path(data == nullptr ? "/nowhere" : data) / "opencv-samples";
  if (!std::filesystem::exists(samples / "intrinsics.yml")) {
    GTEST_SKIP() << "CALVIN_DATA names no folder with opencv-samples";
  }
  std::ifstream published(samples / "bouguet_stereo_published.txt");
  cv::Vec3d om;
  cv::Vec3d t;
  for (std::string line; std::getline(published, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (name == "om") words >> om[0] >> om[1] >> om[2];
    if (name == "T") words >> t[0] >> t[1] >> t[2];
  }
  std::filesystem::copy(samples / "intrinsics.yml", folder.path("intrinsics.yml"));
  write_extrinsics(folder.path("extrinsics.yml"), om, t / 1000);
  const auto rig = read_rig(folder.path("intrinsics.yml"));
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  const cv::FileStorage file(folder.path("intrinsics.yml"), cv::FileStorage::READ);
  for (std::size_t c = 0; c < 2; ++c) {
    const auto m = numbers(file, c == 0 ? "M1" : "M2");
    const auto d = numbers(file, c == 0 ? "D1" : "D2");
    const Calibration& calibration = rig->cameras[c].calibration;
    EXPECT_EQ(calibration.find("fx")->value, m[0]);
    EXPECT_EQ(calibration.find("cy")->value, m[5]);
    EXPECT_EQ(calibration.find("k2")->value, d[1]);
  }
  const SE3 right = to_se3(rig->cameras[1].rig_from_camera);
  EXPECT_NEAR(right.translation.norm(), 0.0998084, 1e-6);
  EXPECT_NEAR(log_so3(right.rotation).norm(), cv::norm(om), 1e-9);
}

}  // namespace
}  // namespace calvin
