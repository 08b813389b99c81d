// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Files with the poses of a robot: every form that is read gives the same pose, and what is wrong
// in a line is said with its number.
#include <cmath>
#include <fstream>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/io/robot_poses.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

// A third of a turn about (1, 1, 1), at 0.1 -0.2 0.3 m.
void expect_sample(const RobotPose& pose) {
  const SE3 found = to_se3(pose.base_from_hand);
  Eigen::Matrix3d rotation;
  rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  EXPECT_LT((found.rotation - rotation).norm(), 1e-12);
  EXPECT_LT((found.translation - Eigen::Vector3d(0.1, -0.2, 0.3)).norm(), 1e-12);
}

TEST(RobotPoses, AreReadInEveryForm) {
  const char* forms[] = {
      "0.1 -0.2 0.3 0.5 0.5 0.5 0.5",
      "0.1,-0.2,0.3,0.5,0.5,0.5,0.5\r",
      "+0.1; -0.2;\t3e-1 ; -0.5;-0.5;-0.5;-0.5  # turned",
      "\n# poses of a robot\n  0.1, -0.2, 0.3, 0.5, 0.5, 0.5, 0.5\n\n",
      "0 0 1 0.1 1 0 0 -0.2 0 1 0 0.3",
      "0,0,1,0.1, 1,0,0,-0.2, 0,1,0,0.3, 0,0,0,1",
      "# qw qx qy qz x y z\n0.5 0.5 0.5 0.5 0.1 -0.2 0.3",
      "z,y,x,qx,qy,qz,qw,error\n0.3,-0.2,0.1,0.5,0.5,0.5,0.5,none",
  };
  for (const char* form : forms) {
    const auto poses = parse_robot_poses(form);
    ASSERT_TRUE(poses.has_value()) << form << ": " << poses.error().message;
    ASSERT_EQ(poses->size(), 1U) << form;
    EXPECT_TRUE(poses->front().name.empty()) << form;
    EXPECT_FALSE(poses->front().time.has_value()) << form;
    expect_sample(poses->front());
  }
}

TEST(RobotPoses, HaveNamesOrTimes) {
  const auto named = parse_robot_poses(
      "a/left 1.png 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\nb.png 0 0 1 0.1 1 0 0 -0.2 0 1 0 0.3\n");
  EXPECT_FALSE(named.has_value());
  const auto poses = parse_robot_poses(
      "a/left-1.png 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\nb.png 0 0 1 0.1 1 0 0 -0.2 0 1 0 0.3\n");
  ASSERT_TRUE(poses.has_value()) << poses.error().message;
  EXPECT_EQ(poses->at(0).name, "a/left-1.png");
  EXPECT_EQ(poses->at(1).name, "b.png");
  const auto timed = parse_robot_poses(
      "# timestamp tx ty tz qx qy qz qw\n1305031102.1753 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n"
      "1305031102.2753 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n");
  ASSERT_TRUE(timed.has_value()) << timed.error().message;
  ASSERT_EQ(timed->size(), 2U);
  EXPECT_EQ(timed->at(1).time, 1305031102.2753);
  const auto bare = parse_robot_poses("7 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n");
  ASSERT_TRUE(bare.has_value()) << bare.error().message;
  EXPECT_EQ(bare->front().time, 7);
  EXPECT_EQ(bare->front().name, "7");
  for (const auto& list : {*poses, *timed, *bare}) {
    for (const RobotPose& pose : list) expect_sample(pose);
  }
}

TEST(RobotPoses, SayWhatIsWrongAndWhere) {
  const std::string good = "0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n";
  const std::pair<std::string, const char*> wrong[] = {
      {"", "no pose"},
      {"# nothing\n\n", "no pose"},
      {good + "0.1 -0.2 0.3 0.5 0.5 0.5\n", "line 2 has 6 numbers"},
      {good + "0.1 -0.2 0.3 0.5 0.5 0.5 0.5 1 2\n", "line 2 has 9 numbers"},
      {good + "0.1 -0.2 nan 0.5 0.5 0.5 0.5\n", "line 2 has 'nan'"},
      {good + "0.1 -0.2 0,3 x 0.5 0.5 0.5 0.5\n", "'x', which is no number"},
      {good + "0.1 -0.2 0.3 0.5 0.5 0.5 0\n", "length 0.866"},
      {good + "0.1 -0.2 0.3 0 0 0 0\n", "length 0"},
      {good + "2e6 -0.2 0.3 0.5 0.5 0.5 0.5\n", "metres"},
      {"0 0 1 0.1 1 0 0 -0.2 0 1 1 0.3", "no rotation"},
      {"0 0 1 0.1 1 0 0 -0.2 0 -1 0 0.3", "mirrors"},
      {"0 0 1 0.1 1 0 0 -0.2 0 1 0 0.3 0 0 1 1", "no rotation"},
      {"a.png " + good + "a.png " + good, "line 2 has 'a.png'"},
      {"# x y z qw qx qy qz\nb.png " + good, "line 2 has 8 columns"},
      {std::string("\0\0\0", 3), "0 numbers"},
  };
  for (const auto& [text, word] : wrong) {
    const auto read = parse_robot_poses(text, "poses.txt");
    ASSERT_FALSE(read.has_value()) << word;
    EXPECT_EQ(read.error().code, ErrorCode::kMalformed);
    EXPECT_NE(read.error().message.find(word), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find("poses.txt"), std::string::npos);
  }
}

// Any byte in any place: what is read is finite, and an error has a message.
TEST(RobotPoses, OfAnyBytesAreFiniteOrRefused) {
  const std::string good =
      "# name x y z qw qx qy qz\na.png 0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n"
      "b.png,1e-3;2,3,0,0,0,-1\n";
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (const char byte : {'\0', '\n', '#', ',', '9', 'e', '-', '\xFF'}) {
      std::string text = good;
      text[i] = byte;
      const auto poses = parse_robot_poses(text);
      if (!poses) {
        EXPECT_FALSE(poses.error().message.empty());
        continue;
      }
      for (const RobotPose& pose : *poses) {
        for (const double x : pose.base_from_hand.rotation) EXPECT_TRUE(std::isfinite(x));
        for (const double x : pose.base_from_hand.translation) EXPECT_TRUE(std::isfinite(x));
      }
    }
  }
}

TEST(RobotPoses, AreReadFromADisk) {
  TemporaryFolder folder;
  const std::string path = folder.path("poses.txt");
  std::ofstream(path) << "0.1 -0.2 0.3 0.5 0.5 0.5 0.5\n";
  EXPECT_TRUE(read_robot_poses(path).has_value());
  EXPECT_EQ(read_robot_poses(folder.path("none.txt")).error().code, ErrorCode::kNotFound);
}

// Excel's "CSV UTF-8" and Notepad begin a file with it.
TEST(RobotPoses, MayBeginWithAByteOrderMark) {
  for (const std::string first :
       {"0.1 0.2 0.3 0 0 0 1\n", "name,x,y,z,qw,qx,qy,qz\na.png,0.1,0.2,0.3,1,0,0,0\n"}) {
    const auto poses = parse_robot_poses("\xEF\xBB\xBF" + first);
    ASSERT_TRUE(poses) << poses.error().message;
    ASSERT_EQ(poses->size(), 1U);
    EXPECT_EQ(poses->front().name, first.starts_with('n') ? "a.png" : "");
    EXPECT_NEAR(poses->front().base_from_hand.translation[2], 0.3, 1e-12);
  }
}

}  // namespace
}  // namespace calvin
