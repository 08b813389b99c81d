// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibrations as scripts and tools leave them that know no format: arrays of NumPy as plain lists,
// messages of ROS, names of lenses.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"

namespace calvin {
namespace {

std::string complaint(const std::string& text) {
  const auto read = parse_calibration(text);
  return read ? "it was read" : read.error().message;
}

void expect_complaint(const std::string& text, const char* words) {
  EXPECT_NE(complaint(text).find(words), std::string::npos) << text << "\n" << complaint(text);
}

// The file is the camera of every sample file.
void expect_is_the_sample(const std::string& text) {
  const auto read = parse_calibration(text);
  ASSERT_TRUE(read) << read.error().message << "\n" << text;
  const auto sample = parse_calibration(test::kNativeFile);
  EXPECT_EQ(read->image_size, sample->image_size);
  EXPECT_EQ(read->model, sample->model);
  for (const Parameter& p : sample->parameters) {
    ASSERT_NE(read->find(p.name), nullptr) << p.name;
    EXPECT_EQ(read->find(p.name)->value, p.value) << p.name;
  }
}

TEST(ScriptFile, MatricesAreListsOfRowsOrOfNumbers) {
  const std::string size = R"({"image_width": 640, "image_height": 480, )";
  for (const char* k : {R"("camera_matrix": [[520, 0, 325], [0, 518, 236], [0, 0, 1]])",
                        R"("mtx": [520, 0, 325, 0, 518, 236, 0, 0, 1])"}) {
    for (const char* d : {R"("distortion_coefficients": [[-0.28, 0.09, 0.0005, -0.0007, 0]])",
                          R"("dist": [-0.28, 0.09, 0.0005, -0.0007, 0])",
                          R"("D": [[-0.28], [0.09], [0.0005], [-0.0007], [0]])"}) {
      expect_is_the_sample(size + k + ", " + d + "}");
    }
  }
  if (!CALVIN_HAVE_FORMATS) return;
  expect_is_the_sample(
      "image_width: 640\nimage_height: 480\ncamera_matrix:\n- [520, 0, 325]\n- [0, 518, 236]\n"
      "- - 0\n  - 0\n  - 1\ndist_coeffs:\n- - -0.28\n  - 0.09\n  - 0.0005\n  - -0.0007\n  - 0\n");
}

TEST(ScriptFile, AnEmptyListIsNoDistortion) {
  for (const char* none : {"[]", "[[]]"}) {
    const auto read = parse_calibration(
        std::string(R"({"K": [[520, 0, 325], [0, 518, 236], [0, 0, 1]], "D": )") + none + "}");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->model, "pinhole");
  }
}

TEST(ScriptFile, OtherShapesAreRefusedInPlainWords) {
  const std::vector<std::pair<const char*, const char*>> table = {
      {"5", "'K' is no matrix: write its rows"},
      {"\"520 0 325\"", "'K' is no matrix: write its rows"},
      {"[]", "'K' is not a matrix of 3x3: nine numbers"},
      {"[[520, 0, 325], [0, 518, 236]]", "'K' is not a matrix of 3x3: nine numbers"},
      {"[520, 0, 325, 0, 518, 236, 0, 0]", "'K' is not a matrix of 3x3: nine numbers"},
      {"[[520, 0, 325], [0, 518], [0, 0, 1]]", "'K' has rows of 3 and of 2 numbers"},
      {"[[[520]]]", "'K' is not a finite number"},
      {"[[520, 0, \"a\"], [0, 518, 236], [0, 0, 1]]", "'K' is not a finite number"},
      {"{\"fx\": 520}", "'K' is no matrix: write its rows"},
      {"{\"rows\": 3, \"cols\": 3, \"data\": [1]}", "'K.data' has 1 numbers"},
  };
  for (const auto& [matrix, words] : table) {
    expect_complaint(std::string(R"({"D": [0, 0, 0, 0], "K": )") + matrix + "}", words);
  }
}

TEST(ScriptFile, APairIsReadInTheSameWay) {
  const auto rig = parse_rig(R"({"image_width": 640, "image_height": 480,
"M1": [[520, 0, 325], [0, 518, 236], [0, 0, 1]], "D1": [[-0.28, 0.09, 0.0005, -0.0007, 0]],
"M2": [[521, 0, 326], [0, 519, 237], [0, 0, 1]], "D2": [[-0.28, 0.09, 0.0005, -0.0007, 0]],
"R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [[-0.1], [0], [0]]})");
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_EQ(rig->cameras[1].calibration.find("cy")->value, 237);
  EXPECT_NEAR(rig->cameras[1].rig_from_camera.translation[0], 0.1, 1e-15);
}

std::string four_coefficients(const std::string& more) {
  return R"({"width": 640, "height": 480, "K": [[260, 0, 325], [0, 261, 236], [0, 0, 1]], )" +
         more + R"(, "D": [[-0.02], [0.005], [-0.003], [0.0005]]})";
}

// Four coefficients of cv::fisheye look like those of brown4: only a word tells them apart.
TEST(ScriptFile, TheLensIsTheOneThatIsNamed) {
  const std::vector<std::pair<const char*, const char*>> table = {
      {R"("camera_model": "fisheye")", "fisheye"},
      {R"("model": "fisheye")", "fisheye"},
      {R"("model": "Equidistant")", "fisheye"},
      {R"("model_type": "KANNALA_BRANDT")", "fisheye"},
      {R"("cameraModel": "KannalaBrandt8")", "fisheye"},
      {R"("lens_model": "opencv-fisheye")", "fisheye"},
      {R"("distortionModel": "equidistant", "camera_model": "pinhole")", "fisheye"},
      {R"("distortion_model": "equidistant", "camera_model": "pinhole")", "fisheye"},
      {R"("camera_model": "pinhole", "fisheye": 1)", "fisheye"},
      {R"("camera_model": "fisheye", "fisheye": true)", "fisheye"},
      {R"("model": "pinhole")", "brown4"},
      {R"("model": "plumb_bob")", "brown4"},
      {R"("model": "brown4")", "brown4"},
      {R"("camera_model": "Brown-Conrady", "fisheye_model": 0)", "brown4"},
      {R"("model": null)", "brown4"},
      {R"("camera_name": "fisheye")", "brown4"},
      {R"("model": "C920")", "brown4"},
      {R"("camera_model": "Fish Eye 180", "fisheye": 1)", "fisheye"},
  };
  for (const auto& [word, model] : table) {
    const auto read = parse_calibration(four_coefficients(word));
    ASSERT_TRUE(read) << word << read.error().message;
    EXPECT_EQ(read->model, model) << word;
  }
}

TEST(ScriptFile, ALensThatIsNotKnownIsRefusedWithTheKnownOnes) {
  for (const char* word :
       {R"("camera_model": "omnidirectional")", R"("model": "eucm")", R"("lens_model": "C920")",
        R"("distortion_model": "plumb_bob", "camera_model": "omni")"}) {
    const std::string text = four_coefficients(word);
    expect_complaint(text, "no lens of OpenCV's; read are fisheye, equidistant, kannala_brandt");
  }
  for (const char* words :
       {R"("camera_model": "fisheye", "fisheye_model": 0)", R"("model": "radtan", "fisheye": 1)",
        R"("distortion_model": "plumb_bob", "camera_model": "fisheye")"}) {
    expect_complaint(four_coefficients(words), "contradicts");
  }
}

TEST(ScriptFile, ThePairOfANamedLensIsOfIt) {
  const auto rig = parse_rig(R"({"camera_model": "fisheye",
"M1": [[260, 0, 325], [0, 261, 236], [0, 0, 1]], "D1": [-0.02, 0.005, -0.003, 0.0005],
"M2": [[260, 0, 325], [0, 261, 236], [0, 0, 1]], "D2": [-0.02, 0.005, -0.003, 0.0005],
"R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [-0.1, 0, 0]})");
  ASSERT_TRUE(rig) << rig.error().message;
  for (const RigCamera& camera : rig->cameras) EXPECT_EQ(camera.calibration.model, "fisheye");
}

constexpr const char* kMessage = R"(header:
  stamp:
    sec: 1763700000
    nanosec: 250000000
  frame_id: camera_optical_frame
height: 480
width: 640
distortion_model: plumb_bob
d:
- -0.28
- 0.09
- 0.0005
- -0.0007
- 0.0
k:
- 520.0
- 0.0
- 325.0
- 0.0
- 518.0
- 236.0
- 0.0
- 0.0
- 1.0
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
p: [480.0, 0.0, 326.0, 0.0, 0.0, 488.0, 235.0, 0.0, 0.0, 0.0, 1.0, 0.0]
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  height: 0
  width: 0
  do_rectify: false
---
)";

std::string message(std::string_view change, std::string_view with) {
  std::string text = kMessage;
  const auto at = text.find(change);
  EXPECT_NE(at, std::string::npos) << change;
  return text.replace(at, change.size(), with);
}

// Of a topic that was listened to, one message or several.
TEST(ScriptFile, AMessageOfRosIsACameraInfo) {
  if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  expect_is_the_sample(kMessage);
  expect_is_the_sample(std::string(kMessage) + kMessage);
  expect_is_the_sample(
      "height: 480\nwidth: 640\ndistortion_model: \"plumb_bob\"\n"
      "D: [-0.28, 0.09, 0.0005, -0.0007, 0.0]\n"
      "K: [520.0, 0.0, 325.0, 0.0, 518.0, 236.0, 0.0, 0.0, 1.0]\n"
      "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n");
  expect_complaint(message("width: 640\n", ""), "'image_width' is missing");
  expect_complaint(message("width: 640", "width: 0"), "'width' or 'height' is not positive");
  expect_complaint(message("- 520.0\n", ""), "'k' is not a matrix of 3x3: nine numbers");
  expect_complaint(message("plumb_bob", "equidistant"), "'d' are 5, but equidistant has 4");
  // A driver without a calibration.
  expect_complaint(message("plumb_bob", "''"), "'distortion_model' is ''");
}

}  // namespace
}  // namespace calvin
