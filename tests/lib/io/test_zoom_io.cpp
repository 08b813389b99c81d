// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The file of a zoom table: what is written is read again as the same, and whatever is wrong in a
// file is said by its place.
#include <string>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/settings.hpp"
#include "calvin/io/zoom_io.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

ZoomTable sample() {
  std::vector<Calibration> all;
  for (const double zoom : {300.0, 100.0, 200.0}) {
    const double f = 5 * zoom / 3;
    all.push_back(Camera::make("brown5", {640, 480}, {f, f, 320, 240, -0.1, 0, 0, 0, 0})
                      .value()
                      .to_calibration());
    all.back().camera = "box \"1\"";
    all.back().zoom = zoom;
    all.back().focus = zoom / 7;
    all.back().parameters[0].sigma = 0.3;
    all.back().covariance = {0.09};
    all.back().device = CaptureDevice{"/dev/video0", "Box", "usb-1", false};
  }
  ZoomTable table = make_zoom_table(std::move(all)).value();
  table.settings[1].left_out = 0.25;
  return table;
}

TEST(ZoomFile, IsReadAsItWasWritten) {
  const ZoomTable table = sample();
  const auto text = print_zoom_table(table);
  ASSERT_TRUE(text.has_value()) << text.error().message;
  EXPECT_TRUE(is_zoom_table(*text));
  const auto read = parse_zoom_table(*text);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(print_zoom_table(*read).value(), *text);
  EXPECT_EQ(read->camera, "box \"1\"");
  ASSERT_EQ(read->settings.size(), 3U);
  EXPECT_EQ(read->settings[0].calibration.zoom, 100);
  EXPECT_EQ(read->settings[2].calibration.focus, 300.0 / 7);
  EXPECT_EQ(read->settings[1].left_out, 0.25);
  EXPECT_FALSE(read->settings[0].left_out.has_value());
  EXPECT_EQ(read->settings[1].calibration.covariance.size(), 1U);
  EXPECT_EQ(read->settings[1].calibration.device->name, "Box");
}

TEST(ZoomFile, GoesToADiskAndBackAndIsASetting) {
  const TemporaryFolder folder;
  const std::string path = folder.path("zoom.json");
  ASSERT_TRUE(write_zoom_table(path, sample()).has_value());
  const auto read = read_zoom_table(path);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  for (const std::string& text : {path, print_zoom_table(sample()).value()}) {
    const auto setting = parse_camera_setting(text);
    ASSERT_TRUE(setting.has_value()) << setting.error().message;
    ASSERT_TRUE(std::holds_alternative<ZoomTable>(*setting));
    EXPECT_EQ(print_zoom_table(std::get<ZoomTable>(*setting)).value(),
              print_zoom_table(*read).value());
  }
  // A single camera is another thing, and says what this is.
  const auto single = read_calibration(path);
  ASSERT_FALSE(single.has_value());
  EXPECT_NE(single.error().message.find("calvin-zoom"), std::string::npos);
  EXPECT_EQ(read_zoom_table(folder.path("none")).error().code, ErrorCode::kNotFound);
}

// Settings may stand in any order: what belongs to one goes with it.
TEST(ZoomFile, MayBeInAnyOrder) {
  ZoomTable table = sample();
  std::swap(table.settings[0], table.settings[1]);
  const auto read = parse_zoom_table(print_zoom_table(table).value());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(print_zoom_table(*read).value(), print_zoom_table(sample()).value());
}

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = print_zoom_table(sample()).value();
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  const auto read = parse_zoom_table(text, "zoom.json");
  return read ? "" : read.error().message;
}

TEST(ZoomFile, SaysWhatIsWrong) {
  const auto says = [](const std::string& text, const char* part) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(part), std::string::npos) << part << " is not in: " << message;
    EXPECT_NE(message.find("'zoom.json'"), std::string::npos) << message;
  };
  says("", "zoom table");
  says("[]", "none of the fields");
  says("{\"format\": \"calvin-rig\"}", "calvin-rig");
  says(replaced("\"version\": 1", "\"version\": 2"), "newer version");
  says("{\"format\": \"calvin-zoom\", \"version\": 1}", "two settings");
  says("{\"format\": \"calvin-zoom\", \"version\": 1, \"settings\": [1, 2]}", "list of groups");
  says(replaced("\"zoom\": 200", "\"zoom\": \"far\""), "settings[1].zoom");
  says(replaced("\"zoom\": 200", "\"room\": 200"), "settings[1].zoom");
  says(replaced("\"left_out\": 0.25", "\"left_out\": -1"), "settings[1].left_out");
  says(replaced("\"brown5\"", "\"brown6\""), "settings[0].calibration");
  says(replaced("640", "320"), "size of images");
}

TEST(ZoomFile, IsNotWhatOthersAre) {
  EXPECT_FALSE(is_zoom_table(""));
  EXPECT_FALSE(is_zoom_table("{\"format\": \"calvin-calibration\", \"camera\": \"calvin-zoom\"}"));
  EXPECT_FALSE(is_zoom_table("calvin-zoom"));
  EXPECT_FALSE(is_zoom_table("{\"format\": \"calvin-zoom\""));
  EXPECT_TRUE(is_zoom_table("{\"format\": \"calvin-zoom\"}"));
}

}  // namespace
}  // namespace calvin
