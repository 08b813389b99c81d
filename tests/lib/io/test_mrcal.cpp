// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Cameras and rigs in mrcal's files: by pixels and places that mrcal has published.
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"
#include "rig_files.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

using test::expect_same;
using test::put;
using test::random_rig;
using test::with;

std::string model_text(const std::string& lens, const std::string& intrinsics,
                       const std::string& extrinsics = "0, 0, 0, 0, 0, 0") {
  return "# generated on 2020-11-14 with   mrcal-calibrate-cameras --lensmodel {x}\n{\n"
         "    'lensmodel':  '" +
         lens + "',\n\n    # intrinsics are fx,fy,cx,cy,distortion0,distortion1,....\n" +
         "    'intrinsics': [" + intrinsics +
         ",],\n\n    # extrinsics are rt_fromref\n    'extrinsics': [" + extrinsics +
         ",],\n\n    'imagersize': [ 6016, 4016,],\n\n    'icam_intrinsics': 0,\n\n"
         "    'optimization_inputs': "
         "b'P)h>@6aWAK2m{k;8Apr}P8D`%|$007_s#000gE6aZ;%baH8Kb7^C9E',\n\n}\n";
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
       {{651.1885442, 555.10514968},
        {-1234.45480366, 680.23499814},
        {-770.03274263, -1238.4871943}}},
  };
  int compared = 0;
  for (const Published& one : published) {
    const auto read =
        parse_calibration(model_text("LENSMODEL_" + std::string(one.lens),
                                     "1512., 1112, 500., 333." + std::string(one.coefficients)));
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
  const std::string oldest =
      with(with(good, "lensmodel'", "distortion_model'"), "LENSMODEL_PINHOLE", "DISTORTION_NONE");
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

// A text with one thing changed, and words of what is said.
TEST(Mrcal, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string model = model_text("LENSMODEL_OPENCV4", "500, 500, 320, 240, 0, 0, 0, 0");
  const test::BrokenText models[] = {
      {"OPENCV4", "CAHVOR", "LENSMODEL_CAHVOR, which no camera model"},
      {"500, 500, 320", "500, 320", "'intrinsics' is not a list of 8 numbers"},
      {"'extrinsics': [0, ", "'extrinsics': [", "'extrinsics' is not a list of 6 numbers"},
      {"'extrinsics'", "'extrinsic'", "'extrinsics' is missing"},
      {"'extrinsics': [0", "'extrinsics': [1e9", "'extrinsics' is out of range"},
      {"500, 500", "-500, 500", "'intrinsics' is wrong"},
      {"6016", "0", "'intrinsics' is wrong"},
      {"'imagersize': [ 6016, 4016,]", "'imagersize': [ 6016, 4016,", "in line"},
      {"'lensmodel':", "'lensmodel'", "'lensmodel' has no value"},
      {"'lensmodel':", "lensmodel:", "a key is no text in quotes"},
      {"b'P)h", "b'P\n", "a text has no end"},
      {"'imagersize'", "'imagesize'", "it has no intrinsics and imagersize"},
  };
  put(folder.path("m/b.cameramodel"), model);
  test::expect_broken(folder.path("m/a.cameramodel"), model, models, "a.cameramodel");
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
