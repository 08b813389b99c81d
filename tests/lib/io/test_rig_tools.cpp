// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rigs in the files of mrcal, COLMAP and caliscope: frames, directions, units and pixels are those
// of these programs, by numbers that they have published and by formulas of their own.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"
#include "calvin_config.h"
#include "scenes.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

void put(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path) << text;
}

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Cameras of these models in any places, of which none is the frame of the rig.
Rig random_rig(const std::vector<const char*>& models, std::uint64_t seed) {
  scenes::Random random(seed);
  Rig rig;
  for (const char* model : models) {
    RigCamera camera;
    camera.calibration = scenes::random_camera(model, random).to_calibration();
    camera.calibration.camera = "the " + std::string(model);
    const auto some = [&] { return scenes::uniform(random, -1, 1); };
    camera.rig_from_camera = to_pose({exp_so3({some(), some(), some()}), {some(), some(), some()}});
    rig.cameras.push_back(camera);
  }
  rig.world = kReferenceWorld;
  return rig;
}

// Points before each camera have the same pixels.
void expect_same(const Rig& before, const Rig& after) {
  ASSERT_EQ(after.cameras.size(), before.cameras.size());
  for (std::size_t n = 0; n < before.cameras.size(); ++n) {
    const Camera camera = Camera::make(before.cameras[n].calibration).value();
    const Camera other = Camera::make(after.cameras[n].calibration).value();
    EXPECT_EQ(other.image_size(), camera.image_size());
    EXPECT_EQ(other.model(), camera.model());
    const SE3 rig_from_camera = to_se3(before.cameras[n].rig_from_camera);
    const SE3 other_from_rig = to_se3(after.cameras[n].rig_from_camera).inverse();
    for (const double x : {-0.3, 0.1, 0.35}) {
      for (const double y : {-0.2, 0.25}) {
        const Eigen::Vector3d point(x, y, 1);
        const auto at = camera.project(point);
        const auto then = other.project(other_from_rig * (rig_from_camera * point));
        ASSERT_TRUE(at && then) << camera.model();
        EXPECT_NEAR(then->u, at->u, 1e-9) << camera.model();
        EXPECT_NEAR(then->v, at->v, 1e-9) << camera.model();
      }
    }
  }
}

// ---- mrcal --------------------------------------------------------------------------------------

std::string model_text(const std::string& lens, const std::string& intrinsics,
                       const std::string& extrinsics = "0, 0, 0, 0, 0, 0") {
  return "# generated on 2020-11-14 with   mrcal-calibrate-cameras --lensmodel {x}\n{\n"
         "    'lensmodel':  '" +
         lens + "',\n\n    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n" +
         "    'intrinsics': [" + intrinsics +
         ",],\n\n    # extrinsics are rt_fromref\n    'extrinsics': [" + extrinsics +
         ",],\n\n    'imagersize': [ 6016, 4016,],\n\n    'icam_intrinsics': 0,\n\n"
         "    'optimization_inputs': b'P)h>@6aWAK2m{k;8Apr}P8D`%|$007_s#000gE6aZ;%baH8Kb7^C9E',\n\n}\n";
}

// Points and pixels of mrcal's test/test-projections.py (v2.4).
TEST(Mrcal, ProjectsAsItHasPublished) {
  struct Published {
    const char* lens;
    const char* coefficients;
    Pixel pixels[3];
  };
  const Eigen::Vector3d points[] = {{1.0, 2.0, 10.0}, {-1.1, 0.3, 1.0}, {-0.9, -1.5, 1.0}};
  const Published published[] = {
      {"PINHOLE", "", {{651.2, 555.4}, {-1163.2, 666.6}, {-860.8, -1335}}},
      {"OPENCV4",
       ", -0.012, 0.035, -0.001, 0.002",
       {{651.27371, 555.23042}, {-1223.38516, 678.01468}, {-1246.7310448, -1822.799928}}},
      {"OPENCV5",
       ", -0.012, 0.035, -0.001, 0.002, 0.019",
       {{651.2740691, 555.2309482}, {-1292.8121176, 691.9401448}, {-1987.550162, -2730.85863427}}},
      {"OPENCV8",
       ", -0.012, 0.035, -0.001, 0.002, 0.019, 0.014, -0.056, 0.050",
       {{651.1885442, 555.10514968}, {-1234.45480366, 680.23499814}, {-770.03274263, -1238.4871943}}},
  };
  int compared = 0;
  for (const Published& one : published) {
    const auto read = parse_calibration(model_text(
        "LENSMODEL_" + std::string(one.lens), "1512., 1112, 500., 333." +
                                                  std::string(one.coefficients)));
    ASSERT_TRUE(read.has_value()) << one.lens << ": " << read.error().message;
    const Camera camera = Camera::make(*read).value();
    EXPECT_EQ(camera.image_size(), (ImageSize{6016, 4016}));
    for (std::size_t i = 0; i < 3; ++i) {
      // The last two points are beyond what some of these lenses can be inverted at.
      const auto at = camera.project(points[i]);
      if (!at) continue;
      ++compared;
      EXPECT_NEAR(at->u, one.pixels[i].u, 1e-5) << one.lens << i;
      EXPECT_NEAR(at->v, one.pixels[i].v, 1e-5) << one.lens << i;
    }
  }
  EXPECT_GE(compared, 9);
}

// Two cameras that mrcal's documentation places 7 feet apart, the second on the right (doc/data/
// figueroa-overpass-looking-S).
TEST(Mrcal, ModelsOfAFolderAreARig) {
  const TemporaryFolder folder;
  const std::string lens =
      "2073.872915, 2077.452267, 3004.686823, 1997.377253, 0.4791613797, 0.0266824914, "
      "4.398264387e-05, -1.180073913e-05, 8.959722542e-05, 0.7666912469, 0.09633561231, "
      "0.001407513313";
  put(folder.path("left.cameramodel"), model_text("LENSMODEL_OPENCV8", lens));
  put(folder.path("right.cameramodel"),
      model_text("LENSMODEL_OPENCV8", lens,
                 "-0.003280535911, -0.02376844776, 0.01836950824, -2.133344352, -0.02335054537, "
                 "-0.0003698665433"));
  put(folder.path("notes.txt"), "left and right");
  const auto rig = read_rig(folder.path(""));
  ASSERT_TRUE(rig.has_value()) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 2U);
  EXPECT_EQ(rig->cameras[0].calibration.camera, "left");
  EXPECT_EQ(rig->cameras[1].calibration.camera, "right");
  EXPECT_EQ(rig->world, "left");
  EXPECT_TRUE(rig->is_metric);
  const SE3 right = to_se3(rig->cameras[1].rig_from_camera);
  EXPECT_NEAR(right.translation.norm(), 7 * 0.3048, 5e-4);
  EXPECT_GT(right.translation.x(), 2.13);
  const Eigen::Vector3d point(0.3, -0.2, 20);
  const Eigen::Matrix3d r = exp_so3({-0.003280535911, -0.02376844776, 0.01836950824});
  const Eigen::Vector3d own =
      r * point + Eigen::Vector3d(-2.133344352, -0.02335054537, -0.0003698665433);
  EXPECT_LT((right.inverse() * point - own).norm(), 1e-9);
  EXPECT_TRUE(is_rig_folder(folder.path("")));
  // One of them alone is a calibration, and no rig.
  EXPECT_TRUE(read_calibration(folder.path("right.cameramodel")).has_value());
  const auto one = read_rig(folder.path("right.cameramodel"));
  ASSERT_FALSE(one.has_value());
  EXPECT_NE(one.error().message.find("give the folder"), std::string::npos) << one.error().message;
  // What takes a calibration or a rig takes the folder.
  EXPECT_TRUE(std::holds_alternative<Rig>(parse_camera_setting(folder.path("")).value()));
}

TEST(Mrcal, OlderNamesOfTheLensAreRead) {
  const std::string good = model_text("LENSMODEL_PINHOLE", "500, 500, 320, 240");
  EXPECT_TRUE(parse_calibration(with(good, "lensmodel'", "lens_model'")).has_value());
  const std::string oldest = with(with(good, "lensmodel'", "distortion_model'"),
                                  "LENSMODEL_PINHOLE", "DISTORTION_NONE");
  const auto read = parse_calibration(oldest);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->model, "pinhole");
}

// What a camera has seen is where mrcal says that its model counts.
TEST(Mrcal, TheRegionOfALensIsKept) {
  Rig rig = random_rig({"brown5"}, 3);
  rig.cameras[0].calibration.covered = {{10, 20}, {600, 25}, {300, 400.5}};
  const TemporaryFolder folder;
  ASSERT_TRUE(write_rig(folder.path("m"), rig, "mrcal").has_value());
  const auto read = read_rig(folder.path("m"));
  ASSERT_TRUE(read.has_value()) << read.error().message;
  const auto& region = read->cameras[0].calibration.covered;
  ASSERT_EQ(region.size(), 3U);
  EXPECT_EQ(region[2].v, 400.5);
}

TEST(Mrcal, ReadsBackAsTheSameRig) {
  const Rig rig = random_rig({"pinhole", "brown4", "brown5", "rational8", "thinprism12"}, 1);
  const TemporaryFolder folder;
  const Status written = write_rig(folder.path("new/m"), rig, "mrcal");
  ASSERT_TRUE(written.has_value()) << written.error().message;
  auto read = read_rig(folder.path("new/m"));
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->world, kReferenceWorld);
  // By the names of the files.
  std::vector<RigCamera> sorted;
  for (const RigCamera& camera : rig.cameras) {
    for (const RigCamera& found : read->cameras) {
      if (found.calibration.camera == camera.calibration.camera) sorted.push_back(found);
    }
  }
  read->cameras = sorted;
  expect_same(rig, *read);
}

TEST(Mrcal, WritesNoFolderThatWouldReadAsAnotherRig) {
  const TemporaryFolder folder;
  Rig rig = random_rig({"brown4", "brown5"}, 4);
  ASSERT_TRUE(write_rig(folder.path("m"), rig, "mrcal").has_value());
  EXPECT_TRUE(write_rig(folder.path("m"), rig, "mrcal").has_value());
  rig.cameras.pop_back();
  const Status other = write_rig(folder.path("m"), rig, "mrcal");
  ASSERT_FALSE(other.has_value());
  EXPECT_NE(other.error().message.find("the brown5.cameramodel"), std::string::npos);
  EXPECT_NE(other.error().message.find("empty folder"), std::string::npos);
  rig.cameras[0].calibration.camera = "";
  EXPECT_NE(write_rig(folder.path("n"), rig, "mrcal").error().message.find("rename the camera"),
            std::string::npos);
  put(folder.path("file"), "x");
  EXPECT_FALSE(write_rig(folder.path("file"), random_rig({"brown4"}, 1), "mrcal").has_value());
}

// ---- COLMAP -------------------------------------------------------------------------------------

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

Pixel brown(double x, double y, const std::vector<double>& p) {
  const double r = x * x + y * y;
  const double k3 = p.size() > 8 ? p[8] : 0;
  const double below =
      p.size() > 8 ? 1 + p[9] * r + p[10] * r * r + p[11] * r * r * r : 1;
  const double radial = (1 + p[4] * r + p[5] * r * r + k3 * r * r * r) / below;
  const double u = x * radial + 2 * p[6] * x * y + p[7] * (r + 2 * x * x);
  const double v = y * radial + 2 * p[7] * x * y + p[6] * (r + 2 * y * y);
  return {p[0] * u + p[2], p[1] * v + p[3]};
}

Pixel fisheye(double x, double y, const std::vector<double>& p) {
  const double r = std::hypot(x, y);
  const double t = std::atan(r);
  const double d = t * (1 + p[4] * t * t + p[5] * std::pow(t, 4) + p[6] * std::pow(t, 6) +
                        p[7] * std::pow(t, 8));
  return {p[0] * x * d / r + p[2], p[1] * y * d / r + p[3]};
}

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
        brown(x, y, {520, 520, 320.5, 240.5, -0.1, 0, 0, 0}),
        brown(x, y, {520, 518, 325.5, 236.5, -0.28, 0.09, 0.0005, -0.0007}),
        fisheye(x, y, {260, 261, 322, 238, -0.02, 0.005, -0.003, 0.0005}),
        brown(x, y, {520, 518, 325.5, 236.5, -0.28, 0.09, 0.0005, -0.0007, 0.01, 0.02, -0.01, 0.001}),
        {300 * x * by_fov + 320, 301 * y * by_fov + 240},
        fisheye(x, y, {260, 260, 322, 238, -0.02, 0.005, 0, 0}),
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

// ---- caliscope ----------------------------------------------------------------------------------

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
  const Pixel expected = brown(p.x(), p.y(),
                               {903.55, 907.875, 618.5, 394.25, -0.33, 0.046, -0.0043, 0.0041,
                                0.0666, 0, 0, 0});
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
  const Rig rig = random_rig(
      {"brown4", "brown5", "rational8", "thinprism12", "tilted14", "fisheye"}, 5);
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
  const std::string folder =
      std::string(data == nullptr ? "" : data) + "/charuco-caliscope-4cam/";
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
}

// ---- Kalibr -------------------------------------------------------------------------------------

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

// ---- What is wrong ------------------------------------------------------------------------------

// A text with one thing changed, and words of what is said.
TEST(RigTools, SayWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string model = model_text("LENSMODEL_OPENCV4", "500, 500, 320, 240, 0, 0, 0, 0");
  const std::pair<std::pair<const char*, const char*>, const char*> models[] = {
      {{"OPENCV4", "CAHVOR"}, "LENSMODEL_CAHVOR, which no camera model"},
      {{"500, 500, 320", "500, 320"}, "'intrinsics' is not a list of 8 numbers"},
      {{"'extrinsics': [0, ", "'extrinsics': ["}, "'extrinsics' is not a list of 6 numbers"},
      {{"'extrinsics'", "'extrinsic'"}, "'extrinsics' is missing"},
      {{"'extrinsics': [0", "'extrinsics': [1e9"}, "'extrinsics' is out of range"},
      {{"500, 500", "-500, 500"}, "'intrinsics' is wrong"},
      {{"6016", "0"}, "'intrinsics' is wrong"},
      {{"'imagersize': [ 6016, 4016,]", "'imagersize': [ 6016, 4016,"}, "in line"},
      {{"'lensmodel':", "'lensmodel'"}, "'lensmodel' has no value"},
      {{"'lensmodel':", "lensmodel:"}, "a key is no text in quotes"},
      {{"b'P)h", "b'P\n"}, "a text has no end"},
      {{"'imagersize'", "'imagesize'"}, "it has no intrinsics and imagersize"},
  };
  put(folder.path("m/b.cameramodel"), model);
  for (const auto& [change, words] : models) {
    put(folder.path("m/a.cameramodel"), with(model, change.first, change.second));
    const auto read = read_rig(folder.path("m"));
    ASSERT_FALSE(read.has_value()) << words;
    EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find("a.cameramodel"), std::string::npos);
  }
  const std::pair<std::pair<const char*, const char*>, const char*> of_cameras[] = {
      {{"1 SIMPLE_RADIAL", "x SIMPLE_RADIAL"}, "cameras.txt, line 4: it is not 'CAMERA_ID MODEL"},
      {{"SIMPLE_RADIAL", "DIVISION"}, "line 4: no camera model here is like DIVISION"},
      {{"520 320.5 240.5 -0.1", "520 320.5 240.5"}, "SIMPLE_RADIAL has a width, a height and 4"},
      {{"520 320.5 240.5 -0.1", "520 320.5 240.5 nan"}, "SIMPLE_RADIAL has a width"},
      {{"2 OPENCV", "1 OPENCV"}, "line 5: an earlier line has that camera"},
      {{"1 SIMPLE_RADIAL 640 480 520", "1 SIMPLE_RADIAL 640 480 -520"}, "cameras.txt, line 4: "},
  };
  put(folder.path("c/images.txt"), kImages);
  for (const auto& [change, words] : of_cameras) {
    put(folder.path("c/cameras.txt"), with(kCameras, change.first, change.second));
    const auto read = read_rig(folder.path("c"));
    ASSERT_FALSE(read.has_value()) << words;
    EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
  }
  const std::pair<std::pair<const char*, const char*>, const char*> of_images[] = {
      {{"1 0.5 0.5", "1 0.5"}, "images.txt, line 5: "},
      {{"1 0.5 0.5", "1 0.9 0.5"}, "no quaternion of length 1"},
      {{"0.3 1 P", "0.3 3 P"}, "cameras.txt has no camera 3"},
      {{"0.1 -0.2 0.3 1 P", "1e9 -0.2 0.3 1 P"}, "TX TY TZ is out of range"},
      {{"4 d", "4 e"}, "images.txt has 'e' twice"},
  };
  put(folder.path("c/cameras.txt"), kCameras);
  for (const auto& [change, words] : of_images) {
    put(folder.path("c/images.txt"), with(kImages, change.first, change.second));
    const auto read = read_rig(folder.path("c"));
    ASSERT_FALSE(read.has_value()) << words;
    EXPECT_NE(read.error().message.find(words), std::string::npos) << read.error().message;
  }
  put(folder.path("c/images.txt"), "# nothing\n");
  EXPECT_NE(read_rig(folder.path("c")).error().message.find("images.txt has no picture"),
            std::string::npos);
  std::filesystem::remove(folder.path("c/cameras.txt"));
  EXPECT_EQ(read_rig(folder.path("c")).error().code, ErrorCode::kNotFound);
  std::filesystem::create_directories(folder.path("empty"));
  const auto empty = read_rig(folder.path("empty"));
  EXPECT_NE(empty.error().message.find("*.cameramodel"), std::string::npos) << empty.error().message;
  EXPECT_NE(empty.error().message.find("Give a file"), std::string::npos);
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

TEST(RigTools, RefuseLensesThatTheyDoNotHave) {
  const TemporaryFolder folder;
  const auto refusal = [&](const char* model, const char* format) {
    const Status status = write_rig(folder.path(format), random_rig({model}, 9), format);
    EXPECT_FALSE(status.has_value()) << model << format;
    return status ? std::string() : status.error().message;
  };
  EXPECT_NE(refusal("fisheye", "mrcal").find("mrcal has no lens"), std::string::npos);
  EXPECT_NE(refusal("doublesphere", "mrcal").find("doublesphere"), std::string::npos);
  EXPECT_NE(refusal("thinprism12", "colmap").find("COLMAP has no lens"), std::string::npos);
  EXPECT_NE(refusal("ucm", "caliscope").find("caliscope has no lens"), std::string::npos);
  Rig skewed = random_rig({"pinhole"}, 9);
  skewed.cameras[0].calibration.parameters.push_back({"skew", 0.3, {}});
  for (const char* format : {"mrcal", "colmap"}) {
    const Status status = write_rig(folder.path(format), skewed, format);
    ASSERT_FALSE(status.has_value()) << format;
    EXPECT_NE(status.error().message.find("skew"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder.path(format)));
  }
  EXPECT_EQ(print_rig(skewed, "mrcal").error().code, ErrorCode::kInvalidArgument);
  for (const std::string_view format : {"mrcal", "colmap"}) {
    EXPECT_FALSE(can_hold(format, "ucm").has_value());
    EXPECT_TRUE(can_hold(format, "brown5").has_value());
  }
}

}  // namespace
}  // namespace calvin
