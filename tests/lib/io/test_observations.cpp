// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Files of observations: what is written is read, what a crash leaves behind is cut off, and what
// other programs write.
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/core/file.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/target/board.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

constexpr std::string_view kText =
    R"({"format":"calvin-observations","version":1,"board":"checkerboard:9x6:25mm"}
{"camera":"cam0","timestamp":18446744073709551614,"image_size":[640,480],"points":[[0,10.5,20.25,0.1],[53,1e-3,479,0.30000000000000004]]}
{"camera":"","image_size":[640,480],"points":[]}
)";

TEST(Observations, WhatIsInTheFileIsRead) {
  const auto file = parse_observations(kText);
  ASSERT_TRUE(file.has_value()) << file.error().message;
  EXPECT_EQ(file->board, "checkerboard:9x6:25mm");
  EXPECT_EQ(file->whole_bytes, kText.size());
  ASSERT_EQ(file->observations.size(), 2U);
  const Observation& first = file->observations[0];
  EXPECT_EQ(first.camera, "cam0");
  EXPECT_EQ(first.board, "checkerboard:9x6:25mm");
  EXPECT_EQ(first.timestamp, 18446744073709551614U);
  EXPECT_EQ(first.image_size, (ImageSize{640, 480}));
  EXPECT_EQ(first.ids, (std::vector<int>{0, 53}));
  EXPECT_EQ(first.uv[1].u, 1e-3);
  EXPECT_EQ(first.sigma[1], 0.30000000000000004);
  EXPECT_FALSE(file->observations[1].found());
  EXPECT_EQ(file->observations[1].timestamp, kNoTimestamp);
}

TEST(Observations, WhatIsPrintedReadsBackAsTheSame) {
  ObservationFile file;
  file.board = "checkerboard:9x6:25mm;checkerboard:5x4:1cm";
  for (const std::string board : {"checkerboard:9x6:25mm", "checkerboard:5x4:1cm"}) {
    Observation seen;
    seen.camera = "left \"one\"\n";
    seen.board = board;
    seen.timestamp = 1234567890123456789U;
    seen.image_size = {1280, 960};
    seen.ids = {3, 1, 2};
    seen.uv = {{1.0 / 3, -0.25}, {1e-17, 959.4999999999999}, {0, 0}};
    seen.sigma = {0.1, 0.7, 1.0 / 7};
    if (file.observations.empty()) {
      seen.velocity = {{1.0 / 3, -120.5}, {0, 1e-300}, {7, 8}};
      seen.ambiguous = {{2, 0, 0}, {}, {1, 0, -1}};  // the second in words that nobody knows
      seen.blur = 0.7;
    }
    file.observations.push_back(seen);
  }
  const std::string text = print_observations(file).value();
  const auto again = parse_observations(text);
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(print_observations(*again).value(), text);
  ASSERT_EQ(again->observations.size(), 2U);
  EXPECT_EQ(again->observations[1].board, "checkerboard:5x4:1cm");
  for (std::size_t i = 0; i < 2; ++i) {
    const Observation& a = file.observations[i];
    const Observation& b = again->observations[i];
    EXPECT_EQ(a.camera, b.camera);
    EXPECT_EQ(a.board, b.board);
    EXPECT_EQ(a.timestamp, b.timestamp);
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.sigma, b.sigma);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(a.uv[k].u, b.uv[k].u);
    ASSERT_EQ(a.velocity.size(), b.velocity.size());
    for (std::size_t k = 0; k < a.velocity.size(); ++k) {
      EXPECT_EQ(a.velocity[k].u, b.velocity[k].u);
      EXPECT_EQ(a.velocity[k].v, b.velocity[k].v);
    }
    EXPECT_EQ(a.ambiguous, b.ambiguous);
    EXPECT_EQ(a.blur, b.blur);
  }
}

// A file for each camera; what belongs together has the same timestamp.
TEST(Observations, OfALightAreOnePointALine) {
  ObservationFile file;
  file.board = "dot";
  for (int frame = 0; frame < 3; ++frame) {
    Observation seen;
    seen.camera = "cam1";
    seen.board = "dot";
    seen.timestamp = 33333333U * static_cast<unsigned>(frame);
    seen.image_size = {1280, 720};
    if (frame != 1) {
      seen.ids = {0};
      seen.uv = {{640.25 + frame, 359.875}};
      seen.sigma = {0.021};
    }
    file.observations.push_back(seen);
  }
  const auto again = parse_observations(print_observations(file).value());
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_TRUE(parse_board(again->board).has_value());
  ASSERT_EQ(again->observations.size(), 3U);
  EXPECT_FALSE(again->observations[1].found());
  EXPECT_EQ(again->observations[2].ids, std::vector<int>{0});
  EXPECT_EQ(again->observations[2].uv[0].u, 642.25);
  EXPECT_EQ(again->observations[2].sigma[0], 0.021);
  EXPECT_EQ(again->observations[2].board, "dot");
}

TEST(Observations, ATornLastLineIsLeftOutWhereverItTears) {
  const std::string text(kText);
  const std::size_t header = text.find('\n') + 1;
  const std::size_t second = text.find('\n', header) + 1;
  for (std::size_t length = header; length <= text.size(); ++length) {
    const auto file = parse_observations(text.substr(0, length));
    ASSERT_TRUE(file.has_value()) << length << ": " << file.error().message;
    const std::size_t whole = length < second ? header : length < text.size() ? second : length;
    EXPECT_EQ(file->whole_bytes, whole) << length;
    EXPECT_EQ(file->observations.size(), whole == header ? 0U : whole == second ? 1U : 2U);
  }
  EXPECT_FALSE(parse_observations(text.substr(0, header - 1)).has_value());
  EXPECT_FALSE(parse_observations("").has_value());
}

TEST(Observations, AResetForgetsWhatCameBefore) {
  const std::string view = R"({"image_size":[64,48],"points":[[7,1,2,0.5]]})";
  const std::string header(kText.substr(0, kText.find('\n') + 1));
  const auto file =
      parse_observations(header + view + "\n" + view + "\n{\"reset\":true}\n" + view + "\n");
  ASSERT_TRUE(file.has_value()) << file.error().message;
  EXPECT_EQ(file->observations.size(), 1U);
  EXPECT_EQ(parse_observations(header + view + "\n{\"reset\":true}\n")->observations.size(), 0U);
}

// As where a view is taken out: the views before count until those in their place are all there.
TEST(Observations, AResetWithViewsCountsOnceTheyAreThere) {
  const std::string header(kText.substr(0, kText.find('\n') + 1));
  const auto view = [](int id) {
    return fmt::format("{{\"image_size\":[64,48],\"points\":[[{},1,2,0.5]]}}\n", id);
  };
  const std::string before = header + view(1) + view(2) + view(3);
  const std::string text = before + print_observation_reset(2) + view(4) + view(5) + view(6);
  const std::size_t there = text.size() - view(6).size();
  const auto ids = [](const ObservationFile& file) {
    std::vector<int> all;
    for (const Observation& seen : file.observations) all.push_back(seen.ids.at(0));
    return all;
  };
  for (std::size_t length = before.size(); length <= text.size(); ++length) {
    const auto file = parse_observations(text.substr(0, length));
    ASSERT_TRUE(file.has_value()) << length << ": " << file.error().message;
    const bool rewritten = length >= there;
    EXPECT_EQ(file->whole_bytes, length == text.size() ? length
                                 : rewritten           ? there
                                                       : before.size());
    EXPECT_EQ(ids(*file), length == text.size() ? (std::vector<int>{4, 5, 6})
                          : rewritten           ? (std::vector<int>{4, 5})
                                                : (std::vector<int>{1, 2, 3}));
  }
  // One that stands for nobody is a reset.
  EXPECT_TRUE(
      parse_observations(before + print_observation_reset() + view(4))->observations.size() == 1);
  EXPECT_EQ(ids(*parse_observations(before + print_observation_reset(0))), std::vector<int>());
}

// What a meta of somebody else holds must not break a file of hours.
TEST(Observations, WhatIsNoNumberIsNotPrinted) {
  Observation seen;
  seen.board = "checkerboard:9x6:25mm";
  seen.image_size = {64, 48};
  seen.ids = {1, 2};
  seen.uv = {{1, 2}, {3, 4}};
  seen.sigma = {std::numeric_limits<double>::infinity(), std::nan("")};
  seen.blur = std::numeric_limits<double>::infinity();
  ObservationFile file;
  file.board = seen.board;
  file.observations = {seen};
  const auto again = parse_observations(print_observations(file).value());
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->observations.at(0).sigma, (std::vector<double>{1, 1}));
  EXPECT_EQ(again->observations.at(0).blur, 0);
}

TEST(Observations, WhatCouldNotBeReadIsNotPrinted) {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  Observation good;
  good.board = "checkerboard:9x6:25mm";
  good.image_size = {64, 48};
  good.ids = {1, 2};
  good.uv = {{1, 2}, {3, 4}};
  good.velocity = {{1, 0}, {0, 1}};
  using Spoil = void (*)(Observation&);
  for (const Spoil spoil : {Spoil([](Observation& o) { o.uv[1].v = kNan; }),
                            Spoil([](Observation& o) { o.uv[0].u = -HUGE_VAL; }),
                            Spoil([](Observation& o) { o.velocity[0].u = kNan; }),
                            Spoil([](Observation& o) { o.velocity.pop_back(); }),
                            Spoil([](Observation& o) { o.uv.pop_back(); }),
                            Spoil([](Observation& o) { o.ids.pop_back(); }),
                            Spoil([](Observation& o) { o.ids[0] = -7; }),
                            Spoil([](Observation& o) { o.image_size = {}; })}) {
    Observation spoilt = good;
    spoil(spoilt);
    ASSERT_TRUE(print_observation(good, "").has_value());
    EXPECT_EQ(print_observation(spoilt, "").error().code, ErrorCode::kInvalidArgument);
    const auto file = print_observations({good.board, {good, spoilt}, 0});
    ASSERT_FALSE(file.has_value());
    EXPECT_EQ(file.error().code, ErrorCode::kInvalidArgument);
  }
}

TEST(Observations, BrokenLinesAreRefusedByNumberAndName) {
  const std::string header(kText.substr(0, kText.find('\n') + 1));
  for (const std::string line :
       {R"({"image_size":[64,48],"points":[[7,1,2]]})", R"({"points":[]})", "7", "{",
        R"({"image_size":[64,0],"points":[]})", R"({"image_size":[64.5,48],"points":[]})",
        R"({"image_size":[64,48],"points":[[-1,1,2,1]]})",
        R"({"image_size":[64,48],"points":[[1.5,1,2,1]]})",
        R"({"image_size":[64,48],"points":[[1,1,2,0]]})",
        R"({"image_size":[64,48],"points":[[1,1,1e999,1]]})",
        R"({"image_size":[64,48],"timestamp":-5,"points":[]})",
        R"({"image_size":[64,48],"points":[[1,1,2,1]],"velocity":[[1,2],[3,4]]})",
        R"({"image_size":[64,48],"points":[[1,1,2,1]],"velocity":[[1]]})",
        R"({"image_size":[64,48],"points":[[1,1,2,1]],"ambiguous":["rotate45"]})",
        R"({"image_size":[64,48],"points":[[1,1,2,1]],"ambiguous":[180]})",
        R"({"image_size":[64,48],"points":[[1,1,2,1]],"blur":-1})", R"({"reset":true,"views":-1})",
        R"({"reset":true,"views":1.5})"}) {
    const auto file = parse_observations(header + line + "\n", "log.jsonl");
    ASSERT_FALSE(file.has_value()) << line;
    EXPECT_NE(file.error().message.find("'log.jsonl'"), std::string::npos) << file.error().message;
    EXPECT_NE(file.error().message.find("line 2"), std::string::npos) << file.error().message;
    const auto advice = file.error().message.find(" Give a file");
    ASSERT_NE(advice, std::string::npos);
    EXPECT_EQ(file.error().message[advice - 1], '.') << file.error().message;
    EXPECT_NE(file.error().message[advice - 2], '.') << file.error().message;
  }
  const auto joined = parse_observations(header + header, "log.jsonl");
  ASSERT_FALSE(joined.has_value());
  EXPECT_NE(joined.error().message.find("second header"), std::string::npos)
      << joined.error().message;
  const auto newer = parse_observations("{\"format\":\"calvin-observations\",\"version\":2}\n");
  ASSERT_FALSE(newer.has_value());
  EXPECT_EQ(newer.error().code, ErrorCode::kUnsupported);
  const auto other = parse_observations("{\"format\":\"calvin-calibration\",\"version\":1}\n");
  ASSERT_FALSE(other.has_value());
  EXPECT_EQ(other.error().code, ErrorCode::kMalformed);
}

TEST(Observations, FilesAreRead) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder.path("log.jsonl"), kText).has_value());
  EXPECT_EQ(read_observations(folder.path("log.jsonl"))->observations.size(), 2U);
  EXPECT_EQ(read_observations(folder.path("none.jsonl")).error().code, ErrorCode::kNotFound);
}

// As mrgingham writes it, on a board of 3x2 corners.
constexpr std::string_view kVnl = R"(## generated by mrgingham
# filename x y level
frame000.png 211.4312 118.0021 0
frame000.png 240 118 1
frame000.png - - -
frame000.png 211 140 2
frame000.png 241 140 0
frame000.png 270 141 0
frame001.png - - -
frame002.png 1 2 0
frame002.png 3 4 -1
frame002.png 5 6 0
frame002.png 7 8 -
frame002.png 9 10 0
frame002.png - - -
)";

TEST(CornersVnl, OfMrginghamIsRead) {
  const auto seen = parse_corners_vnl(kVnl, "checkerboard:3x2:10mm", {640, 480});
  ASSERT_TRUE(seen.has_value()) << seen.error().message;
  ASSERT_EQ(seen->size(), 3U);
  EXPECT_EQ(seen->at(0).ids, (std::vector<int>{0, 1, 3, 4, 5}));
  EXPECT_EQ(seen->at(0).sigma, (std::vector<double>{1, 2, 4, 1, 1}));
  EXPECT_EQ(seen->at(0).uv[0].u, 211.4312);
  EXPECT_EQ(seen->at(0).image_size, (ImageSize{640, 480}));
  EXPECT_FALSE(seen->at(1).found());
  EXPECT_EQ(seen->at(2).ids, (std::vector<int>{0, 2, 4}));
}

// A byte order mark before them, as Notepad puts it there.
TEST(CornersVnl, MayBeginWithAByteOrderMark) {
  const std::string text = "\xEF\xBB\xBF" + std::string(kVnl);
  const auto marked = parse_corners_vnl(text, "checkerboard:3x2:10mm", {640, 480});
  ASSERT_TRUE(marked.has_value()) << marked.error().message;
  EXPECT_EQ(marked->size(), parse_corners_vnl(kVnl, "checkerboard:3x2:10mm", {640, 480})->size());
}

TEST(CornersVnl, WhatIsPrintedReadsBackAsTheSame) {
  auto seen = parse_corners_vnl(kVnl, "checkerboard:3x2:10mm", {640, 480}).value();
  seen[0].sigma = {0.25, 0.5, 8, 1, 2};
  const auto text = print_corners_vnl(seen);
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto again = parse_corners_vnl(*text, "checkerboard:3x2:10mm", {640, 480});
  ASSERT_TRUE(again.has_value()) << again.error().message;
  ASSERT_EQ(again->size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(again->at(i).ids, seen[i].ids);
    EXPECT_EQ(again->at(i).sigma, seen[i].sigma);
    for (std::size_t k = 0; k < seen[i].uv.size(); ++k) {
      EXPECT_EQ(again->at(i).uv[k].u, seen[i].uv[k].u);
      EXPECT_EQ(again->at(i).uv[k].v, seen[i].uv[k].v);
    }
  }
  auto spoilt = seen;
  spoilt[0].ids[0] = 6;
  EXPECT_FALSE(print_corners_vnl(spoilt).has_value());
  spoilt = seen;
  spoilt[0].uv[1].u = std::nan("");
  EXPECT_EQ(print_corners_vnl(spoilt).error().code, ErrorCode::kInvalidArgument);
  spoilt = seen;
  spoilt[2].uv.pop_back();
  EXPECT_NE(print_corners_vnl(spoilt).error().message.find("View 2 "), std::string::npos);
}

TEST(CornersVnl, OfAnotherBoardOrBrokenIsRefused) {
  const auto refused = [](std::string_view text, std::string_view board) {
    const auto seen = parse_corners_vnl(text, board, {640, 480}, "corners.vnl");
    EXPECT_FALSE(seen.has_value()) << text;
    return seen ? std::string() : seen.error().message;
  };
  EXPECT_NE(refused(kVnl, "checkerboard:4x2:10mm").find("line 9"), std::string::npos);
  EXPECT_NE(
      refused("# filename x y level\na.png 1 2 0\n", "checkerboard:3x2:10mm").find("1 corners"),
      std::string::npos);
  (void)refused("a.png 1 2 0\n", "checkerboard:3x2:10mm");
  (void)refused("", "checkerboard:3x2:10mm");
  (void)refused("# filename x y level\na.png 1 two 0\n", "checkerboard:3x2:10mm");
  (void)refused(kVnl, "checkerboard:3x2");
}

// The rows of a picture of 3x2 corners whose second one has `word` in the column `kind`.
Result<std::vector<Observation>> with_column(const std::string& kind, const std::string& word) {
  std::string text = "# filename x y " + kind + "\n";
  for (int i = 0; i < 6; ++i) text.append("a.png 1 2 ").append(i == 1 ? word : "1").append("\n");
  return parse_corners_vnl(text, "checkerboard:3x2:10mm", {640, 480}, "corners.vnl");
}

// What mrcal reads: its levels are whole numbers, a weight is any that is positive; what is
// negative, a weight of 0 and '-' mark a corner that was not seen (mrcal's test-parse-corners).
TEST(CornersVnl, TheFourthColumnIsWhatMrcalTakes) {
  const std::pair<std::string, std::pair<std::string, double>> right[] = {
      {"level", {"0", 1}},     {"level", {"3", 8}},       {"level", {"2.0", 4}},
      {"level", {"-", 0}},     {"level", {"-1", 0}},      {"level", {"-2", 0}},
      {"weight", {"0.25", 4}}, {"weight", {"1e3", 1e-3}}, {"weight", {"-2", 0}},
      {"weight", {"-", 0}},    {"weight", {"0", 0}},
  };
  for (const auto& [kind, given] : right) {
    const auto& [word, sigma] = given;
    const auto seen = with_column(kind, word);
    ASSERT_TRUE(seen.has_value()) << kind << " " << word << ": " << seen.error().message;
    const Observation& first = seen->front();
    EXPECT_EQ(first.ids.size(), sigma > 0 ? 6U : 5U) << kind << " " << word;
    if (sigma > 0) {
      EXPECT_EQ(first.sigma.at(1), sigma) << kind << " " << word;
    }
  }
}

TEST(CornersVnl, AFourthColumnThatIsNoneIsRefusedByLine) {
  const std::pair<std::string, std::string> wrong[] = {
      {"level", "0.5"},    {"level", "-0.5"}, {"level", "17"},      {"level", "1e6"},
      {"level", "nan"},    {"level", "x"},    {"weight", "1e-320"}, {"weight", "1e-300"},
      {"weight", "1e300"}, {"weight", "inf"}, {"weight", "x"},      {"level", "0 7"},
  };
  for (const auto& [kind, word] : wrong) {
    const auto seen = with_column(kind, word);
    ASSERT_FALSE(seen.has_value()) << kind << " " << word;
    for (const std::string& part : {std::string("line 3"), kind, word}) {
      if (word == "0 7" && part != "line 3") continue;
      EXPECT_NE(seen.error().message.find(part), std::string::npos) << seen.error().message;
    }
  }
  const auto other = with_column("sigma", "1");
  ASSERT_FALSE(other.has_value()) << "a sigma is neither a level nor a weight";
  EXPECT_NE(other.error().message.find("line 1"), std::string::npos) << other.error().message;
  EXPECT_NE(other.error().message.find("'sigma'"), std::string::npos) << other.error().message;
}

// Whatever sigma a corner has, the file that is printed can be read.
TEST(CornersVnl, ExtremeSigmasArePrintedAsWhatCanBeRead) {
  auto seen = parse_corners_vnl(kVnl, "checkerboard:3x2:10mm", {640, 480}).value();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  seen[0].sigma = {1e-320, 1e300, kInfinity, std::nan(""), 1};
  const auto again =
      parse_corners_vnl(print_corners_vnl(seen).value(), "checkerboard:3x2:10mm", {640, 480});
  ASSERT_TRUE(again.has_value()) << again.error().message;
  EXPECT_EQ(again->at(0).ids, seen[0].ids);
  for (const double sigma : again->at(0).sigma) EXPECT_TRUE(sigma > 0 && std::isfinite(sigma));
}

}  // namespace
}  // namespace calvin
