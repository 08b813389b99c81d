// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards by name, several boards at once, files of names.
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calvin/core/file.hpp"
#include "calvin/io/board_names.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

constexpr const char* kRight = "checkerboard:9x6:25mm";

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
       {std::string(), std::string("boards.json"), std::string(100000, 'x'), std::string(";"),
        std::string("checkerboard:9x6:25mm;"), std::string(";checkerboard:9x6:25mm"),
        std::string("checkerboard:9x6:25mm;;dot"), std::string("checkerboard:9x6:25mm;nonsense"),
        std::string("#"), std::string("#floor"), file() + "#", many}) {
    const auto boards = parse_boards(wrong);
    ASSERT_FALSE(boards.has_value()) << wrong;
    EXPECT_EQ(boards.error().code, ErrorCode::kInvalidArgument) << wrong;
    EXPECT_NE(boards.error().message.find(kRight), std::string::npos) << boards.error().message;
    EXPECT_LT(boards.error().message.size(), 600u) << boards.error().message;
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

// However each of them is written.
TEST_F(BoardNames, ABoardTwiceIsTwoSheetsOfIt) {
  ASSERT_TRUE(add_board(file(), "floor", kRight).has_value());
  const auto boards =
      parse_boards("checkerboard:9x6:25mm;checkerboard:9x6:2.5cm;" + file() + "#floor");
  ASSERT_TRUE(boards.has_value()) << boards.error().message;
  ASSERT_EQ(boards->size(), 3u);
  for (const Board& board : *boards) EXPECT_EQ(board.text(), kRight);
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

// A right text is shown once, however deep the mistake lies.
TEST_F(BoardNames, AWrongBoardInAFileIsExplainedOnce) {
  write(R"({"format": "calvin-boards", "version": 1, "boards": {"floor": "rubbish:9x6:25mm"}})");
  const Error error = parse_boards(file() + "#floor").error();
  EXPECT_EQ(error.code, ErrorCode::kMalformed);
  for (const std::string& part : {file(), std::string("'floor'"), std::string("'rubbish'"),
                                  std::string("A right text is"), std::string(kRight)}) {
    const auto at = error.message.find(part);
    EXPECT_NE(at, std::string::npos) << part << ": " << error.message;
  }
  EXPECT_EQ(error.message.find("A right text is"), error.message.rfind("A right text is"))
      << error.message;
}

std::string file_with(const std::string& more) {
  return R"({"format": "calvin-boards", "version": 1, "boards": {"floor": "checkerboard:9x6:25mm"}, )" +
         more + "}";
}

// 20,000 lists in each other, as valid JSON as any, would take 400 MB.
TEST_F(BoardNames, DeepFilesAreRefused) {
  write(file_with("\"note\": " + std::string(20, '[') + std::string(20, ']')));
  EXPECT_TRUE(list_boards(file()).has_value());
  write(file_with("\"note\": " + std::string(20'000, '[') + std::string(20'000, ']')));
  const auto boards = list_boards(file());
  ASSERT_FALSE(boards.has_value());
  EXPECT_EQ(boards.error().code, ErrorCode::kMalformed);
  EXPECT_NE(boards.error().message.find("deep"), std::string::npos) << boards.error().message;
  EXPECT_FALSE(add_board(file(), "wall", kRight).has_value());
}

TEST_F(BoardNames, ANameThatStandsTwiceIsRefused) {
  write(R"({"format": "calvin-boards", "version": 1,
            "boards": {"a": "checkerboard:9x6:25mm", "a": "checkerboard:7x5:25mm"}})");
  const auto boards = list_boards(file());
  ASSERT_FALSE(boards.has_value());
  EXPECT_NE(boards.error().message.find("'a' occurs twice"), std::string::npos)
      << boards.error().message;
}

// The time that a file takes grows as its length: quadratic, this one took five seconds.
TEST_F(BoardNames, ManyNamesAreReadInTime) {
  std::string names;
  for (int i = 0; i < 90'000; ++i) {
    if (i > 0) names += ',';
    names += fmt::format("\"{:x}\":\"\"", i);
  }
  write(R"({"format": "calvin-boards", "version": 1, "boards": {)" + names + "}}");
  const std::clock_t begin = std::clock();  // of the processor
  const auto boards = list_boards(file());
  ASSERT_TRUE(boards.has_value()) << boards.error().message;
  EXPECT_TRUE(add_board(file(), "floor", kRight).has_value());
  EXPECT_LT(std::clock() - begin, 3 * CLOCKS_PER_SEC);
  EXPECT_EQ(boards->size(), 90'000U);
}

TEST_F(BoardNames, WhatIsNotKnownIsKept) {
  const std::string note =
      R"({"text": "\u0007 \"quoted\" größe", "list": [null, true, -2.5, [], {}], "n": 12345678901234})";
  write(file_with("\"note\": " + note));
  ASSERT_TRUE(add_board(file(), "wall", kRight).has_value());
  const auto now = nlohmann::json::parse(*read_file(file()));
  EXPECT_EQ(now["note"], nlohmann::json::parse(note)) << *read_file(file());
  EXPECT_EQ(now["boards"]["wall"], kRight);
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

// Offsets of some um and sigmas that have something in common.
BoardMeasurement some_shape() {
  BoardMeasurement measured = unmeasured(parse_board(kRight).value()).value();
  const Eigen::Index n = measured.covariance.rows();
  Eigen::VectorXd mode(n);
  for (Eigen::Index i = 0; i < n; ++i) mode[i] = 1e-5 * std::sin(static_cast<double>(i));
  measured.covariance = mode * mode.transpose();
  measured.covariance.diagonal().array() += 1e-10;
  for (std::size_t i = 0; i < measured.offsets.size(); ++i) {
    measured.offsets[i] = {1e-6 * static_cast<double>(i), -2e-5, 3e-4};
  }
  measured.views = {{{320.5, 240.25}, {100, 60}}, {{1, 2}, {3, 4}}};
  return measured;
}

TEST_F(BoardNames, AMeasuredBoardReadsBackAsTheSame) {
  ASSERT_TRUE(add_board(file(), "desk", kRight));
  const std::string named = file() + "#desk";
  EXPECT_EQ(read_measurement(named).value(), nullptr);
  const BoardMeasurement stored = some_shape();
  ASSERT_TRUE(store_measurement(named, stored));
  EXPECT_EQ(parse_boards(named).value().front().text(), kRight);
  const auto listed = list_boards(file()).value();
  ASSERT_EQ(listed.size(), 1u);
  EXPECT_EQ(listed[0].text, kRight);
  EXPECT_EQ(listed[0].measured_by, 2u);
  for (const std::string& text : {named, "checkerboard:4x3:1cm;" + named}) {
    const auto read = read_measurement(text).value();
    ASSERT_TRUE(read);
    EXPECT_EQ(read->board, stored.board);
    for (std::size_t i = 0; i < stored.offsets.size(); ++i) {
      EXPECT_LT((read->offsets[i] - stored.offsets[i]).norm(), 1e-8) << i;
    }
    EXPECT_LT((read->covariance - stored.covariance).norm(), 0.01 * stored.covariance.norm());
    ASSERT_EQ(read->views.size(), 2u);
    EXPECT_TRUE(same_view(read->views[0], stored.views[0]));
  }
}

TEST_F(BoardNames, StoringAShapeKeepsWhatIsThere) {
  write(R"({"format": "calvin-boards", "version": 1, "note": [1, 2], "boards": {
            "a": "checkerboard:5x4:1cm",
            "desk": {"board": "checkerboard:9x6:25mm", "bought": "in May", "shape": {}},
            "z": {"board": "checkerboard:4x3:1cm", "glued": true}}})");
  ASSERT_TRUE(store_measurement(file() + "#desk", some_shape()));
  ASSERT_TRUE(add_board(file(), "z", "checkerboard:8x7:1in"));
  auto now = nlohmann::json::parse(*read_file(file()));
  EXPECT_EQ(now["note"], nlohmann::json::parse("[1, 2]"));
  EXPECT_EQ(now["boards"]["a"], "checkerboard:5x4:1cm");
  EXPECT_EQ(now["boards"]["desk"]["bought"], "in May");
  EXPECT_EQ(now["boards"]["desk"]["shape"]["offsets"].size(), 54u);
  EXPECT_EQ(now["boards"]["z"]["board"], "checkerboard:8x7:25.4mm");
  EXPECT_EQ(now["boards"]["z"]["glued"], true);
  // The same board again keeps its shape, another one has none.
  ASSERT_TRUE(add_board(file(), "desk", "checkerboard:9x6:2.5cm"));
  EXPECT_TRUE(read_measurement(file() + "#desk").value());
  ASSERT_TRUE(add_board(file(), "desk", "checkerboard:9x6:26mm"));
  EXPECT_FALSE(read_measurement(file() + "#desk").value());
  now = nlohmann::json::parse(*read_file(file()));
  EXPECT_FALSE(now["boards"]["desk"].contains("shape"));
  EXPECT_EQ(now["boards"]["desk"]["bought"], "in May");
}

TEST_F(BoardNames, AShapeIsKeptUnderTheNameOfItsBoardAlone) {
  ASSERT_TRUE(add_board(file(), "desk", "checkerboard:9x6:26mm"));
  const std::string before = *read_file(file());
  EXPECT_FALSE(store_measurement(file() + "#desk", some_shape()));
  EXPECT_FALSE(store_measurement(file() + "#wall", some_shape()));
  EXPECT_FALSE(store_measurement(kRight, some_shape()));
  EXPECT_EQ(*read_file(file()), before);
}

TEST_F(BoardNames, ShapesThatNoBoardHasAreRefused) {
  ASSERT_TRUE(add_board(file(), "desk", kRight));
  const std::string named = file() + "#desk";
  ASSERT_TRUE(store_measurement(named, some_shape()));
  const auto right = nlohmann::json::parse(*read_file(file()));
  const auto refused = [&](const char* key, const nlohmann::json& value) {
    auto wrong = right;
    wrong["boards"]["desk"]["shape"][key] = value;
    write(wrong.dump());
    const auto read = read_measurement(named);
    ASSERT_FALSE(read) << key << " " << value.dump().substr(0, 40);
    EXPECT_NE(read.error().message.find("calvin-board measure"), std::string::npos);
    // The board itself is as good as before.
    EXPECT_TRUE(parse_boards(named));
  };
  refused("offsets", nlohmann::json::array());
  refused("offsets", "none");
  refused("own", nlohmann::json::array({nlohmann::json::array({1, 2, 3})}));
  refused("modes", nlohmann::json::array({nlohmann::json::array({1, 2, 3})}));
  refused("views", nlohmann::json::array({1}));
  auto own = right["boards"]["desk"]["shape"]["own"];
  own[3][1] = 0;
  refused("own", own);
  own[3][1] = -1e-5;
  refused("own", own);
  auto offsets = right["boards"]["desk"]["shape"]["offsets"];
  offsets[0][0] = 1e6;
  refused("offsets", offsets);
}

}  // namespace
}  // namespace calvin
