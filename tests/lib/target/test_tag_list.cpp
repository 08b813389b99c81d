// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Lists of tags: their texts, and where their corners are.
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include "calvin/target/board.hpp"
#include "calvin/target/marker_dictionary.hpp"

namespace calvin {
namespace {

TEST(TagList, HasATextAndCornersByTheIdsOfItsTags) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no markers";
  for (const auto& [text, canonical] : {
           std::pair{"apriltag:36h11:80mm:3=0,0", "apriltag:tag36h11:80mm:3=0,0"},
           {"apriltag : tag36h11 : 8cm : 7 = 250 mm , -1cm , 90 + 3 / 12cm = 0 , 0 : inverted",
            "apriltag:tag36h11:80mm:3/120mm=0,0+7=250mm,-10mm,90:inverted"},
           {"aruco:80mm:3=0,0,0,0,0,-45+4/80mm=0,0.3m,1m,0,0,0:DICT_4X4_50:border=2",
            "aruco:80mm:3=0,0,-45+4=0,300mm,1000mm,0,0,0:DICT_4X4_50:border=2"},
       }) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    EXPECT_EQ(parse_board(canonical).value().text(), canonical);
  }
  const Board board = parse_board("apriltag:tag36h11:80mm:3=0,0+7/20mm=250mm,-10mm,90").value();
  EXPECT_EQ(board.ids(), (std::vector<int>{12, 13, 14, 15, 28, 29, 30, 31}));
  const auto points = board.points();
  EXPECT_TRUE(points[0].isApprox(Eigen::Vector3d(-0.04, -0.04, 0)));
  EXPECT_TRUE(points[2].isApprox(Eigen::Vector3d(0.04, 0.04, 0)));
  EXPECT_TRUE(points[4].isApprox(Eigen::Vector3d(0.26, -0.02, 0))) << "turned clockwise";
  EXPECT_EQ(board.neighbours(28), (std::vector<int>{29, 31}));
  EXPECT_NEAR(board.cell_size(28), 0.02, 1e-12);
  EXPECT_FALSE(board.index_of(16) || board.index_of(-1));
  // Of one tag two lists cannot both be.
  EXPECT_TRUE(board.looks_like(parse_board("apriltag:tag36h11:10mm:7=0,0+9=1m,1m").value()));
  EXPECT_FALSE(board.looks_like(parse_board("apriltag:tag36h11:80mm:4=0,0").value()));
  for (const auto& [text, why] :
       {std::pair{"apriltag:tag36h11:80mm", "tags with their places"},
        {"apriltag:tag36h11:80mm:3", "not ID=X,Y"},
        {"apriltag:tag36h11:80mm:3=0", "none of X,Y"},
        {"apriltag:tag36h11:80mm:3=0,5", "not a length"},
        {"apriltag:tag36h11:80mm:3=0,0,400", "degrees"},
        {"apriltag:tag36h11:80mm:3=0,0+3=1m,1m", "given twice"},
        {"apriltag:tag36h11:80mm:3=0,0+4=70mm,0", "lie over each other"},
        {"apriltag:tag36h11:80mm:600=0,0", "has no tag 600, but 0 to 586"},
        {"apriltag:tag36h11:80mm:3=0,0:first=3", "none of 'border='"},
        {"aruco:80mm:3=0,0:DICT_NONE", "no dictionary 'DICT_NONE'"},
        {"apriltag:tag36h11:80mm:3=0,2000m", "farther away"}}) {
    const auto refused = parse_board(text);
    ASSERT_FALSE(refused) << text;
    EXPECT_NE(refused.error().message.find(why), std::string::npos) << refused.error().message;
    EXPECT_NE(refused.error().message.find("A right text is"), std::string::npos);
  }
}

// The sides of a cube: the corners of a side are seen clockwise from outside.
TEST(TagList, LiesInSpace) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no markers";
  const Board cube =
      parse_board(
          "aruco:80mm:5=0,0,-65mm,0,0,0+6=65mm,0,0,0,-90,0+8=0,-65mm,0,-90,0,0:DICT_5X5_100")
          .value();
  const auto points = cube.points();
  const Eigen::Vector3d middles[] = {{0, 0, -0.065}, {0.065, 0, 0}, {0, -0.065, 0}};
  for (std::size_t tag = 0; tag < 3; ++tag) {
    const auto* p = &points[4 * tag];
    EXPECT_TRUE(((p[0] + p[1] + p[2] + p[3]) / 4).isApprox(middles[tag])) << tag;
    const Eigen::Vector3d inwards = (p[1] - p[0]).cross(p[3] - p[0]);
    EXPECT_LT(inwards.dot(middles[tag]), 0) << tag;
  }
}

}  // namespace
}  // namespace calvin
