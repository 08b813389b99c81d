// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Board texts, control points, symmetries.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/target/board.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr const char* kRight = "checkerboard:9x6:25mm";

TEST(Board, TheDefaultIsRight) {
  const auto board = parse_board(kDefaultBoard);
  ASSERT_TRUE(board.has_value());
  EXPECT_EQ(board->as<Checkerboard>()->cols, 9);
  EXPECT_EQ(board->as<Checkerboard>()->rows, 6);
  EXPECT_DOUBLE_EQ(board->cell_size(0), 0.025);
}

// What others moved from is a board still.
TEST(Board, IsAValue) {
  Board board = parse_board(kRight).value();
  const Board taken = std::move(board);
  EXPECT_EQ(taken.text(), kRight);
  EXPECT_EQ(board.text(), kRight);  // NOLINT: what is left is looked at
  EXPECT_EQ(taken, parse_board(kRight).value());
  EXPECT_NE(taken, Board{});
  EXPECT_EQ(Board{}, Board(Checkerboard{}));
  EXPECT_EQ(Board{}.point_count(), 0);
}

TEST(Board, UnitsAndCanonicalText) {
  const std::vector<std::pair<const char*, const char*>> cases = {
      {"checkerboard:9x6:25mm", "checkerboard:9x6:25mm"},
      {" checkerboard : 9 x 6 : 2.5 cm ", "checkerboard:9x6:25mm"},
      {"checkerboard:9x6:0.025m", "checkerboard:9x6:25mm"},
      {"checkerboard:9x6:25000um", "checkerboard:9x6:25mm"},
      {"checkerboard:9x6:+2.5e1mm", "checkerboard:9x6:25mm"},
      {"checkerboard:9x6:1in", "checkerboard:9x6:25.4mm"},
      {"checkerboard:3x2:1um", "checkerboard:3x2:0.001mm"},
      {"checkerboard:2x3:1000m", "checkerboard:2x3:1000000mm"},
      {"checkerboard:200x200:33.3mm", "checkerboard:200x200:33.3mm"},
      {"checkerboard:9x6:25mm:circles", "checkerboard:9x6:25mm:circles"},
      {"checkerboard:9x6:25mm:circles=4.4+5.3+4.3", "checkerboard:9x6:25mm:circles"},
      {"checkerboard:16x14:10mm: circles = 2.1+1.1+1.2",
       "checkerboard:16x14:10mm:circles=1.1+2.1+1.2"},
      {"puzzle:14x9:20mm", "puzzle:14x9:20mm"},
      {" puzzle : 14 x 9 : 2 cm : 0 , 0 ", "puzzle:14x9:20mm"},
      {"puzzle:3x3:1in:500,0", "puzzle:3x3:25.4mm:500,0"},
  };
  for (const auto& [text, canonical] : cases) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    const auto again = parse_board(board->text());
    ASSERT_TRUE(again.has_value()) << board->text();
    EXPECT_NEAR(again->cell_size(0), board->cell_size(0), 1e-9) << text;
  }
}

TEST(Board, TextsOfCharucoBoards) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no markers";
  for (const auto& [text, canonical] : {
           std::pair{"charuco:5x7:40mm:20mm:DICT_6X6_250", "charuco:5x7:40mm:20mm:DICT_6X6_250"},
           {"charuco : 5 x 7 : 4cm : 0.02m : DICT_6X6_250 : legacy",
            "charuco:5x7:40mm:20mm:DICT_6X6_250:legacy"},
           {"charuco:3x3:40mm:39.9mm:DICT_4X4_50:inverted:legacy",
            "charuco:3x3:40mm:39.9mm:DICT_4X4_50:legacy:inverted"},
           {"charuco:10x10:1in:.5in:DICT_4X4_50", "charuco:10x10:25.4mm:12.7mm:DICT_4X4_50"},
       }) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    EXPECT_EQ(parse_board(canonical).value().text(), canonical);
  }
  const Board board = parse_board("charuco:5x7:40mm:20mm:DICT_6X6_250").value();
  EXPECT_EQ(board.point_count(), 24) << "the inner corners of 5 by 7 squares";
  EXPECT_EQ(board.as<CharucoBoard>()->marker_count(), 17);
}

TEST(Board, TextsOfGridsOfTags) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no markers";
  for (const auto& [text, canonical] : {
           std::pair{"aruco:5x7:4cm:10mm:DICT_6X6_250", "aruco:5x7:40mm:10mm:DICT_6X6_250"},
           {"aruco : 5x7:40mm:10mm:DICT_6X6_250:inverted:first=12:border=1",
            "aruco:5x7:40mm:10mm:DICT_6X6_250:first=12:inverted"},
           {"aruco:1x1:40mm:10mm:DICT_4X4_50:border=2", "aruco:1x1:40mm:10mm:DICT_4X4_50:border=2"},
           {"apriltag:36h11:4x3:80mm:0.02m", "apriltag:tag36h11:4x3:80mm:20mm"},
           {"apriltag:t25h9:4x3:80mm:20mm:first=3", "apriltag:tag25h9:4x3:80mm:20mm:first=3"},
           {"apriltag:DICT_APRILTAG_16h5:2x2:80mm:20mm", "apriltag:tag16h5:2x2:80mm:20mm"},
       }) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    EXPECT_EQ(parse_board(canonical).value().text(), canonical);
  }
  const Board board = parse_board("aruco:4x5:37.5mm:5mm:DICT_6X6_1000:first=2").value();
  EXPECT_EQ(board.point_count(), 80) << "four corners of each tag";
  const auto* tags = board.as<TagGrid>();
  EXPECT_EQ(tags->tag_in(3, 1), 9) << "rows of tags are counted from the uppermost";
  EXPECT_EQ(tags->place_of(9), (GridPlace{3, 1}));
  EXPECT_FALSE(tags->place_of(1) || tags->place_of(22));
  EXPECT_NEAR(board.points()[1].x(), 0.0375, 1e-12);
  EXPECT_NEAR(board.points()[2].x(), 0.0425, 1e-12);
  // The same code stands on its head where it is called an ArUco marker: AprilTag's own picture of
  // the tag 0 begins with these bits.
  const Board upright = parse_board("apriltag:tag36h11:1x1:80mm:20mm").value();
  const auto* april = upright.as<TagGrid>();
  const std::string_view bits = "110101011101";
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(april->is_light(0, i % 6, i / 6), bits[static_cast<std::size_t>(i)] == '1') << i;
  }
}

TEST(Board, TextsOfAprilGrids) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no markers";
  for (const auto& [text, canonical] : {
           std::pair{"aprilgrid:6x6:88mm:0.3", "aprilgrid:6x6:88mm:0.3"},
           {"aprilgrid : 6 x 7 : 8.8cm : 0.30 : border = 2 : first = 0", "aprilgrid:6x7:88mm:0.3"},
           {"aprilgrid:6x6:88mm:0.3:t36h11", "aprilgrid:6x6:88mm:0.3"},
           {"aprilgrid:6x6:88mm:0.3:first=36:border=1", "aprilgrid:6x6:88mm:0.3:border=1:first=36"},
           {"aprilgrid:2x3:1in:.25:25h9", "aprilgrid:2x3:25.4mm:0.25:tag25h9"},
           {"aprilgrid:2x3:25mm:0.25:DICT_APRILTAG_16h5", "aprilgrid:2x3:25mm:0.25:tag16h5"},
           {"aprilgrid:2x3:25mm:0.25:DICT_4X4_50", "aprilgrid:2x3:25mm:0.25:DICT_4X4_50"},
       }) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    EXPECT_EQ(parse_board(canonical).value().text(), canonical);
  }
  const Board board = parse_board("aprilgrid:6x4:100mm:0.3").value();
  EXPECT_EQ(board.point_count(), 96) << "four corners of each tag";
  EXPECT_EQ(board.as<AprilGrid>()->tag_in(0, 3), 0) << "rows of tags are counted from the lowest";
  EXPECT_EQ(board.as<AprilGrid>()->tag_in(5, 0), 23);
  EXPECT_NEAR(board.points()[2].x(), 0.13, 1e-12);
  EXPECT_NEAR(board.points()[95].x(), 5 * 0.13 + 0.1, 1e-12);
  EXPECT_NEAR(board.outline().left, -0.03, 1e-12) << "the outermost dark squares belong to it";
  EXPECT_NEAR(board.outline().bottom, 4 * 0.13, 1e-12);
}

// To a nanometre: a thousandth of a micrometre over ten squares is nothing, a micrometre is not.
TEST(Board, TheTextKeepsTheLength) {
  for (const char* text : {"checkerboard:9x6:0.3334in", "checkerboard:9x6:25.4005mm",
                           "checkerboard:9x6:0.0248012345m"}) {
    const Board board = parse_board(text).value();
    EXPECT_NEAR(parse_board(board.text()).value().cell_size(0), board.cell_size(0), 0.51e-9)
        << board.text();
  }
}

TEST(Board, LengthsInEveryUnit) {
  EXPECT_DOUBLE_EQ(*parse_length("25mm"), 0.025);
  EXPECT_DOUBLE_EQ(*parse_length("2.5cm"), 0.025);
  EXPECT_DOUBLE_EQ(*parse_length("250um"), 0.00025);
  EXPECT_DOUBLE_EQ(*parse_length("1m"), 1);
  EXPECT_DOUBLE_EQ(*parse_length("10 in"), 0.254);
  for (const char* wrong : {"", "mm", "25", "25ft", "25 m m", "-1mm", "+-1mm", "0mm", "nanm",
                            "infm", "1e999m", "0x10mm", "1,5mm"}) {
    EXPECT_FALSE(parse_length(wrong).has_value()) << wrong;
  }
}

void expect_refused(const std::string& text, const std::string& what_is_said) {
  const auto board = parse_board(text);
  ASSERT_FALSE(board.has_value()) << text;
  EXPECT_EQ(board.error().code, ErrorCode::kInvalidArgument) << text.substr(0, 80);
  EXPECT_NE(board.error().message.find(what_is_said), std::string::npos) << board.error().message;
  EXPECT_LT(board.error().message.size(), 1000u) << board.error().message;
}

TEST(Board, EveryWrongTextShowsARightOne) {
  const std::string endless(100000, 'x');
  for (const std::string& wrong : std::vector<std::string>{"",
                                                           ":",
                                                           "checkerboard",
                                                           "checkerboard:9x6",
                                                           "checkerboard:9x6:25mm:more",
                                                           "chessboard:9x6:25mm",
                                                           "Checkerboard:9x6:25mm",
                                                           "spot",
                                                           "checkerboard:9:25mm",
                                                           "checkerboard:9x6x2:25mm",
                                                           "checkerboard:9*6:25mm",
                                                           "checkerboard:9.5x6:25mm",
                                                           "checkerboard:1x6:25mm",
                                                           "checkerboard:2x2:25mm",
                                                           "checkerboard:201x6:25mm",
                                                           "checkerboard:-9x-6:25mm",
                                                           "checkerboard:9x+-6:25mm",
                                                           "checkerboard:99999999999x6:25mm",
                                                           "checkerboard:65536x65536:25mm",
                                                           "checkerboard:9x6:25",
                                                           "checkerboard:9x6:0mm",
                                                           "checkerboard:9x6:-25mm",
                                                           "checkerboard:9x6:+-25mm",
                                                           "checkerboard:9x6:nanmm",
                                                           "checkerboard:9x6:infm",
                                                           "checkerboard:9x6:1001m",
                                                           "checkerboard:9x6:0.5um",
                                                           "checkerboard:9x6:25,0mm",
                                                           "boards.json",
                                                           "checkerboard:9x6:25mm\n\n",
                                                           endless,
                                                           endless + ":9x6:25mm"}) {
    if (wrong.ends_with("\n")) {
      EXPECT_TRUE(parse_board(wrong).has_value()) << "white space at the end is nobody's mistake";
      continue;
    }
    expect_refused(wrong, kRight);
  }
}

TEST(Board, EveryWrongTextOfAPuzzleBoardShowsARightOne) {
  for (const char* wrong :
       {"puzzle", "puzzle:", "puzzle:14x9", "puzzle:14:20mm", "puzzle:2x9:20mm", "puzzle:14x9:20",
        "puzzle:201x9:20mm", "puzzle:14x9:0mm", "puzzle:14x9:20mm:", "puzzle:14x9:20mm:1",
        "puzzle:14x9:20mm:1,2,3", "puzzle:14x9:20mm:501,0", "puzzle:14x9:20mm:0,501",
        "puzzle:14x9:20mm:-1,0", "puzzle:14x9:20mm:1.5,0", "puzzle:14x9:20mm:1,0:more"}) {
    expect_refused(wrong, "puzzle:14x9:20mm");
  }
}

TEST(Board, EveryWrongTextOfACharucoBoardShowsARightOne) {
  const std::string right = "charuco:5x7:40mm:20mm:DICT_6X6_250";
  for (const std::string wrong :
       {"charuco", "charuco:5x7", "charuco:5x7:40mm", "charuco:5x7:40mm:20mm",
        "charuco:2x7:40mm:20mm:DICT_6X6_250", "charuco:5x7:40:20mm:DICT_6X6_250",
        "charuco:5x7:40mm:20:DICT_6X6_250", "charuco:5x7:40mm:40mm:DICT_6X6_250",
        "charuco:5x7:40mm:50mm:DICT_6X6_250", "charuco:5x7:40mm:20mm:",
        "charuco:5x7:40mm:20mm:DICT_6X6_251", "charuco:5x7:40mm:20mm:6X6_250",
        "charuco:5x7:40mm:20mm:DICT_6X6_250:", "charuco:5x7:40mm:20mm:DICT_6X6_250:old",
        "charuco:11x10:40mm:20mm:DICT_4X4_50"}) {
    expect_refused(wrong, right);
  }
  if (!has_opencv_dictionaries()) {
    expect_refused(right, "made without OpenCV");
    return;
  }
  EXPECT_NE(parse_board("charuco:5x7:40mm:20mm:X").error().message.find("DICT_ARUCO_ORIGINAL"),
            std::string::npos);
  EXPECT_NE(parse_board("charuco:11x10:40mm:20mm:DICT_4X4_50").error().message.find("55 markers"),
            std::string::npos);
}

TEST(Board, EveryWrongTextOfAnAprilGridShowsARightOne) {
  const std::string right = "aprilgrid:6x6:88mm:0.3";
  for (const std::string wrong :
       {"aprilgrid", "aprilgrid:6x6", "aprilgrid:6x6:88mm", "aprilgrid:6:88mm:0.3",
        "aprilgrid:1x6:88mm:0.3", "aprilgrid:6x6:88:0.3", "aprilgrid:6x6:88mm:26mm",
        "aprilgrid:6x6:88mm:0", "aprilgrid:6x6:88mm:1", "aprilgrid:6x6:88mm:nan",
        "aprilgrid:6x6:88mm:0.3:", "aprilgrid:6x6:88mm:0.3:tag99h9",
        "aprilgrid:6x6:88mm:0.3:border=3",
        "aprilgrid:6x6:88mm:0.3:border=", "aprilgrid:6x6:88mm:0.3:first=-1",
        "aprilgrid:6x6:88mm:0.3:first=552", "aprilgrid:6x6:88mm:0.3:tag25h9:first=2147483647"}) {
    expect_refused(wrong, right);
  }
  if (marker_dictionaries().empty()) {
    expect_refused(right, "made without OpenCV");
    return;
  }
  EXPECT_NE(
      parse_board("aprilgrid:6x6:88mm:0.3:first=552").error().message.find("36 tags from 552"),
      std::string::npos);
}

TEST(Board, EveryWrongTextOfAGridOfTagsShowsARightOne) {
  const std::string aruco = "aruco:5x7:40mm:10mm:DICT_6X6_250";
  const std::string april = "apriltag:tag36h11:5x7:40mm:10mm";
  for (const std::string wrong :
       {"aruco", "aruco:5x7", "aruco:5x7:40mm:10mm", "aruco:5x7:40mm:DICT_6X6_250",
        "aruco:0x7:40mm:10mm:DICT_6X6_250", "aruco:5x7:40mm:0.25:DICT_6X6_250",
        "aruco:5x7:40mm:1mm:DICT_6X6_250", "aruco:5x7:40mm:10mm:DICT_9X9_250",
        "aruco:5x7:40mm:10mm:DICT_6X6_250:border=3", "aruco:5x7:40mm:10mm:DICT_6X6_250:first=",
        "aruco:5x7:40mm:10mm:DICT_6X6_250:first=216", "aruco:5x7:40mm:10mm:DICT_6X6_250:first=-1",
        "aruco:5x7:40mm:10mm:DICT_6X6_250:upright", "aruco:5x7:40mm:10mm:DICT_6X6_250:"}) {
    expect_refused(wrong, aruco);
  }
  for (const std::string wrong :
       {"apriltag", "apriltag:tag36h11", "apriltag:5x7:40mm:10mm:tag36h11",
        "apriltag:tag41h12:5x7:40mm:10mm", "apriltag:tag16h5:5x7:40mm:10mm",
        "apriltag:tag36h11:5x7:40mm:nan", "apriltag:tag36h11:5x7:40mm:10mm:border=0"}) {
    expect_refused(wrong, april);
  }
  if (!has_opencv_dictionaries()) expect_refused(aruco, "made without OpenCV");
}

TEST(Board, ALightIsOnePointWithoutMeasures) {
  const Board board = parse_board(" dot ").value();
  EXPECT_EQ(board.text(), "dot");
  ASSERT_NE(board.as<PointLight>(), nullptr);
  EXPECT_EQ(board.ids(), std::vector<int>{0});
  EXPECT_EQ(board.points().front(), Eigen::Vector3d(0, 0, 0));
  EXPECT_FALSE(board.grid().has_value());
  EXPECT_TRUE(board.neighbours(0).empty());
  for (const char* wrong : {"dot:", "dot:5mm", "dot:1x1:25mm"}) expect_refused(wrong, "dot");
}

TEST(Board, AWandIsLightsOnALine) {
  const Board board = parse_board("wand:15cm+350mm").value();
  EXPECT_EQ(board.text(), "wand:150mm+350mm");
  EXPECT_EQ(board.ids(), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(board.points()[1], Eigen::Vector3d(0.15, 0, 0));
  EXPECT_NEAR(board.points()[2].x(), 0.5, 1e-15);
  EXPECT_EQ(board.neighbours(1), (std::vector<int>{0, 2}));
  EXPECT_EQ(board.cell_size(1), 0.15);
  EXPECT_EQ(parse_board("wand:500mm").value().point_count(), 2);
  EXPECT_FALSE(board.looks_like(parse_board("dot").value()));
  EXPECT_FALSE(board == parse_board("wand:150mm+351mm").value());
  for (const char* wrong : {"wand", "wand:", "wand:500", "wand:-5mm", "wand:5mm+", "wand:1mm:2mm",
                            "wand:1mm+1mm+1mm+1mm+1mm+1mm+1mm+1mm"}) {
    expect_refused(wrong, "wand:150mm+350mm");
  }
}

TEST(Board, AGridThatGoesOnBeyondThePictureHasADistanceAlone) {
  const Board dots = parse_board("dots:1mm").value();
  const Board lines = parse_board("lines:2.5cm:inverted").value();
  EXPECT_EQ(dots.text(), "dots:1mm");
  EXPECT_EQ(lines.text(), "lines:25mm:inverted");
  EXPECT_EQ(dots.grid()->pitch, 0.001);
  EXPECT_EQ(dots.symmetries().size(), 3u);
  EXPECT_TRUE(dots.looks_like(parse_board("dots:7mm").value()));
  EXPECT_FALSE(dots.looks_like(parse_board("dots:1mm:inverted").value()));
  EXPECT_FALSE(dots.looks_like(parse_board("lines:1mm").value()));
  EXPECT_NE(parse_board("dots:10x8:1mm").value().as<CircleGrid>(), nullptr);
  for (const char* wrong : {"dots", "dots:", "dots:1", "dots:1mm:rings=2.2", "dots:0mm"}) {
    expect_refused(wrong, "dots:1mm");
  }
  for (const char* wrong : {"lines", "lines:5x4:1mm", "lines:1mm:big=0.0", "lines:grid.txt"}) {
    expect_refused(wrong, "lines:1mm");
  }
}

TEST(Board, ErrorsAreOneLine) {
  const std::string message = parse_board("checker\nboard\x1b[31m").error().message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

TEST(Board, PointsInTheOrderOfTheirIds) {
  const Board board = Checkerboard{4, 3, 0.1};
  const auto points = board.points();
  ASSERT_EQ(points.size(), 12u);
  EXPECT_EQ(points[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_LT((points[3] - Eigen::Vector3d(0.3, 0, 0)).norm(), 1e-15) << "x runs along a row";
  EXPECT_LT((points[4] - Eigen::Vector3d(0, 0.1, 0)).norm(), 1e-15) << "y runs down the columns";
  EXPECT_LT((points[11] - Eigen::Vector3d(0.3, 0.2, 0)).norm(), 1e-15);
}

// The colours of the squares around the control points, turned by quarter turns.
std::set<std::string> symmetries_by_turning(int cols, int rows) {
  const auto dark = [](int i, int j) { return (i + j) % 2 == 0; };
  std::set<std::string> found;
  for (const int turns : {1, 2, 3}) {
    if (turns != 2 && cols != rows) continue;
    bool same = true;
    for (int j = 0; j <= rows; ++j) {
      for (int i = 0; i <= cols; ++i) {
        int u = i;
        int v = j;
        for (int t = 0, w = cols, h = rows; t < turns; ++t, std::swap(w, h)) {
          const int turned = w - u;
          u = v;
          v = turned;
        }
        same = same && dark(i, j) == dark(u, v);
      }
    }
    if (same) found.insert("rotate" + std::to_string(90 * turns));
  }
  return found;
}

TEST(Board, SymmetriesAreThoseOfTheColours) {
  for (int cols = 2; cols < 8; ++cols) {
    for (int rows = 2; rows < 8; ++rows) {
      std::set<std::string> names;
      for (const Relabelling& turn : Checkerboard{cols, rows, 0.1}.symmetries()) {
        names.insert(to_text(turn));
      }
      EXPECT_EQ(names, symmetries_by_turning(cols, rows)) << cols << "x" << rows;
    }
  }
}

}  // namespace
}  // namespace calvin
