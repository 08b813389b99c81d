// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Key lists, the text of the property `calibration`, and files: found, missing, unreadable,
// unwritable, replaced whole.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/key_list.hpp"
#include "calvin/io/settings.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"
#include "temporary_folder.hpp"

namespace calvin {
namespace {

namespace fs = std::filesystem;

TEST(KeyList, GuessesTheModel) {
  const auto model = [](const std::string& more) {
    const auto c = parse_key_list("fx=520,fy=518,cx=325,cy=236" + more);
    return c ? c->model : c.error().message;
  };
  EXPECT_EQ(model(""), "pinhole");
  EXPECT_EQ(model(",skew=0.1"), "pinhole");
  EXPECT_EQ(model(", k1 = -0.28"), "brown4");
  EXPECT_EQ(model(",p2=1e-3"), "brown4");
  EXPECT_EQ(model(",k3=0"), "brown5");
  EXPECT_EQ(model(",k1=-0.02,k4=0.1,model=fisheye"), "fisheye");
  EXPECT_EQ(model(",k1=-0.02,model=brown5"), "brown5");
}

TEST(KeyList, Values) {
  const auto c =
      parse_key_list("width=640,height=480,k2=0.09,k1=-0.28,fx=520,fy=518,cx=325,cy=236");
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_EQ(c->image_size, (ImageSize{640, 480}));
  const std::vector<double> expected = {520, 518, 325, 236, -0.28, 0.09, 0, 0};
  EXPECT_EQ(Camera::make(*c)->parameters(), expected);
  EXPECT_EQ(parse_key_list("fx=520,fy=518,cx=325,cy=236")->image_size, ImageSize{});
}

TEST(KeyList, WrongTextsShowARightOne) {
  const std::string good = "fx=520,fy=518,cx=325,cy=236";
  for (const std::string& text :
       std::vector<std::string>{"=",
                                "fx",
                                "fx=520",
                                "fx=520,fy=518,cx=325",
                                good + ",",
                                good + ",fx=520",
                                good + ",k7=1",
                                good + ",k4=1",
                                good + ",K1=1",
                                good + ",k1=",
                                good + ",k1=abc",
                                good + ",k1=nan",
                                good + ",k1=inf",
                                good + ",k1=1e999",
                                good + ",k1=0,1",
                                good + ",width=640",
                                good + ",width=640,height=0",
                                good + ",width=640,height=a",
                                good + ",width=70000,height=2",
                                good + ",model=brown",
                                good + ",model=pinhole,k1=0",
                                good + ",k1=1=2",
                                "fx=-520,fy=518,cx=325,cy=236",
                                "fx=0,fy=518,cx=325,cy=236",
                                std::string(100000, '='),
                                good + "," + std::string(100000, 'k') + "=1"}) {
    const auto c = parse_key_list(text);
    ASSERT_FALSE(c) << text;
    const auto at = c.error().message.find("A right text is '");
    ASSERT_NE(at, std::string::npos) << c.error().message;
    EXPECT_LT(c.error().message.size(), 1000U);
    // And the right one is right.
    const std::string right = c.error().message.substr(at + 17);
    EXPECT_TRUE(parse_key_list(right.substr(0, right.find('\''))));
  }
}

class Folder : public ::testing::Test {
 protected:
  std::size_t entries() const { return temporary_.entries(); }

  TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(Folder, SettingInItsOrder) {
  const auto code = [](const std::string& text) {
    const auto c = parse_calibration_setting(text);
    return c ? -1 : static_cast<int>(c.error().code);
  };
  EXPECT_EQ(code(test::kNativeFile), -1);
  EXPECT_EQ(code("  \n" + std::string(test::kOpenCvJsonFile)), -1);
  EXPECT_EQ(code("fx=520,fy=518,cx=325,cy=236"), -1);
  if (CALVIN_HAVE_FORMATS) {
    EXPECT_EQ(code(test::kOpenCvXmlFile), -1);
    EXPECT_EQ(code(test::kOpenCvYamlFile), -1);
  }
  const std::string missing = (folder_ / "later.json").string();
  EXPECT_EQ(code(missing), static_cast<int>(ErrorCode::kNotFound));
  EXPECT_TRUE(is_calibration_path(missing));
  ASSERT_TRUE(write_calibration(missing, test::sample("brown5")));
  EXPECT_EQ(code(missing), -1);
  EXPECT_EQ(code(""), static_cast<int>(ErrorCode::kMalformed));
  EXPECT_EQ(code(folder_.string()), static_cast<int>(ErrorCode::kIo));
  EXPECT_EQ(code("{"), static_cast<int>(ErrorCode::kMalformed));
  EXPECT_NE(code(std::string(100000, 'x')), -1);
  EXPECT_FALSE(is_calibration_path("fx=520"));
  EXPECT_FALSE(is_calibration_path(" {}"));
  for (const char* text : {"", " {}", "<a/>", "%YAML:1.0", "fx=520"}) {
    EXPECT_FALSE(may_be_calibration_path(text)) << text;
  }
  for (const char* text : {"cam.json", "/no/such/cam.json", "/no/such/fx=1.json"}) {
    EXPECT_TRUE(may_be_calibration_path(text)) << text;
  }

  // A file whose name has an equals sign is a file.
  const std::string odd = (folder_ / "fx=1.json").string();
  ASSERT_TRUE(write_calibration(odd, test::sample("fisheye")));
  ASSERT_TRUE(is_calibration_path(odd));
  EXPECT_EQ(parse_calibration_setting(odd)->model, "fisheye");
}

TEST_F(Folder, TheContentCountsNotTheName) {
  const fs::path path = folder_ / "camera.yaml";
  ASSERT_TRUE(write_calibration(path, test::sample("brown4"), "opencv-json"));
  const auto c = read_calibration(path);
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_EQ(c->model, "brown4");
}

TEST_F(Folder, UnreadableFiles) {
  const auto error = [](const fs::path& path) {
    const auto c = read_calibration(path);
    EXPECT_FALSE(c);
    EXPECT_NE(c.error().message.find(path.string()), std::string::npos) << c.error().message;
    EXPECT_NE(c.error().message.find("Give a calibration"), std::string::npos);
    return c.error().code;
  };
  EXPECT_EQ(error(folder_ / "none.json"), ErrorCode::kNotFound);
  EXPECT_EQ(error(folder_), ErrorCode::kIo);
  EXPECT_EQ(error("/dev/zero"), ErrorCode::kIo);
  const fs::path fifo = folder_ / "fifo";
  ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
  EXPECT_EQ(error(fifo), ErrorCode::kIo);
  const fs::path huge = folder_ / "huge.json";
  std::ofstream(huge) << "{";
  for (const std::uintmax_t size : {std::uintmax_t{1} << 40, std::uintmax_t{17} << 20}) {
    fs::resize_file(huge, size);
    EXPECT_EQ(error(huge), ErrorCode::kIo);
  }
}

TEST_F(Folder, UnwritablePlaces) {
  const auto c = test::sample("brown5");
  fs::create_directory(folder_ / "folder");
  for (const fs::path& path : {folder_ / "no" / "such" / "cam.json", folder_ / "folder",
                               fs::path("/proc/calvin.json"), fs::path()}) {
    const auto status = write_calibration(path, c);
    ASSERT_FALSE(status) << path;
    EXPECT_EQ(status.error().code, ErrorCode::kIo);
    EXPECT_NE(status.error().message.find(path.string()), std::string::npos);
    EXPECT_NE(status.error().message.find("Choose a place"), std::string::npos);
    EXPECT_EQ(entries(), 1U) << "a temporary file is left";
  }
  EXPECT_FALSE(can_write(folder_ / "no" / "cam.json"));
  EXPECT_FALSE(can_write(folder_ / "folder"));
  EXPECT_TRUE(can_write(folder_ / "cam.json"));
  EXPECT_EQ(entries(), 1U) << "can_write() wrote";
  if (fs::exists("/dev/full")) {
    const auto status = write_calibration("/dev/full", c);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kIo);
  }
}

TEST_F(Folder, WritesReplaceWhole) {
  const auto c = test::sample("brown5");
  const fs::path path = folder_ / "cam.json";
  const mode_t before = ::umask(027);
  ASSERT_TRUE(write_calibration(path, c));
  ::umask(before);
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0640U);
  const auto inode = info.st_ino;

  // A reader of the old file keeps it: replaced, not overwritten.
  const fs::path link = folder_ / "link.json";
  fs::create_symlink("cam.json", link);
  std::ifstream old(path);
  ASSERT_TRUE(write_calibration(link, test::sample("fisheye")));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_calibration(path)->model, "fisheye");
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_NE(info.st_ino, inode);
  const std::string kept{std::istreambuf_iterator<char>(old), {}};
  EXPECT_EQ(parse_calibration(kept)->model, "brown5");
  EXPECT_EQ(entries(), 2U);
}

}  // namespace
}  // namespace calvin
