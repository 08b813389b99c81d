// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rows of known points: the files of other programs, and files of no use.
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/point_rows.hpp"
#include "calvin/target/kinds.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

constexpr double kMillimetre = 1e-3;

TEST(PointRows, AreThoseOfOtherPrograms) {
  // MyPTV: u v X Y Z, with tabs; the columns are said.
  PointRowsFormat format = {parse_point_columns("u,v,X,Y,Z").value(), kMillimetre};
  const auto plate = parse_point_rows("740.91\t160.67\t43.50\t66.00\t-12.00\n", format);
  ASSERT_TRUE(plate) << plate.error().message;
  ASSERT_EQ(plate->size(), 1u);
  EXPECT_NEAR(plate->front().seen->u, 740.91, 1e-12);
  EXPECT_NEAR((*plate->front().point - Eigen::Vector3d(0.0435, 0.066, -0.012)).norm(), 0, 1e-15);

  // Tsai: X Y Z u v, by their count. Heikkila: a normal behind it.
  format = {{}, kMillimetre};
  const auto tsai = parse_point_rows("# xw yw zw Xf Yf\n 25.4 0 5  100.5 200.25\n", format);
  ASSERT_TRUE(tsai) << tsai.error().message;
  EXPECT_NEAR(tsai->front().point->x(), 0.0254, 1e-15);
  EXPECT_NEAR(tsai->front().seen->v, 200.25, 1e-12);
  const auto heikkila = parse_point_rows("25.4 0 5 100.5 200.25 0 0 1\n", format);
  ASSERT_TRUE(heikkila) << heikkila.error().message;
  EXPECT_NEAR(heikkila->front().seen->u, 100.5, 1e-12);
  EXPECT_EQ(heikkila->front().normal, (std::array<double, 3>{0, 0, 1}));

  // Zhang: four corners of a square a line, in inches.
  format = {parse_point_columns("X,Y").value(), 0.0254};
  const auto zhang = parse_point_rows("0 -0.5 0.5 -0.5 0.5 0 0 0 \n", format);
  ASSERT_TRUE(zhang) << zhang.error().message;
  ASSERT_EQ(zhang->size(), 4u);
  EXPECT_NEAR((*zhang)[2].point->x(), 0.0127, 1e-15);
  EXPECT_FALSE((*zhang)[2].seen);
}

TEST(PointRows, SayThemselvesWhatTheyAre) {
  const auto rows = parse_point_rows(
      "# unit: cm\nid; x; y; z; diameter\n"
      "7; 1; 2; 3; 0.5\n 9, 4, 5, 6, 0.5   # a comment\n\n",
      {});
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ((*rows)[1].id, 9);
  EXPECT_NEAR((*rows)[1].point->z(), 0.06, 1e-15);
  EXPECT_NEAR((*rows)[0].diameter, 0.005, 1e-15);

  // What the caller says counts more; an axis may be turned round.
  PointRowsFormat format = {parse_point_columns("u v X -Y sigma _").value(), 1.0};
  const auto said = parse_point_rows("# unit: mm\nX Y u v\n1 2 3 4 0.1 77\n", format);
  ASSERT_TRUE(said) << said.error().message;
  EXPECT_EQ(*said->front().point, Eigen::Vector3d(3, -4, 0));
  EXPECT_EQ(said->front().sigma, 0.1);

  // Normals have no unit, and are turned round with their axis.
  const auto normal =
      parse_point_rows("# unit: mm\nX Y -Z nx ny -nz diameter\n1 2 3 0 3 4 5\n", {});
  ASSERT_TRUE(normal) << normal.error().message;
  EXPECT_EQ(normal->front().normal, (std::array<double, 3>{0, 3, -4}));
  EXPECT_NEAR(normal->front().point->z(), -0.003, 1e-15);
  EXPECT_NEAR(normal->front().diameter, 0.005, 1e-15);
}

TEST(PointRows, OfNoUseSayWhy) {
  const auto refuses = [](std::string_view content, std::string_view why) {
    const auto rows = parse_point_rows(content, {}, "plate.txt");
    ASSERT_FALSE(rows) << content;
    EXPECT_EQ(rows.error().code, ErrorCode::kMalformed);
    EXPECT_NE(rows.error().message.find(why), std::string::npos) << rows.error().message;
    EXPECT_NE(rows.error().message.find("plate.txt"), std::string::npos);
  };
  refuses("", "no row");
  refuses("# nothing\n", "no row");
  refuses("1 2 3\n", "without a unit");
  refuses("# unit: mm\n1 2 3\n4 5 6 7\n", "line 3 has 4 numbers, where a row has 3");
  refuses("# unit: mm\n1 2 three\n", "'three', which is no number");
  refuses("# unit: mm\n1 2 3 4 5 6 7\n", "nothing says what they are");
  refuses("# unit: mm\nid X Y\n1.5 2 3\n", "the id 1.5");
  refuses("# unit: mm\n1 2 nan\n", "no number");

  for (const std::string_view text : {"X,Y,Z,w", "X,X,Y", "X,Z", "u,X,Y", "Z", "_,_", "X,Y,-u,v",
                                      "", "-id,X,Y", "X,Y,nx,ny", "X,Y,nz"}) {
    const auto columns = parse_point_columns(text);
    ASSERT_FALSE(columns) << text;
    EXPECT_EQ(columns.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(columns.error().message.find("X,Y,Z,u,v"), std::string::npos);
  }
}

TEST(PointRows, AreBoards) {
  const TemporaryFolder folder;
  const auto written = [&folder](const char* name, const char* text) {
    EXPECT_TRUE(write_file(folder.path(name), text));
    return folder.path(name);
  };
  const std::string path = written("plate.txt", "# unit: mm\n0 0 0\n10 0 0\n0 10 0\n10 10 5\n");
  const auto boards = parse_boards("points:" + path + ";checkerboard:9x6:25mm");
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(boards->size(), 2u);
  EXPECT_EQ(boards->front().text(), "points:" + path);
  EXPECT_EQ(boards->front().points()[3], Eigen::Vector3d(0.01, 0.01, 0.005));
  EXPECT_TRUE(names_a_file("points:plate.txt"));
  // Paths are longer than names.
  const std::string far_name = fmt::format("{:f>150}.txt", "");
  const std::string far = written(far_name.c_str(), "# unit: mm\n0 0 0\n10 0 0\n0 10 0\n10 10 5\n");
  const auto long_path = parse_boards("points:" + far);
  ASSERT_TRUE(long_path) << long_path.error().message;
  EXPECT_EQ(long_path->front().text(), "points:" + far);

  for (const auto& [text, why] :
       {std::pair<std::string, const char*>{"points:", "no file"},
        {"points:/no/such/file", "points:plate.txt"},
        {"points:" + written("few.txt", "# unit: mm\n1 2 3\n"), "at least 4"}}) {
    const auto none = parse_boards(text);
    ASSERT_FALSE(none) << text;
    EXPECT_NE(none.error().message.find(why), std::string::npos) << none.error().message;
  }
}

// Excel's "CSV UTF-8" and Notepad begin a file with it.
TEST(PointRows, MayBeginWithAByteOrderMark) {
  const auto rows = parse_point_rows("\xEF\xBB\xBF# unit: mm\n25;0;5;100.5;200.25\r\n", {});
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_NEAR(rows->front().point->x(), 0.025, 1e-15);
  EXPECT_TRUE(parse_point_rows("\xEF\xBB\xBF"
                               "1 2\n",
                               {{}, kMillimetre})
                  .has_value());
  EXPECT_FALSE(parse_point_rows("1 2\n\xEF\xBB\xBF"
                                "3 4\n",
                                {{}, kMillimetre})
                   .has_value());
}

}  // namespace
}  // namespace calvin
