// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Results of Bouguet's toolbox: scripts of MATLAB and text of Octave, of a camera and of a pair.
#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/rig_io.hpp"
#include "calvin/io/settings.hpp"
#include "io_samples.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

using test::kBouguetOctave;
using test::kBouguetScript;

// The script with more behind it.
std::string script(std::string_view more) {
  return std::string(kBouguetScript) + std::string(more);
}

std::string complaint(const std::string& text) {
  const auto read = parse_calibration(text);
  return read ? "it was read" : read.error().message;
}

TEST(Bouguet, HasAThirdOfItsUncertaintiesForSigmas) {
  const auto read = parse_calibration(script(
      "alpha_c = 0.002;\nalpha_c_error = 0.0003;\nkc_error = [ 3e-3 ; 6e-3 ; 0 ; 9e-4 ; 0 ];\n"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->image_size, (ImageSize{640, 480}));
  EXPECT_DOUBLE_EQ(read->find("fx")->sigma.value(), 0.3);
  EXPECT_DOUBLE_EQ(read->find("fy")->sigma.value(), 0.4);
  EXPECT_DOUBLE_EQ(read->find("k2")->sigma.value(), 2e-3);
  EXPECT_DOUBLE_EQ(read->find("p2")->sigma.value(), 3e-4);
  EXPECT_DOUBLE_EQ(read->find("skew")->sigma.value(), 520 * 1e-4);
  for (const char* held : {"cx", "p1", "k3"}) EXPECT_FALSE(read->find(held)->sigma) << held;
  // u = fc_1 (x + alpha_c y) + cc_1 on the axis, where nothing is distorted.
  const Camera camera = Camera::make(*read).value();
  const auto near = camera.project({0, 1e-4, 1});
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->u - 325, 520 * (0.002 * 1e-4), 2e-5);
}

TEST(Bouguet, HasItsOwnDeviations) {
  EXPECT_DOUBLE_EQ(parse_calibration(kBouguetOctave)->rms.value(), 0.5);
  EXPECT_FALSE(parse_calibration(kBouguetScript)->rms);
}

TEST(Bouguet, PassesOverWhatElseAScriptDoes) {
  const auto read = parse_calibration(
      "fc = [ 1 2 3 ]; % that is overwritten\n"
      "name = 'a;b [ % no comment'; other = \"[ % ;\"; fc = [520, ...\n 518]';\n"
      "if nx > 0, disp('x'); end\nKK = [fc(1) alpha_c*fc(1) cc(1);0 fc(2) cc(2) ; 0 0 1];\n"
      "cc = [ 325 ; 236 ]; kc = zeros(5,1);\nkc = [\n -0.28\n 0.09\n 0\n 0\n]; nx = 640; ny = 480");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->model, "brown4");
  EXPECT_EQ(read->find("fy")->value, 518);
  EXPECT_EQ(read->find("k2")->value, 0.09);
  EXPECT_EQ(read->image_size, (ImageSize{640, 480}));
}

TEST(Bouguet, SaysWhatIsWrong) {
  struct Broken {
    std::string text;
    const char* words;
  };
  const Broken cases[] = {
      {script("fc = [ 1 ; 2 ; 3 ];"), "'fc'"},
      {script("kc = [ NaN ; 0 ; 0 ; 0 ; 0 ];"), "'kc"},
      {script("kc = [ 1 ; 2 ; 3 ];"), "fc"},
      {script("nx = -640;"), "fc"},
      {script("x = [ 1 2"), "never closed"},
      {"% nothing but a comment\n", "none of the fields"},
      {"fc = [ 500 ; 500 ];\ncc = [ 320 ; 240 ];\n", "'nx'"},
      {std::string("MATLAB 5.0 MAT-file, Platform: PCWIN\0\0\1", 39), "Calib_Results.m"},
      {std::string("MATLAB 7.3 MAT-file, Platform: GLNXA64\0\0", 40), "Calib_Results.m"},
      {"# name: fc\n# type: matrix\n# rows: 2\n# columns: 1\n 500\n", "none of the fields"},
  };
  for (const Broken& broken : cases) {
    EXPECT_NE(complaint(broken.text).find(broken.words), std::string::npos)
        << complaint(broken.text);
  }
}

// Both cameras of a pair, without om or R.
std::string pair_without_turn() {
  std::string text;
  for (const char* side : {"_left", "_right"}) {
    for (const char* line :
         {"fc$ = [ 533 ; 534 ];", "cc$ = [ 342 ; 235 ];", "alpha_c$ = [ 0 ];",
          "kc$ = [ -0.28 ; 0.1 ; 0.001 ; 0 ; 0 ];", "fc$_error = [ 0.9 ; 0.9 ];"}) {
      std::string one = line;
      one.replace(one.find('$'), 1, side);
      text += one + "\n";
    }
  }
  return text + "nx = 640; ny = 480;\nT = [ -99.85 ; 0.8 ; 0.4 ];\n";
}

constexpr const char* kTurned = "om = [ 0.007 ; 0.004 ; -0.0035 ];\n";

// om and T take points of the left camera to the right one, T in mm.
TEST(Bouguet, PlacesAPair) {
  const std::string text = pair_without_turn();
  const auto rig = parse_rig(text + kTurned);
  ASSERT_TRUE(rig) << rig.error().message;
  ASSERT_EQ(rig->cameras.size(), 2u);
  EXPECT_EQ(rig->world, "left");
  EXPECT_EQ(rig->cameras[1].calibration.camera, "right");
  EXPECT_DOUBLE_EQ(rig->cameras[1].calibration.find("fx")->sigma.value(), 0.3);
  const SE3 right_from_left = to_se3(rig->cameras[1].rig_from_camera).inverse();
  EXPECT_NEAR(right_from_left.translation.x(), -0.09985, 1e-12);
  // Rodrigues' formula to the second order.
  EXPECT_NEAR(right_from_left.rotation(1, 0), -0.0035 + 0.5 * 0.007 * 0.004, 1e-7);
  // By R in place of om; the left camera where one is asked for.
  const auto by_matrix = parse_rig(text + "R = [ 0 1 0 ; -1 0 0 ; 0 0 1 ]';\n");
  ASSERT_TRUE(by_matrix) << by_matrix.error().message;
  EXPECT_NEAR(to_se3(by_matrix->cameras[1].rig_from_camera).rotation(0, 1), 1, 1e-12);
  EXPECT_EQ(parse_calibration(text + kTurned)->find("fx")->value, 533);
  EXPECT_FALSE(parse_rig(text + "R = [ 1 0 0 ; 0 1 0 ; 0 0 3 ];\n"));
  EXPECT_FALSE(parse_rig(text));
}

// The property `calibration` of an element: a pair to rectify, or the left camera.
TEST(Bouguet, IsAPairAndItsLeftCameraInASetting) {
  const TemporaryFolder folder;
  const std::string file = folder.path("Calib_Results_stereo.m");
  ASSERT_TRUE(write_file(file, pair_without_turn() + kTurned));
  auto setting = parse_camera_setting(file);
  ASSERT_TRUE(setting) << setting.error().message;
  ASSERT_NE(rig_of(*setting), nullptr);
  EXPECT_EQ(print_rig(*rig_of(*setting)).value(), print_rig(read_rig(file).value()).value());
  ASSERT_NE(one_camera_of(*setting), nullptr);
  EXPECT_EQ(one_camera_of(*setting)->find("fx")->value, 533);
  // A turn that is none: the left camera is sound.
  ASSERT_TRUE(write_file(file, pair_without_turn() + "R = [ 1 0 0 ; 0 1 0 ; 0 0 3 ];\n"));
  setting = parse_camera_setting(file);
  ASSERT_TRUE(setting) << setting.error().message;
  EXPECT_NE(one_camera_of(*setting), nullptr);
  EXPECT_EQ(rig_of(*setting), nullptr);
}

}  // namespace
}  // namespace calvin
