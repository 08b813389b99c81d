// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file of a rig: what is written is read again as the same, and whatever is wrong in a file is
// said by its place.
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/io/rig_io.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

Rig sample() {
  Rig rig;
  for (const char* name : {"left", "r\"ight"}) {
    RigCamera camera;
    camera.calibration =
        Camera::make("brown5", {640, 480}, {536.1, 536, 342.4, 235.5, -0.27, 0.1, 0.001, 0, 0.01})
            .value()
            .to_calibration();
    camera.calibration.camera = name;
    camera.rig_from_camera = {{0.1, -0.2, 1.0 / 3}, {0.12, 0, 1e-7}};
    camera.rms = 0.21;
    rig.cameras.push_back(std::move(camera));
  }
  rig.cameras[1].covariance.assign(36, 0.0);
  for (std::size_t i = 0; i < 6; ++i) rig.cameras[1].covariance[7 * i] = 1e-8 / 3;
  rig.world = "left";
  rig.rms = 0.2;
  rig.pairing_tolerance = 10'000'000;
  rig.boards = {{"checkerboard:9x6:25mm", {{0, 0.3, 0}, {0.1, 0, 0.5}}}, {"dot", {}}};
  rig.fixed_boards = {{"checkerboard:8x5:20mm",
                       "checkerboard:9x6:25mm",
                       {{0, 1.5, 1.0 / 7}, {0.1, 0, 0.1}},
                       rig.cameras[1].covariance}};
  return rig;
}

TEST(RigFile, IsReadAsItWasWritten) {
  const Rig rig = sample();
  const auto text = print_rig(rig);
  ASSERT_TRUE(text.has_value()) << text.error().message;
  const auto read = parse_rig(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(print_rig(*read).value(), *text);
  ASSERT_EQ(read->cameras.size(), 2U);
  EXPECT_EQ(read->cameras[1].calibration.camera, "r\"ight");
  EXPECT_EQ(read->cameras[1].rig_from_camera.rotation, rig.cameras[1].rig_from_camera.rotation);
  EXPECT_EQ(read->cameras[1].rig_from_camera.translation,
            rig.cameras[1].rig_from_camera.translation);
  EXPECT_TRUE(read->cameras[0].covariance.empty());
  EXPECT_EQ(read->cameras[1].covariance, rig.cameras[1].covariance);
  EXPECT_EQ(read->cameras[1].calibration.parameters.size(), 9U);
  EXPECT_EQ(read->world, "left");
  EXPECT_EQ(read->rms, 0.2);
  EXPECT_EQ(read->pairing_tolerance, 10'000'000U);
  ASSERT_EQ(read->boards.size(), 2U);
  EXPECT_EQ(read->boards[0].board, rig.boards[0].board);
  EXPECT_EQ(read->boards[0].rig_from_board.rotation, rig.boards[0].rig_from_board.rotation);
  EXPECT_EQ(read->boards[0].rig_from_board.translation, rig.boards[0].rig_from_board.translation);
  ASSERT_EQ(read->fixed_boards.size(), 1U);
  EXPECT_EQ(read->fixed_boards[0].board, rig.fixed_boards[0].board);
  EXPECT_EQ(read->fixed_boards[0].on, rig.fixed_boards[0].on);
  EXPECT_EQ(read->fixed_boards[0].on_from_board.rotation,
            rig.fixed_boards[0].on_from_board.rotation);
  EXPECT_EQ(read->fixed_boards[0].covariance, rig.fixed_boards[0].covariance);
}

TEST(RigFile, SaysWhereLengthsHaveNoUnit) {
  Rig rig = sample();
  const std::string metric = print_rig(rig).value();
  EXPECT_EQ(metric.find("unit"), std::string::npos);
  EXPECT_TRUE(parse_rig(metric).value().is_metric);
  rig.is_metric = false;
  const std::string text = print_rig(rig).value();
  EXPECT_NE(text.find("\"unit\": \"none\""), std::string::npos) << text;
  const auto read = parse_rig(text);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_FALSE(read->is_metric);
  EXPECT_EQ(print_rig(*read).value(), text);
}

TEST(RigFile, GoesToADiskAndBack) {
  TemporaryFolder folder;
  const std::string path = folder.path("rig.json");
  ASSERT_TRUE(write_rig(path, sample()).has_value());
  EXPECT_TRUE(read_rig(path).has_value());
  EXPECT_EQ(read_rig(folder.path("none.json")).error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(write_rig(folder.path("none/rig.json"), sample()).has_value());
}

// A text with one thing changed, and a word of what is said.
TEST(RigFile, SaysWhatIsWrong) {
  const std::string good = print_rig(sample()).value();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? text : text.replace(at, from.size(), to);
  };
  const std::pair<std::string, const char*> wrong[] = {
      {"", "empty"},
      {"[]", "none of the fields"},
      {"{}", "format"},
      {with("calvin-rig", "calvin-calibration"), "calvin-calibration"},
      {with("\"version\": 1", "\"version\": 2"), "newer version"},
      {with("\"fx\": 536.1", "\"fx\": -1"), "fx"},
      {with("\"r\\\"ight\"", "\"left\""), "twice"},
      {with("\"rig_from_camera\"", "\"pose\""), "rig_from_camera"},
      {with("\"calibration\"", "\"camera_file\""), "calibration"},
      {with("\"rotation\"", "\"turn\""), "rotation"},
      {with("0.12", "1e300"), "out of range"},
      {with("\"dot\"", "7"), "'boards[1].board' is not a text in quotes"},
      {with("\"rig_from_board\"", "\"pose\""), "'boards[0].rig_from_board' is missing"},
      {with("\"boards\": [", "\"boards\": [3,"), "'boards' is not a list of groups"},
      {with("\"on\": ", "\"under\": "), "'fixed_boards[0].on' is missing"},
      {with("\"rms\": 0.2,", "\"unit\": \"mm\","), "'unit' is \"none\" where"},
      {with("\"rms\": 0.2,", "\"unit\": 1,"), "absent where they are metres"},
  };
  for (const auto& [text, word] : wrong) {
    const auto read = parse_rig(text, "rig.json");
    ASSERT_FALSE(read.has_value()) << word;
    EXPECT_NE(read.error().message.find(word), std::string::npos) << read.error().message;
    EXPECT_NE(read.error().message.find("Give a file that calvin-rig"), std::string::npos);
    EXPECT_TRUE(read.error().code == ErrorCode::kMalformed ||
                read.error().code == ErrorCode::kUnsupported)
        << read.error().message;
  }
}

TEST(RigFile, OfAnyBytesIsNoRig) {
  const std::string good = print_rig(sample()).value();
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::string cut = good.substr(0, i);
    EXPECT_FALSE(parse_rig(cut).has_value());
    std::string broken = good;
    broken[i] = '\x01';
    EXPECT_FALSE(parse_rig(broken).has_value());
  }
}

TEST(RigFile, IsNotWrittenOfABrokenCamera) {
  Rig rig = sample();
  rig.cameras[0].calibration.image_size = {};
  EXPECT_EQ(print_rig(rig).error().code, ErrorCode::kInvalidArgument);
}

// In no format, and what was there before stays.
TEST(RigFile, IsNotWrittenWhereNobodyCouldReadIt) {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Spoil = void (*)(Rig&);
  const std::pair<const char*, Spoil> spoilt[] = {
      {"no cameras", [](Rig& rig) { rig.cameras.clear(); }},
      {"'left'", [](Rig& rig) { rig.cameras[1].calibration.camera = "left"; }},
      {"place", [](Rig& rig) { rig.cameras[1].rig_from_camera.translation[0] = kNan; }},
      {"place", [](Rig& rig) { rig.cameras[1].rig_from_camera.rotation[2] = HUGE_VAL; }},
      {"6 x 6", [](Rig& rig) { rig.cameras[1].covariance.resize(5); }},
      {"negative variance", [](Rig& rig) { rig.cameras[1].covariance[7] = -1; }},
      {"rms", [](Rig& rig) { rig.rms = kNan; }},
      {"rms", [](Rig& rig) { rig.cameras[1].rms = kNan; }},
      {"chi", [](Rig& rig) { rig.cameras[1].calibration.chi = kNan; }},
      {"time_offset",
       [](Rig& rig) {
         rig.cameras[1].time_offset = TimeOffset{kNan, 0};
       }},
      {"The board", [](Rig& rig) { rig.boards[0].rig_from_board.translation[1] = kNan; }},
      {"The board", [](Rig& rig) { rig.fixed_boards[0].covariance.resize(35); }}};
  TemporaryFolder folder;
  for (const auto& [word, spoil] : spoilt) {
    Rig rig = sample();
    spoil(rig);
    for (const auto format : rig_formats()) {
      const std::string path = folder.path(("rig-" + std::string(format)).c_str());
      const bool is_folder = format == "mrcal" || format == "colmap";
      if (!is_folder) {
        ASSERT_TRUE(write_file(path, "as before").has_value());
      }
      const auto written = write_rig(path, rig, format);
      ASSERT_FALSE(written.has_value()) << format << ": " << word;
      EXPECT_EQ(written.error().code, ErrorCode::kInvalidArgument) << written.error().message;
      EXPECT_NE(written.error().message.find(word), std::string::npos) << written.error().message;
      EXPECT_EQ(std::filesystem::exists(path), !is_folder);
      if (!is_folder) {
        EXPECT_EQ(read_file(path).value(), "as before");
      }
    }
  }
}

}  // namespace
}  // namespace calvin
