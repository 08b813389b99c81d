// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Board texts, control points, symmetries, boards by name.
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/board_names.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

constexpr const char* kRight = "checkerboard:9x6:25mm";

TEST(Board, TheDefaultIsRight) {
  const auto board = parse_board(kDefaultBoard);
  ASSERT_TRUE(board.has_value());
  EXPECT_EQ(board->cols, 9);
  EXPECT_EQ(board->rows, 6);
  EXPECT_DOUBLE_EQ(board->size, 0.025);
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
  };
  for (const auto& [text, canonical] : cases) {
    const auto board = parse_board(text);
    ASSERT_TRUE(board.has_value()) << text << ": " << board.error().message;
    EXPECT_EQ(board->text(), canonical) << text;
    const auto again = parse_board(board->text());
    ASSERT_TRUE(again.has_value()) << board->text();
    EXPECT_NEAR(again->size, board->size, 1e-9) << text;
  }
}

// To a nanometre: a thousandth of a micrometre over ten squares is nothing, a micrometre is not.
TEST(Board, TheTextKeepsTheLength) {
  for (const char* text : {"checkerboard:9x6:0.3334in", "checkerboard:9x6:25.4005mm",
                           "checkerboard:9x6:0.0248012345m"}) {
    const Board board = parse_board(text).value();
    EXPECT_NEAR(parse_board(board.text()).value().size, board.size, 0.51e-9) << board.text();
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

TEST(Board, EveryWrongTextShowsARightOne) {
  const std::string endless(100000, 'x');
  for (const std::string& wrong : std::vector<std::string>{"",
                                                           ":",
                                                           "checkerboard",
                                                           "checkerboard:9x6",
                                                           "checkerboard:9x6:25mm:more",
                                                           "chessboard:9x6:25mm",
                                                           "Checkerboard:9x6:25mm",
                                                           "charuco:5x7:40mm:20mm:DICT_6X6_250",
                                                           "dot",
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
    for (const auto& error : {parse_board(wrong).error(), parse_boards(wrong).error()}) {
      EXPECT_EQ(error.code, ErrorCode::kInvalidArgument) << wrong.substr(0, 80);
      EXPECT_NE(error.message.find(kRight), std::string::npos) << error.message;
      EXPECT_LT(error.message.size(), 600u) << error.message;
    }
  }
}

TEST(Board, ErrorsAreOneLine) {
  const std::string message = parse_board("checker\nboard\x1b[31m").error().message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
}

TEST(Board, PointsInTheOrderOfTheirIds) {
  const Board board{BoardKind::kCheckerboard, 4, 3, 0.1};
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
      const auto names = Board{BoardKind::kCheckerboard, cols, rows, 0.1}.symmetries();
      EXPECT_EQ(std::set<std::string>(names.begin(), names.end()),
                symmetries_by_turning(cols, rows))
          << cols << "x" << rows;
    }
  }
}

class BoardNames : public testing::Test {
 protected:
  [[nodiscard]] std::string file() const { return folder_.path("boards.json"); }
  void write(std::string_view text) const { ASSERT_TRUE(write_file(file(), text).has_value()); }

  TemporaryFolder folder_;
};

TEST_F(BoardNames, SeveralBoardsAtOnce) {
  ASSERT_TRUE(add_board(file(), "floor", "checkerboard:7x5:3cm").has_value());
  const auto boards = parse_boards("checkerboard:9x6:25mm; " + file() + "#floor");
  ASSERT_TRUE(boards.has_value()) << boards.error().message;
  ASSERT_EQ(boards->size(), 2u);
  EXPECT_EQ((*boards)[0].text(), "checkerboard:9x6:25mm");
  EXPECT_EQ((*boards)[1].text(), "checkerboard:7x5:30mm");
}

TEST_F(BoardNames, WrongListsShowARightText) {
  std::string many;
  for (int i = 0; i <= kMaxBoards; ++i) {
    if (i > 0) many += ';';
    many += "checkerboard:9x";
    many += std::to_string(3 + i) + ":25mm";
  }
  for (const std::string& wrong :
       {std::string(";"), std::string("checkerboard:9x6:25mm;"),
        std::string(";checkerboard:9x6:25mm"), std::string("checkerboard:9x6:25mm;;dot"),
        std::string("checkerboard:9x6:25mm;checkerboard:9x6:2.5cm"),
        std::string("checkerboard:9x6:25mm;nonsense"), std::string("#"), std::string("#floor"),
        file() + "#", many}) {
    const auto boards = parse_boards(wrong);
    ASSERT_FALSE(boards.has_value()) << wrong;
    EXPECT_EQ(boards.error().code, ErrorCode::kInvalidArgument) << wrong;
    EXPECT_NE(boards.error().message.find(kRight), std::string::npos) << boards.error().message;
  }
}

// Every view of the one would count for the other too.
TEST_F(BoardNames, BoardsThatLookTheSameAreRefused) {
  ASSERT_TRUE(add_board(file(), "floor", "checkerboard:6x9:30mm").has_value());
  const std::string others[][2] = {
      {"checkerboard:6x9:25mm", "checkerboard:6x9:25mm"},
      {"checkerboard:9x6:26mm", "checkerboard:9x6:26mm"},
      {file() + "#floor", "checkerboard:6x9:30mm"},
  };
  for (const auto& [other, canonical] : others) {
    const auto boards = parse_boards("checkerboard:9x6:25mm;checkerboard:8x5:25mm;" + other);
    ASSERT_FALSE(boards.has_value()) << other;
    EXPECT_EQ(boards.error().code, ErrorCode::kInvalidArgument) << other;
    for (const std::string& part : {std::string("checkerboard:9x6:25mm and "), canonical,
                                    std::string("name the one that is used")}) {
      EXPECT_NE(boards.error().message.find(part), std::string::npos) << boards.error().message;
    }
  }
  EXPECT_TRUE(parse_boards("checkerboard:9x6:25mm;checkerboard:9x7:25mm").has_value());
}

TEST_F(BoardNames, MissingFilesAndNamesSaySo) {
  auto error = parse_boards(file() + "#floor").error();
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_NE(error.message.find(kRight), std::string::npos) << error.message;

  ASSERT_TRUE(add_board(file(), "wall", kRight).has_value());
  error = parse_boards(file() + "#floor").error();
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_NE(error.message.find("'wall'"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find(kRight), std::string::npos) << error.message;
}

TEST_F(BoardNames, ANameIsNoNameForAName) {
  write(R"({"format": "calvin-boards", "version": 1,
            "boards": {"a": "boards.json#b", "b": "checkerboard:9x6:25mm", "c": "rubbish"}})");
  EXPECT_EQ(parse_boards(file() + "#a").error().code, ErrorCode::kMalformed);
  EXPECT_EQ(parse_boards(file() + "#c").error().code, ErrorCode::kMalformed);
  EXPECT_TRUE(parse_boards(file() + "#b").has_value());
  EXPECT_FALSE(add_board(file(), "d", file() + "#b").has_value());
}

TEST_F(BoardNames, BrokenFilesAreRefusedAndLeftAlone) {
  for (const std::string& wrong : std::vector<std::string>{
           "", "{", "null", "[]", "\xff\xfe\x01", "42", "{\"format\": \"calvin-boards\"}",
           R"({"format": "calvin-calibration", "version": 1, "boards": {}})",
           R"({"format": "calvin-boards", "version": "1", "boards": {}})",
           R"({"format": "calvin-boards", "version": 2, "boards": {}})",
           R"({"format": "calvin-boards", "version": 1})",
           R"({"format": "calvin-boards", "version": 1, "boards": []})",
           R"({"format": "calvin-boards", "version": 1, "boards": {"floor": 42}})",
           std::string(100000, '['), std::string(2 << 20, ' ')}) {
    write(wrong);
    EXPECT_FALSE(list_boards(file()).has_value()) << wrong.substr(0, 80);
    const auto boards = parse_boards(file() + "#floor");
    ASSERT_FALSE(boards.has_value()) << wrong.substr(0, 80);
    EXPECT_NE(boards.error().message.find(kRight), std::string::npos) << boards.error().message;
    EXPECT_FALSE(add_board(file(), "floor", kRight).has_value()) << wrong.substr(0, 80);
    EXPECT_EQ(*read_file(file()), wrong) << "a file that is not ours was changed";
  }
}

TEST_F(BoardNames, AddingKeepsWhatIsThere) {
  write(R"({"format": "calvin-boards", "version": 1, "note": [1, 2],
            "boards": {"z": "checkerboard:4x3:1cm", "a": "checkerboard:5x4:1cm"}})");
  ASSERT_TRUE(add_board(file(), "m", "checkerboard:9x6:2.5cm").has_value());
  ASSERT_TRUE(add_board(file(), "z", "checkerboard:8x7:1in").has_value());
  const auto boards = list_boards(file());
  ASSERT_TRUE(boards.has_value()) << boards.error().message;
  ASSERT_EQ(boards->size(), 3u);
  EXPECT_EQ((*boards)[0].name, "z");
  EXPECT_EQ((*boards)[0].text, "checkerboard:8x7:25.4mm");
  EXPECT_EQ((*boards)[1].name, "a");
  EXPECT_EQ((*boards)[1].text, "checkerboard:5x4:1cm");
  EXPECT_EQ((*boards)[2].name, "m");
  EXPECT_NE(read_file(file())->find("\"note\""), std::string::npos);
  EXPECT_EQ(folder_.entries(), 1u);
}

TEST_F(BoardNames, WrongNamesAndPlaces) {
  for (const char* wrong : {"", "a#b", "a;b", " a", "a\n", "\xff\xfe"}) {
    EXPECT_FALSE(add_board(file(), wrong, kRight).has_value()) << wrong;
  }
  EXPECT_FALSE(add_board(file(), std::string(65, 'x'), kRight).has_value());
  EXPECT_FALSE(add_board(folder_.path("none/boards.json"), "floor", kRight).has_value());
  EXPECT_EQ(folder_.entries(), 0u);
  ASSERT_TRUE(add_board(file(), "größe 3", kRight).has_value());
  EXPECT_TRUE(parse_boards(file() + "#größe 3").has_value());
}

}  // namespace
}  // namespace calvin
