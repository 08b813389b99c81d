// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards that nobody asked for are named by their own text: of any kind, whichever way they lie,
// and in a mirror. Where there is none, nothing is named.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/board_identifier.hpp"
#include "calvin/detect/identify.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/marker_dictionary.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr double kSide = 0.025;  // m

// A board in the middle of a picture, turned about its normal.
GrayImage picture_of(const Board& board, double turn) {
  const BoardArea area = board.extent();
  const Eigen::Vector3d middle((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
  const Eigen::Matrix3d rotation = exp_so3({0.2, -0.1, turn});
  const BoardArea all = board.outline();
  const double away = 1.05 * std::hypot(all.width(), all.height());
  const SE3 pose = {rotation, Eigen::Vector3d(0, 0, away) - rotation * middle};
  return render_board(default_camera({1280, 960}), board, pose, {.noise = 2, .blur = 0.7});
}

GrayImage mirrored(GrayImage image) {
  for (int row = 0; row < image.height; ++row) {
    const auto begin = image.pixels.begin() + static_cast<std::ptrdiff_t>(row) * image.width;
    std::reverse(begin, begin + image.width);
  }
  return image;
}

// What is said to be in view; "" where nothing is, "~" in front of what is in a mirror.
std::string first_of(const GrayImage& image) {
  const auto seen = identify_boards(image.view(), kSide);
  if (seen.empty()) return "";
  std::string text = seen.front().board.text();
  if (seen.front().mirrored) text.insert(0, 1, '~');
  return seen.front().whole ? text : text.append(" in part");
}

// The longer side of a checkerboard or of a grid of circles counts as a row; of dictionaries that
// begin with the same markers the smallest is named.
constexpr const char* kWithoutMarkers[] = {"checkerboard:9x6:25mm",
                                           "checkerboard:10x7:25mm",
                                           "checkerboard:8x5:25mm",
                                           "checkerboard:9x6:25mm:circles",
                                           "checkerboard:8x6:25mm:circles",
                                           "checkerboard:10x7:25mm:circles=1.1+2.1+1.2",
                                           "puzzle:9x6:25mm:250,411",
                                           "puzzle:14x9:25mm",
                                           "circles:7x5:25mm",
                                           "circles:8x6:25mm:inverted",
                                           "acircles:4x11:25mm",
                                           "acircles:3x7:25mm:inverted"};
constexpr const char* kWithMarkers[] = {"charuco:5x7:25mm:12.5mm:DICT_6X6_50",
                                        "charuco:5x7:25mm:15mm:DICT_4X4_50",
                                        "charuco:8x6:25mm:18.75mm:DICT_5X5_50",
                                        "charuco:6x8:25mm:20mm:DICT_7X7_50:legacy",
                                        "charuco:5x4:25mm:17.5mm:DICT_ARUCO_ORIGINAL",
                                        "charuco:7x8:25mm:18.75mm:DICT_6X6_50:legacy",
                                        "charuco:6x9:25mm:15mm:DICT_4X4_50:inverted",
                                        "charuco:4x4:25mm:20mm:DICT_4X4_50",
                                        "charuco:11x8:25mm:20mm:DICT_APRILTAG_36h11",
                                        "aprilgrid:6x6:25mm:0.3",
                                        "aprilgrid:4x3:25mm:0.3:first=12",
                                        "aprilgrid:5x4:25mm:0.3:tag25h9:border=1",
                                        "aprilgrid:4x4:25mm:0.2:border=1",
                                        "aruco:5x4:25mm:6.25mm:DICT_6X6_50",
                                        "aruco:6x5:25mm:10mm:DICT_4X4_50:first=9",
                                        "aruco:4x3:25mm:7.5mm:DICT_5X5_50:inverted",
                                        "aruco:4x4:25mm:6.25mm:DICT_APRILTAG_36h11:first=40",
                                        "apriltag:tag36h11:5x3:25mm:10mm:first=300"};

// Tags that touch, and some that do not.
constexpr const char* kOfAprilTag3[] = {
    "apriltag:tagStandard41h12:5x4:25mm:20mm:first=100",
    "apriltag:tagStandard52h13:3x4:25mm:16.666667mm:first=48000",
    "apriltag:tagCustom48h12:4x3:25mm:20mm:first=42000",
    "apriltag:tagCircle49h12:3x3:25mm:32.5mm:first=65000",
    "apriltag:tagCircle21h7:4x3:25mm:37.5mm:inverted"};

void expect_identified(const char* text) {
  const Board board = parse_board(text).value();
  for (const double turn : {0.1, 1.6, 3.3, 4.7}) {
    const auto seen = identify_boards(picture_of(board, turn).view(), kSide);
    ASSERT_FALSE(seen.empty()) << text << " " << turn;
    EXPECT_TRUE(seen.front().board == board) << seen.front().board.text() << " for " << text;
    EXPECT_FALSE(seen.front().mirrored);
    EXPECT_TRUE(seen.front().whole) << text << " " << turn;
  }
}

TEST(Identify, NamesBoardsWithoutMarkers) {
  for (const char* text : kWithoutMarkers) expect_identified(text);
}

TEST(Identify, NamesBoardsWithMarkers) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  for (const char* text : kWithMarkers) expect_identified(text);
}

TEST(Identify, NamesBoardsOfAprilTag3) {
  if (!has_april_tag_3()) GTEST_SKIP() << "made without libapriltag";
  for (const char* text : kOfAprilTag3) expect_identified(text);
}

// However far the tags of an AprilGrid are apart, and however it is held: its text is that of the
// board where it is said to be whole.
TEST(Identify, NamesAprilGridsByTheirGaps) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Camera camera = default_camera({1280, 720});
  int named = 0;
  int pictures = 0;
  for (const char* text : {"aprilgrid:6x6:25mm:0.2", "aprilgrid:6x5:25mm:0.25:first=9",
                           "aprilgrid:5x4:25mm:0.28", "aprilgrid:6x6:25mm:0.4"}) {
    const Board board = parse_board(text).value();
    const Motion motion(MotionKind::kRandom, camera, board, 5);
    for (int n = 0; n < 8; ++n, ++pictures) {
      const GrayImage image = render_board(camera, board, motion.camera_from_board(n),
                                           {.noise = 2, .blur = 0.7, .seed = unsigned(n)});
      for (const IdentifiedBoard& seen : identify_boards(image.view(), kSide)) {
        named += seen.board == board ? 1 : 0;
        EXPECT_TRUE(seen.board == board || !seen.whole) << seen.board.text() << " for " << text;
      }
    }
  }
  EXPECT_GE(named, 30) << "of " << pictures;
}

// The middles of a single row or column of tags fill the picture: whether more of them follow is
// not seen.
TEST(Identify, NamesRowsOfTags) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  for (const char* text :
       {"aruco:1x5:25mm:10mm:DICT_7X7_50:border=2", "apriltag:tag25h9:3x1:25mm:5mm:border=2"}) {
    for (const double turn : {0.1, 1.6, 3.3}) {
      const auto seen = identify_boards(picture_of(parse_board(text).value(), turn).view(), kSide);
      ASSERT_FALSE(seen.empty()) << text << " " << turn;
      EXPECT_EQ(seen.front().board.text(), text) << turn;
    }
  }
}

// Only a code tells whether it is seen in a mirror.
// Light that bleeds makes gaps seem wider: which gap was printed nobody knows, and what to do is
// said.
TEST(Identify, AsksForTheGapsOfTagsThatNoneIsLike) {
  const Board board = parse_board("aruco:5x4:25mm:6.8mm:DICT_6X6_50").value();
  BoardIdentifier identifier(AutoBoard{0.025, false});
  identifier.look(picture_of(board, 0.1).view(), {});
  EXPECT_FALSE(identifier.certain().has_value());
  EXPECT_NE(identifier.hint().find("measure the gaps"), std::string::npos) << identifier.hint();
}

TEST(Identify, TellsAMirror) {
  EXPECT_EQ(first_of(mirrored(picture_of(parse_board("puzzle:14x9:25mm").value(), 0.1))),
            "~puzzle:14x9:25mm");
  EXPECT_EQ(first_of(mirrored(picture_of(parse_board("checkerboard:9x6:25mm").value(), 0.1))),
            "checkerboard:9x6:25mm");
  if (!has_opencv_dictionaries()) return;
  EXPECT_EQ(
      first_of(mirrored(picture_of(parse_board("charuco:5x7:25mm:20mm:DICT_4X4_50").value(), 0.1))),
      "~charuco:5x7:25mm:20mm:DICT_4X4_50");
}

TEST(Identify, SaysNothingOfWhatIsNoBoard) {
  EXPECT_TRUE(identify_boards({}, kSide).empty());
  GrayImage grey;
  grey.width = 640;
  grey.height = 480;
  grey.pixels.assign(640 * 480, 128);
  EXPECT_TRUE(identify_boards(grey.view(), kSide).empty());
  std::stop_source stopped;
  stopped.request_stop();
  const auto picture = picture_of(parse_board("checkerboard:9x6:25mm").value(), 0.1);
  EXPECT_TRUE(identify_boards(picture.view(), kSide, stopped.get_token()).empty());
}

// Marks are a part of a board's text, which is that of the turn in which they come early.
TEST(Identify, CirclesWithTheirMarks) {
  const std::pair<const char*, const char*> texts[] = {
      {"dots:9x6:25mm:rings=1.1:big=2.4", "dots:9x6:25mm:rings=1.1:big=2.4"},
      {"dots:6x9:25mm:rings=1.1:big=4.2", "dots:9x6:25mm:rings=7.1:big=6.4"},
      {"dots:10x10:25mm:big=0.0:inverted", "dots:10x10:25mm:big=0.0:inverted"},
      {"circles:9x6:25mm", "circles:9x6:25mm"}};
  for (const auto& [text, named] : texts) {
    for (const double turn : {0.0, 4.7}) {
      EXPECT_EQ(first_of(picture_of(parse_board(text).value(), turn)), named) << turn;
    }
  }
}

// Its next discs would lie at the edge of the paper, which is that of the picture.
TEST(Identify, CirclesOnPaperThatHasNoMoreRoom) {
  constexpr int kPitch = 60;
  constexpr int kMargin = kPitch - 2;
  constexpr double kRadius = 15;
  GrayImage page(6 * kPitch + 2 * kMargin + 1, 4 * kPitch + 2 * kMargin + 1);
  for (int y = 0; y < page.height; ++y) {
    for (int x = 0; x < page.width; ++x) {
      const double dx = std::remainder(x - kMargin, kPitch);
      const double dy = std::remainder(y - kMargin, kPitch);
      const bool is_among = x > kMargin - kPitch / 2 && x < page.width - kMargin + kPitch / 2 &&
                            y > kMargin - kPitch / 2 && y < page.height - kMargin + kPitch / 2;
      const double outside = std::clamp(std::hypot(dx, dy) - kRadius + 0.5, 0.0, 1.0);
      page.row(y)[x] = static_cast<std::uint8_t>(is_among ? 20 + 200 * outside : 220);
    }
  }
  const auto seen = identify_boards(page.view(), 0.03);
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].board.text(), "circles:7x5:30mm");
}

}  // namespace
}  // namespace calvin
