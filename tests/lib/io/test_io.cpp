// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Calibration files: every format with every model, there and back, judged by projected points.
#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin/io/key_list.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"

namespace calvin {
namespace {

using test::grid;
using test::holds;
using test::readable;

// The largest distance between two cameras' images of the same points, px.
double difference(const Calibration& a, const Calibration& b) {
  Calibration sized = b;
  if (sized.image_size == ImageSize{}) sized.image_size = a.image_size;
  const auto camera_a = Camera::make(a);
  const auto camera_b = Camera::make(sized);
  EXPECT_TRUE(camera_a && camera_b);
  if (!camera_a || !camera_b) return 1e9;
  double largest = 0;
  for (const auto& point : grid()) {
    const auto uv_a = camera_a->project(point);
    const auto uv_b = camera_b->project(point);
    EXPECT_TRUE(uv_a && uv_b);
    if (!uv_a || !uv_b) return 1e9;
    largest = std::max(largest, std::hypot(uv_a->u - uv_b->u, uv_a->v - uv_b->v));
  }
  return largest;
}

// The camera of the sample files, in the textbook's own words (x right, z = 1).
Pixel textbook(double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1 - 0.28 * r2 + 0.09 * r2 * r2;
  return {520 * (x * radial + 2 * 0.0005 * x * y - 0.0007 * (r2 + 2 * x * x)) + 325,
          518 * (y * radial + 0.0005 * (r2 + 2 * y * y) - 2 * 0.0007 * x * y) + 236};
}

TEST(CalibrationFile, EveryFormatHoldsEveryModelThatItCan) {
  for (const std::string_view format : test::formats_with_skew()) {
    if (!readable(format)) continue;
    for (const std::string_view model : model_names()) {
      SCOPED_TRACE(std::string(format) + " " + std::string(model));
      Calibration calibration = test::sample(std::string(model));
      for (const double skew : {0.0, 0.7}) {
        if (skew != 0) calibration.parameters.push_back({"skew", skew, {}});
        const auto text = print_calibration(calibration, format);
        if (!holds(format, model)) {
          ASSERT_FALSE(text);
          EXPECT_EQ(text.error().code, ErrorCode::kUnsupported);
          EXPECT_NE(text.error().message.find(model), std::string::npos) << text.error().message;
          continue;
        }
        ASSERT_TRUE(text) << text.error().message;
        EXPECT_EQ(text->find("rational_polynomial") != std::string::npos,
                  format == "ros" && model == "rational8");
        const auto back = parse_calibration(*text);
        ASSERT_TRUE(back) << back.error().message << "\n" << *text;
        EXPECT_EQ(back->image_size, calibration.image_size);
        EXPECT_LT(difference(calibration, *back), 1e-6);
        for (const Parameter& p : calibration.parameters) {
          ASSERT_NE(back->find(p.name), nullptr) << p.name;
          EXPECT_EQ(back->find(p.name)->value, p.value) << p.name;
        }
      }
    }
  }
}

TEST(CalibrationFile, CoefficientsThatAreAllZeroAreNotWritten) {
  for (const std::string_view format : test::formats_with_skew()) {
    if (!readable(format) || format == "calvin") continue;
    SCOPED_TRACE(format);
    Calibration calibration = test::sample("tilted14");
    for (Parameter& p : calibration.parameters) {
      if (p.name[0] == 's' || p.name[0] == 't') p.value = 0;
    }
    const auto text = print_calibration(calibration, format);
    ASSERT_TRUE(text) << text.error().message;
    const auto back = parse_calibration(*text);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->model, "rational8");
    EXPECT_EQ(difference(calibration, *back), 0);
    EXPECT_EQ(print_calibration(*back, format).value(), *text);
  }
}

TEST(CalibrationFile, FilesOfOtherSoftware) {
  for (const std::string& file : test::sample_files()) {
    if (!CALVIN_HAVE_FORMATS && file[0] != '{') continue;
    SCOPED_TRACE(file.substr(0, 40));
    auto calibration = parse_calibration(file);
    ASSERT_TRUE(calibration) << calibration.error().message;
    if (calibration->image_size == ImageSize{}) calibration->image_size = {640, 480};
    EXPECT_EQ(calibration->model, "brown5");
    const auto camera = Camera::make(*calibration);
    ASSERT_TRUE(camera);
    for (const auto& point : grid()) {
      const Pixel truth = textbook(point.x() / point.z(), point.y() / point.z());
      const auto uv = camera->project(point);
      ASSERT_TRUE(uv);
      EXPECT_NEAR(uv->u, truth.u, 1e-9);
      EXPECT_NEAR(uv->v, truth.v, 1e-9);
    }
  }
}

TEST(CalibrationFile, RosWithoutDistortion) {
  if (!readable("ros")) GTEST_SKIP() << "built without formats";
  const auto c = parse_calibration(
      "image_width: 640\nimage_height: 480\ncamera_name: c\ndistortion_model: plumb_bob\n"
      "camera_matrix: {rows: 3, cols: 3, data: [520, 0, 325, 0, 518, 236, 0, 0, 1]}\n"
      "distortion_coefficients: {rows: 1, cols: 0, data: []}\n");
  ASSERT_TRUE(c) << c.error().message;
  EXPECT_EQ(c->model, "pinhole");
}

TEST(CalibrationFile, WindowsLineEndsAndByteOrderMark) {
  for (const std::string& file : test::sample_files()) {
    if (!CALVIN_HAVE_FORMATS && file[0] != '{') continue;
    std::string text = "\xEF\xBB\xBF";
    for (const char c : file) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
    const auto calibration = parse_calibration(text);
    ASSERT_TRUE(calibration) << calibration.error().message << "\n" << text;
    EXPECT_EQ(difference(*parse_calibration(test::kNativeFile), *calibration), 0);
  }
}

TEST(CalibrationFile, NativeHoldsEverything) {
  Calibration c = test::sample("brown4");
  c.camera = "left \"\xC3\xA4\"";
  c.parameters[0].sigma = 0.4;
  c.parameters[3].sigma = 1.0 / 3;
  c.covariance = {0.16, 0.01, 0.01, 1.0 / 9};
  c.rms = 0.19;
  c.held_out_rms = 0.2;
  c.chi = 1.02;
  c.expected_error = 0.08;
  c.expected_error_anywhere = 0.3;
  c.worst_place = Pixel{639, 479.5};
  c.split_half_ratio = 1.1;
  c.misfit = "board";
  c.remarks = {"The board is \"bent\".", "Tilt it."};
  c.covered = {{10, 10}, {630.5, 10}, {630.5, 470}};
  c.board = "checkerboard:9x6:30mm";
  c.warp = BoardWarp{1e-4, -2e-5};
  c.views = {{18446744073709551614U, 0.18, 54, false, {{0.1, -0.2, 1e-300}, {0, 0.01, 0.5}}},
             {kNoTimestamp, 0.21, 50, true, {{0, 0, 3}, {-0.1, 0, 0.7}}}};
  c.sensor_crop = Rectangle{160, 120, 320.5, 240};
  c.device = CaptureDevice{"/dev/video2", "HD \"Pro\" Webcam", "usb-0000:00:14.0-1", false};
  c.focus = 200;
  c.zoom = 0;
  c.created = "2026-11-21T10:00:00Z";
  const auto text = print_calibration(c);
  ASSERT_TRUE(text);
  const auto back = parse_calibration(*text);
  ASSERT_TRUE(back) << back.error().message << *text;
  EXPECT_EQ(back->camera, c.camera);
  EXPECT_EQ(back->parameters[0].sigma, c.parameters[0].sigma);
  EXPECT_EQ(back->parameters[1].sigma, std::nullopt);
  EXPECT_EQ(back->covariance, c.covariance);
  EXPECT_EQ(back->rms, c.rms);
  EXPECT_EQ(back->held_out_rms, c.held_out_rms);
  EXPECT_EQ(back->chi, c.chi);
  EXPECT_EQ(back->expected_error, c.expected_error);
  EXPECT_EQ(back->expected_error_anywhere, c.expected_error_anywhere);
  ASSERT_TRUE(back->worst_place);
  EXPECT_EQ(back->worst_place->u, 639);
  EXPECT_EQ(back->worst_place->v, 479.5);
  EXPECT_EQ(back->split_half_ratio, c.split_half_ratio);
  EXPECT_EQ(back->misfit, c.misfit);
  EXPECT_EQ(back->remarks, c.remarks);
  ASSERT_EQ(back->covered.size(), 3U);
  EXPECT_EQ(back->covered[1].u, 630.5);
  EXPECT_EQ(back->board, c.board);
  ASSERT_TRUE(back->warp);
  EXPECT_EQ(back->warp->ky, -2e-5);
  ASSERT_EQ(back->views.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->views[i].timestamp, c.views[i].timestamp);
    EXPECT_EQ(back->views[i].rms, c.views[i].rms);
    EXPECT_EQ(back->views[i].points, c.views[i].points);
    EXPECT_EQ(back->views[i].held_out, c.views[i].held_out);
    EXPECT_EQ(back->views[i].camera_from_board.rotation, c.views[i].camera_from_board.rotation);
    EXPECT_EQ(back->views[i].camera_from_board.translation,
              c.views[i].camera_from_board.translation);
  }
  ASSERT_TRUE(back->sensor_crop);
  EXPECT_EQ(back->sensor_crop->width, 320.5);
  ASSERT_TRUE(back->device);
  EXPECT_EQ(back->device->node, "/dev/video2");
  EXPECT_EQ(back->device->name, "HD \"Pro\" Webcam");
  EXPECT_EQ(back->device->bus, "usb-0000:00:14.0-1");
  EXPECT_EQ(back->device->autofocus, false);
  EXPECT_EQ(back->focus, 200);
  EXPECT_EQ(back->zoom, 0);
  EXPECT_EQ(back->created, c.created);
  EXPECT_EQ(*print_calibration(*back), *text);
}

TEST(CalibrationFile, NativeIsWhatTheDocumentationShows) {
  Calibration c = test::sample("pinhole");
  c.parameters[0].value = 520.5;
  c.parameters[1].value = 518;
  c.parameters[3].value = 236;
  c.views = {{7, 0.25, 54, false, {}}};
  EXPECT_EQ(*print_calibration(c), R"({
  "format": "calvin-calibration",
  "version": 1,
  "camera": "cam0",
  "image_size": [640, 480],
  "model": "pinhole",
  "parameters": {"fx": 520.5, "fy": 518, "cx": 325, "cy": 236},
  "views": [
    {"timestamp": 7, "rms": 0.25, "points": 54, "held_out": false, "camera_from_board": {"rotation": [0, 0, 0], "translation": [0, 0, 0]}}
  ]
}
)");
}

// The parameters of the file may stand in any order; the covariance is in that of the file.
TEST(CalibrationFile, ParametersInAnotherOrder) {
  const auto c = parse_calibration(
      R"({"format": "calvin-calibration", "version": 1, "image_size": [640, 480], "model": "pinhole",
      "parameters": {"cy": 236, "skew": 0.5, "cx": 325, "fy": 518, "fx": 520},
      "sigma": {"fx": 2, "cy": 3, "skew": 5}, "covariance": [[9, 1, 2], [1, 25, 3], [2, 3, 4]]})");
  ASSERT_TRUE(c) << c.error().message;
  const std::vector<std::string> names = {"fx", "fy", "cx", "cy", "skew"};
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(c->parameters[i].name, names[i]);
  // fx cy skew
  EXPECT_EQ(c->covariance, (std::vector<double>{4, 2, 3, 2, 9, 1, 3, 1, 25}));
}

TEST(CalibrationFile, NoNumberThatIsNotFiniteIsWritten) {
  Calibration c = test::sample("brown5");
  c.parameters[5].value = INFINITY;
  for (const auto format : test::formats_with_skew()) EXPECT_FALSE(print_calibration(c, format));
}

// Whether the format has a place for it or not.
TEST(CalibrationFile, NothingIsWrittenThatNobodyReads) {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Spoil = void (*)(Calibration&);
  const std::pair<const char*, Spoil> spoilt[] = {
      {"rms", [](Calibration& c) { c.rms = kNan; }},
      {"rms", [](Calibration& c) { c.rms = INFINITY; }},
      {"chi", [](Calibration& c) { c.chi = -1; }},
      {"expected_error", [](Calibration& c) { c.expected_error = kNan; }},
      {"split_half_ratio", [](Calibration& c) { c.split_half_ratio = kNan; }},
      {"systematic", [](Calibration& c) { c.systematic = 1.5; }},
      {"readout", [](Calibration& c) { c.readout = INFINITY; }},
      {"focus", [](Calibration& c) { c.focus = kNan; }},
      {"worst_place",
       [](Calibration& c) {
         c.worst_place = Pixel{1, kNan};
       }},
      {"covered",
       [](Calibration& c) {
         c.covered = {{kNan, 1}};
       }},
      {"warp ky",
       [](Calibration& c) {
         c.warp = BoardWarp{0, kNan};
       }},
      {"views",
       [](Calibration& c) {
         c.views = {{0, kNan, 54, false, {}}};
       }},
      {"views",
       [](Calibration& c) {
         c.views = {{0, 0.1, 54, false, {{0, kNan, 0}, {}}}};
       }},
      {"sensor_crop",
       [](Calibration& c) {
         c.sensor_crop = Rectangle{0, 0, 641, 480};
       }},
      {"sigma of fx", [](Calibration& c) { c.parameters[0].sigma = -3; }},
      {"sigma of fx", [](Calibration& c) { c.parameters[0].sigma = kNan; }},
      {"covariance", [](Calibration& c) { c.covariance = {kNan}; }},
      {"negative variance", [](Calibration& c) {
         c.parameters[0].sigma = 1;
         c.covariance = {-1};
       }}};
  for (const auto& [word, spoil] : spoilt) {
    Calibration c = test::sample("brown4");  // which all formats hold
    for (const auto format : calibration_formats()) {
      ASSERT_TRUE(print_calibration(c, format)) << format;
    }
    spoil(c);
    for (const auto format : calibration_formats()) {
      const auto text = print_calibration(c, format);
      ASSERT_FALSE(text) << format << ": " << word;
      EXPECT_EQ(text.error().code, ErrorCode::kInvalidArgument) << text.error().message;
      EXPECT_NE(text.error().message.find(word), std::string::npos) << text.error().message;
    }
  }
}

TEST(CalibrationFile, FormatsThatCannotHoldIt) {
  EXPECT_FALSE(print_calibration(test::sample("brown5"), "kalibre"));
  Calibration c = test::sample("brown5");
  c.image_size = {};
  EXPECT_FALSE(print_calibration(c, "calvin"));
  EXPECT_FALSE(print_calibration(c, "ros"));
  const auto text = print_calibration(c, "opencv-json");
  ASSERT_TRUE(text);
  const auto back = parse_calibration(*text);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->image_size, ImageSize{});
}

// A character in UTF-8.
std::string utf8(unsigned code) {
  const auto tail = [code](int shift) { return static_cast<char>(0x80 | (code >> shift & 0x3F)); };
  if (code < 0x80) return {static_cast<char>(code)};
  if (code < 0x800) return {static_cast<char>(0xC0 | code >> 6), tail(0)};
  if (code < 0x10000) return {static_cast<char>(0xE0 | code >> 12), tail(6), tail(0)};
  return {static_cast<char>(0xF0 | code >> 18), tail(12), tail(6), tail(0)};
}

// What YAML 1.2 (5.1, 5.4) does not count as printable, or folds as the end of a line, stands in
// no file as it is; PyYAML, which ROS reads with, refuses the first and changes the second. Every
// name is read back.
TEST(CalibrationFile, NamesOfAnyCharacterAreReadBack) {
  std::vector<unsigned> control = {0x7F, 0x2028, 0x2029, 0xFEFF, 0xFFFE, 0xFFFF};
  for (unsigned code = 0; code < 0x20; ++code) control.push_back(code);
  for (unsigned code = 0x80; code < 0xA0; ++code) control.push_back(code);
  std::vector<unsigned> all = {'"', '\\', '#', ':', 0xA0, 0xE4, 0x2027, 0x20AC, 0xFFFD, 0x1F600};
  all.insert(all.end(), control.begin(), control.end());
  for (const unsigned code : all) {
    Calibration c = test::sample("brown5");
    const std::string word = fmt::format("a{}b", utf8(code));
    c.camera = fmt::format("{} {}", word, utf8(code));
    for (const std::string_view format : test::formats_with_skew()) {
      const auto text = print_calibration(c, format);
      ASSERT_TRUE(text) << text.error().message;
      if (std::find(control.begin(), control.end(), code) != control.end()) {
        EXPECT_EQ(text->find(word), std::string::npos) << format << " " << code;
      }
      if ((format != "ros" && format != "calvin") || !readable(format)) continue;
      const auto back = parse_calibration(*text);
      ASSERT_TRUE(back) << format << " " << code << ": " << back.error().message;
      EXPECT_EQ(back->camera, c.camera) << format << " " << code;
    }
  }
}

// A decimal comma: of the C library (if the system has one), and of C++ streams in any case.
class Comma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

void expect_same_numbers() {
  for (const std::string_view format : test::formats_with_skew()) {
    if (!readable(format)) continue;
    const auto text = print_calibration(test::sample("brown5"), format);
    ASSERT_TRUE(text);
    EXPECT_NE(text->find("520.1234567890123"), std::string::npos) << *text;
    const auto back = parse_calibration(*text);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->find("fy")->value, 518.0 + 1.0 / 3);
  }
  const auto list = parse_key_list("fx=520.5,fy=518,cx=325,cy=236");
  ASSERT_TRUE(list);
  EXPECT_EQ(list->find("fx")->value, 520.5);
}

TEST(CalibrationFile, StreamsWithADecimalComma) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  expect_same_numbers();
  std::locale::global(before);
}

TEST(CalibrationFile, LocaleWithADecimalComma) {
  if (std::setlocale(LC_ALL, "de_DE.UTF-8") == nullptr) {
    GTEST_SKIP() << "the locale de_DE.UTF-8 is not installed";
  }
  expect_same_numbers();
  std::setlocale(LC_ALL, "C");
}

}  // namespace
}  // namespace calvin
