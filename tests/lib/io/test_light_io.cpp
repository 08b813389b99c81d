// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The text files of BlueCCal, and known places of cameras.
#include <string>

#include <gtest/gtest.h>

#include "calvin/io/blueccal.hpp"
#include "calvin/io/camera_places.hpp"

namespace calvin {
namespace {

constexpr const char* kPoints =
    "1 2 NaN\n3 4 NaN\n1 1 NaN\n"
    " 1.5e+01 16 17\n18\t19 20\r\n1 1 1\n\n";
constexpr const char* kVisible = "1 1 1\n1 0 1\n";
constexpr const char* kSizes = "640 480\n752 480\n";

TEST(BlueCcal, IsReadAsObservationsOfADot) {
  const auto files = parse_blueccal({kPoints, kVisible, kSizes, "left\nright\n"});
  ASSERT_TRUE(files.has_value()) << files.error().message;
  ASSERT_EQ(files->size(), 2U);
  EXPECT_EQ(files->front().board, "dot");
  ASSERT_EQ(files->front().observations.size(), 2U);
  const Observation& first = files->front().observations[1];
  EXPECT_EQ(first.camera, "left");
  EXPECT_EQ(first.timestamp, 1'000'000'000U);
  EXPECT_EQ(first.uv[0].u, 2);
  EXPECT_EQ(first.uv[0].v, 4);
  const auto& right = files->back().observations;
  ASSERT_EQ(right.size(), 2U);
  EXPECT_EQ(right[0].uv[0].u, 15);
  EXPECT_EQ(right[1].timestamp, 2'000'000'000U);
  EXPECT_EQ(right[1].image_size.width, 752);
  const auto bare = parse_blueccal({kPoints, "", kSizes, ""});
  ASSERT_TRUE(bare.has_value()) << bare.error().message;
  EXPECT_EQ(bare->back().observations.size(), 3U);
  EXPECT_EQ(bare->back().observations[0].camera, "cam1");
}

TEST(BlueCcal, SaysWhichFileIsWrong) {
  const auto message = [](const BlueCcalText& text) {
    const auto files = parse_blueccal(text, "folder");
    return files ? std::string() : files.error().message;
  };
  const auto has = [](const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
  };
  EXPECT_TRUE(has(message({"1 2\n3 4\n", kVisible, kSizes, ""}), "points.dat has 2 rows"));
  EXPECT_TRUE(has(message({"1 2\n3\n1 1\n", "", "640 480\n", ""}), "points.dat has 1 columns"));
  EXPECT_TRUE(has(message({kPoints, "1 1 1\n", kSizes, ""}), "IdMat.dat has not a row"));
  EXPECT_TRUE(has(message({kPoints, "", "640 x\n", ""}), "Res.dat has 'x'"));
  EXPECT_TRUE(has(message({kPoints, "", "640 480\n0 480\n", ""}), "Res.dat has a size"));
  EXPECT_TRUE(has(message({kPoints, "", "", ""}), "Res.dat is not"));
  EXPECT_TRUE(has(message({kPoints, "", kSizes, "one\n"}), "camera_order.txt has 1 names"));
  EXPECT_EQ(read_blueccal("/nowhere").error().code, ErrorCode::kNotFound);
  EXPECT_NE(read_blueccal("/").error().message.find("points.dat is missing"), std::string::npos);
}

TEST(CameraPlaces, AreReadLineByLine) {
  const auto places =
      parse_camera_places("# surveyed\nleft 0 0 1.5\n\nright\t2 -1e-1 1.5 # wall\n");
  ASSERT_TRUE(places.has_value()) << places.error().message;
  ASSERT_EQ(places->size(), 2U);
  EXPECT_EQ(places->back().camera, "right");
  EXPECT_EQ(places->back().place[1], -0.1);
  for (const char* wrong : {"", "left 0 0\n", "left 0 0 x\n", "left 0 0 1 2\n", "left 1 1e9 1\n",
                            "a 0 0 0\na 0 0 1\n"}) {
    EXPECT_FALSE(parse_camera_places(wrong, "places.txt").has_value()) << wrong;
  }
  EXPECT_NE(parse_camera_places("a 0 0 0\nb 0 0\n", "p").error().message.find("line 2"),
            std::string::npos);
}

// Notepad begins a file with it.
TEST(LightFiles, MayBeginWithAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  const auto places = parse_camera_places(mark + "left 1 2 3\n");
  ASSERT_TRUE(places.has_value()) << places.error().message;
  EXPECT_EQ(places->front().camera, "left");
  const std::string points = mark + kPoints;
  const std::string visible = mark + kVisible;
  const std::string sizes = mark + kSizes;
  const std::string names = mark + "left\nright\n";
  const auto files = parse_blueccal({points, visible, sizes, names});
  ASSERT_TRUE(files.has_value()) << files.error().message;
  EXPECT_EQ(files->front().observations[0].camera, "left");
}

}  // namespace
}  // namespace calvin
