// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file of a hand-eye calibration: what is written is read again as the same, and whatever is
// wrong in a file is said by its place.
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/hand_eye_io.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

HandEye sample(EyeSetup setup) {
  HandEye hand_eye;
  hand_eye.setup = setup;
  hand_eye.calibration =
      Camera::make("brown4", {640, 480}, {536.1, 536, 342.4, 235.5, -0.27, 0.1, 0.001, 0})
          .value()
          .to_calibration();
  hand_eye.calibration.camera = "wr\"ist";
  hand_eye.mount_from_camera = {{0.1, -0.2, 1.0 / 3}, {0.12, 0, 1e-7}};
  hand_eye.carrier_from_board = {{2, 0.2, 0.3}, {0.7, -0.1, 0.02}};
  hand_eye.mount_covariance.assign(36, 0.0);
  for (std::size_t i = 0; i < 6; ++i) hand_eye.mount_covariance[7 * i] = 1e-8 / 3;
  hand_eye.carrier_covariance = hand_eye.mount_covariance;
  hand_eye.poses = 12;
  hand_eye.rms = 0.21;
  hand_eye.corner_factor = 1.1;
  hand_eye.loop_turn = 0.001;
  hand_eye.loop_place = 1.0 / 3000;
  hand_eye.robot_turn_sigma = 5e-4;
  hand_eye.robot_place_sigma = 2e-4;
  hand_eye.scale = LengthRatio{0.988, 0.001};
  hand_eye.aspect = LengthRatio{1.002, 0.0003};
  hand_eye.remarks = {"Measure the board."};
  return hand_eye;
}

TEST(HandEyeFile, IsReadAsItWasWritten) {
  for (const EyeSetup setup : {EyeSetup::kInHand, EyeSetup::kToHand}) {
    const auto text = print_hand_eye(sample(setup));
    ASSERT_TRUE(text.has_value()) << text.error().message;
    const bool in_hand = setup == EyeSetup::kInHand;
    EXPECT_NE(text->find(in_hand ? "\"hand_from_camera\"" : "\"base_from_camera\""),
              std::string::npos);
    EXPECT_NE(text->find(in_hand ? "\"base_from_board\"" : "\"hand_from_board\""),
              std::string::npos);
    const auto read = parse_hand_eye(*text);
    ASSERT_TRUE(read.has_value()) << read.error().message;
    EXPECT_EQ(print_hand_eye(*read).value(), *text);
    EXPECT_EQ(read->setup, setup);
    EXPECT_EQ(read->calibration.camera, "wr\"ist");
    EXPECT_EQ(read->mount_from_camera.rotation, sample(setup).mount_from_camera.rotation);
    EXPECT_EQ(read->carrier_from_board.translation, sample(setup).carrier_from_board.translation);
    EXPECT_EQ(read->mount_covariance, sample(setup).mount_covariance);
    EXPECT_EQ(read->loop_place, 1.0 / 3000);
    EXPECT_EQ(read->scale.value().value, 0.988);
    EXPECT_EQ(read->aspect.value().value, 1.002);
    EXPECT_EQ(read->aspect.value().sigma, 0.0003);
    EXPECT_EQ(read->remarks, sample(setup).remarks);
  }
}

TEST(HandEyeFile, MayLackTheScaleAndCovariances) {
  HandEye bare = sample(EyeSetup::kInHand);
  bare.scale.reset();
  bare.aspect.reset();
  bare.rms.reset();
  bare.mount_covariance.clear();
  bare.carrier_covariance.clear();
  const auto read = parse_hand_eye(print_hand_eye(bare).value());
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_FALSE(read->scale.has_value());
  EXPECT_FALSE(read->rms.has_value());
  EXPECT_TRUE(read->mount_covariance.empty());
}

TEST(HandEyeFile, GoesToADiskAndBack) {
  TemporaryFolder folder;
  const std::string path = folder.path("hand_eye.json");
  ASSERT_TRUE(write_hand_eye(path, sample(EyeSetup::kInHand)).has_value());
  EXPECT_TRUE(read_hand_eye(path).has_value());
  EXPECT_EQ(read_hand_eye(folder.path("none.json")).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(write_hand_eye(folder.path("none/a.json"), sample(EyeSetup::kInHand)).has_value());
  HandEye broken = sample(EyeSetup::kInHand);
  broken.calibration.image_size = {};
  EXPECT_FALSE(print_hand_eye(broken).has_value());
}

// A text with one thing changed, and a word of what is said.
TEST(HandEyeFile, SaysWhatIsWrong) {
  const std::string good = print_hand_eye(sample(EyeSetup::kInHand)).value();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  const std::pair<std::string, const char*> wrong[] = {
      {"", "empty"},
      {"[]", "none of the fields"},
      {with("calvin-hand-eye", "calvin-rig"), "calvin-rig"},
      {with("\"version\": 1", "\"version\": 2"), "newer version"},
      {with("\"in-hand\"", "\"on-hand\""), "in-hand"},
      {with("\"in-hand\"", "\"to-hand\""), "base_from_camera"},
      {with("\"fx\": 536.1", "\"fx\": -1"), "fx"},
      {with("\"rotation\"", "\"turn\""), "rotation"},
      {with("0.12", "1e300"), "out of range"},
      {with("\"loop\"", "\"loops\""), "loop"},
  };
  for (const auto& [text, word] : wrong) {
    const auto read = parse_hand_eye(text, "hand_eye.json");
    ASSERT_FALSE(read.has_value()) << word;
    EXPECT_NE(read.error().message.find(word), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find("calvin-hand-eye has written"), std::string::npos);
  }
}

TEST(HandEyeFile, OfAnyBytesIsNone) {
  const std::string good = print_hand_eye(sample(EyeSetup::kInHand)).value();
  for (std::size_t i = 0; i < good.size(); i += 7) {
    EXPECT_FALSE(parse_hand_eye(good.substr(0, i)).has_value());
    std::string broken = good;
    broken[i] = '\x01';
    EXPECT_FALSE(parse_hand_eye(broken).has_value());
  }
}

}  // namespace
}  // namespace calvin
