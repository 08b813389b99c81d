// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What io/ does with bad input: a message that tells what to do; never a crash, never a number that
// is not finite. Also key lists, the text of the property, and files that cannot be read or
// written.
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/io/calibration_io.hpp"
#include "calvin_config.h"
#include "io_samples.hpp"

namespace calvin {
namespace {

// Whatever comes back is either an error with a message, or a camera of finite numbers.
void expect_sound(const Result<Calibration>& result, const std::string& input) {
  if (!result) {
    EXPECT_GT(result.error().message.size(), 40U);
    EXPECT_LT(result.error().message.size(), 1500U);
    return;
  }
  Calibration c = *result;
  for (const Parameter& p : c.parameters) {
    EXPECT_TRUE(std::isfinite(p.value)) << input;
    EXPECT_TRUE(!p.sigma || std::isfinite(*p.sigma)) << input;
  }
  EXPECT_TRUE(!c.rms || std::isfinite(*c.rms)) << input;
  if (c.image_size == ImageSize{}) c.image_size = {640, 480};
  EXPECT_TRUE(Camera::make(c)) << input;
}

std::string native(std::string_view change, std::string_view with) {
  std::string text = test::kNativeFile;
  const auto at = text.find(change);
  EXPECT_NE(at, std::string::npos) << change;
  return text.replace(at, change.size(), with);
}

std::string in(const char* file, std::string_view change, std::string_view with) {
  std::string text = file;
  const auto at = text.find(change);
  EXPECT_NE(at, std::string::npos) << change;
  return text.replace(at, change.size(), with);
}

std::string repeated(std::string_view text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

struct Bad {
  std::string text;
  std::string says;  // the message must hold this; empty: any
};

void expect_refused(const Bad& bad) {
  const auto result = parse_calibration(bad.text, "cam.json");
  ASSERT_FALSE(result) << bad.text.substr(0, 2000);
  const std::string& message = result.error().message;
  // Whatever its numbers are, the caller's arguments are right.
  EXPECT_TRUE(result.error().code == ErrorCode::kMalformed ||
              result.error().code == ErrorCode::kUnsupported)
      << message;
  EXPECT_NE(message.find("'cam.json' cannot be used as a calibration: "), std::string::npos)
      << message;
  EXPECT_NE(message.find("Give a calibration"), std::string::npos) << message;
  EXPECT_NE(message.find(bad.says), std::string::npos)
      << message << "\nshould hold: " << bad.says << "\nfor " << bad.text.substr(0, 2000);
  EXPECT_LT(message.size(), 1500U);
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

// A promise of which any other is worse: no result would take the file's place.
TEST(BadContent, QualityThatCannotBe) {
  const std::string head =
      R"({"format": "calvin-calibration", "version": 1, "image_size": [640, 480],
      "model": "pinhole", "parameters": {"fx": 500, "fy": 500, "cx": 320, "cy": 240}, )";
  ASSERT_TRUE(parse_calibration(head + R"("expected_error": 0, "systematic": 1})", "cam.json"));
  const std::vector<Bad> table = {
      {head + R"("expected_error": -0.1})", "'expected_error' is negative"},
      {head + R"("expected_error": 1, "expected_error_anywhere": -1e-9})",
       "'expected_error_anywhere' is negative"},
      {head + R"("systematic": 1.5})", "'systematic' is not a share from 0 to 1"},
      {head + R"("systematic": -0.1})", "'systematic' is not a share from 0 to 1"},
      {head + R"("rms": -1})", "'rms' is negative"},
  };
  for (const Bad& bad : table) expect_refused(bad);
}

TEST(BadContent, NotACalibration) {
  const std::vector<Bad> table = {
      {"", "empty"},
      {" \n\t ", "empty"},
      {"\xEF\xBB\xBF", "empty"},
      {std::string("\x7f"
                   "ELF\x02\x01\x01\0\0\0",
                   10),
       "not text"},
      {std::string("\x89PNG\r\n\x1a\n", 8), "not text"},
      {std::string(4096, '\0'), "not text"},
      {std::string("\xFF\xFE{\0\"\0", 6), "it is UTF-16 text: save it as UTF-8"},
      {std::string("\xFE\xFF\0{\0\"", 6), "it is UTF-16 text: save it as UTF-8"},
      {"// the left one\n{\"a\": 1}", "JSON with a comment in line 1"},
      {"\n\n/* the left one */ {\"a\": 1}", "JSON with a comment in line 3"},
      {"\xFF\xD8\xFF\xE1 jpeg", ""},
      {"hello", ""},
      {"42", ""},
      {"[]", ""},
      {"{}", "none of the fields"},
      {"{\"a\": 1}", "none of the fields"},
      {"{\"a\": 1} trailing", "line 1"},
      {"<html></html>", ""},
      {"<opencv_storage></opencv_storage>", ""},
      {"<opencv_storage>", ""},
      {"%YAML:1.0\n---\n", ""},
      {"a: *b", ""},
      {"a: &b [1]\nc: *b\ncamera_matrix: *b", ""},
      {"{\"format\": \"calvin-rig\", \"version\": 1}", "calvin-rig"},
      {"{\"format\": 5, \"version\": 1}", "format"},
      {repeated("[", 100), ""},
      {"{\"format\": " + repeated("[", 100) + repeated("]", 100) + "}", "deep"},
      {"{\"format\": " + repeated("{\"a\":", 100) + "1" + repeated("}", 101), "deep"},
      {repeated("<a>", 100) + repeated("</a>", 100), ""},
      {repeated("[", 10'000'000), ""},
      {repeated("{", 10'000'000), ""},
      {repeated("- ", 1'000'000), ""},
      {repeated("{\"a\":", 2'000'000), ""},
      {repeated("<a>", 1'000'000), ""},
      {"%YAML:1.0\n---\n" + repeated("[", 1'000'000), "deep"},
      {"a: " + repeated("[{b: ", 100'000), "deep"},
      {"{\"format\": [" + repeated("1,", 3'000'000) + "1]}", "values"},
      {std::string(1'000'000, 'a'), ""},
      {'"' + std::string(1'000'000, 'a'), ""},
      {repeated("? ", 100'000), ""},
  };
  for (const Bad& bad : table) {
    if (!CALVIN_HAVE_FORMATS && bad.text[0] != '{') continue;
    expect_refused(bad);
  }
}

TEST(BadContent, Native) {
  const std::vector<Bad> table = {
      {native("\"fx\": 520", "\"fx\": NaN"), "line 3"},
      {native("\"fx\": 520", "\"fx\": nan"), "line 3"},
      {native("\"fx\": 520", "\"fx\": Infinity"), "line 3"},
      {native("\"fx\": 520", "\"fx\": 1e999"),
       "'parameters.fx' is 1e999 in line 3, which is more than a number can be"},
      {native("\"fx\": 520", "\"fx\": -1e400"), "'parameters.fx' is -1e400"},
      {native("[640, 480]", "[640, 1e400]"), "'image_size[1]' is 1e400"},
      {native("\"fx\": 520", "\"fx\": 520 // px\n"), "JSON with a comment in line 3"},
      {native("\"fx\": 520", "/* px */ \"fx\": 520"), "JSON with a comment in line 3"},
      {native("\"fx\": 520", "\"fx\": /520"), "the JSON is broken in line 3, at '/520'"},
      {native("\"fx\": 520", "\"fx\": null"), "'parameters.fx' is not a finite number"},
      {native("\"fx\": 520", "\"fx\": \"520\""), "'parameters.fx'"},
      {native("\"fx\": 520", "\"fx\": [520]"), "'parameters.fx'"},
      {native("\"fx\": 520", "\"fx\": true"), "'parameters.fx'"},
      {native("\"fx\": 520", "\"fx\": -520"), "positive"},
      {native("\"fx\": 520", "\"fx\": 0"), "positive"},
      {native("\"fy\": 518", "\"fy\": -1e-9"), "positive"},
      {native("\"cx\": 325", "\"cx\": 1e300"), "cx"},
      {native("\"fx\": 520, ", ""), "no 'fx'"},
      {native("\"k3\": 0", "\"k3\": 0, \"k4\": 0"), "k4"},
      {native("\"k3\": 0", "\"k3\": 0, \"k3\": 0"), "twice"},
      {native("\"k3\": 0", "\"k3\": 0,"), "line 4"},
      {native("\"brown5\"", "\"rational9\""), "rational9"},
      {native("\"brown5\"", "5"), "'model'"},
      {native("\"brown5\"", fmt::format("\"{}\"", std::string(100'000, 'x'))), "xxx"},
      {native("\"model\": \"brown5\",", ""), "'model' is missing"},
      {native("[640, 480]", "[640]"), "image_size"},
      {native("[640, 480]", "[640, 480, 3]"), "image_size"},
      {native("[640, 480]", "[0, 0]"), "image_size"},
      {native("[640, 480]", "[640.5, 480]"), "image_size"},
      {native("[640, 480]", "[-640, 480]"), "image_size"},
      {native("[640, 480]", "[1e9, 480]"), "image_size"},
      {native("[640, 480]", "\"640x480\""), "image_size"},
      {native("[640, 480]", "[null, 480]"), "image_size"},
      {native("\"version\": 1", "\"version\": 2"), "newer version"},
      {native("\"version\": 1", "\"version\": 0"), "version"},
      {native("\"version\": 1", "\"version\": \"1\""), "version"},
      {native("\"version\": 1,", ""), "'version' is missing"},
      {native("calvin-calibration", "calvin-observations"), "calvin-observations"},
      {native("\"cam0\"", "7"), "'camera'"},
      {native("\"device\": {}", "\"rms\": null"), "'rms'"},
      {native("\"device\": {}", "\"sigma\": {\"fx\": -1}"), "'sigma.fx'"},
      {native("\"device\": {}", "\"sigma\": [1]"), "'sigma'"},
      {native("\"device\": {}", "\"covariance\": [[1]]"), "'covariance'"},
      {native("\"device\": {}", "\"sigma\": {\"fx\": 1}, \"covariance\": [[1, 2]]"),
       "'covariance'"},
      {native("\"device\": {}", "\"sigma\": {\"fx\": 1}, \"covariance\": [[null]]"),
       "'covariance'"},
      {native("\"device\": {}", "\"sigma\": {\"fx\": 1}, \"covariance\": [[-1]]"),
       "'covariance' has a negative variance in row 1"},
      {native("\"device\": {}",
              "\"sigma\": {\"fx\": 1, \"fy\": 1}, \"covariance\": [[1, 0.5], [0.4, 1]]"),
       "'covariance' is no covariance: 0.4 in row 2, column 1"},
      {native("\"device\": {}",
              "\"sigma\": {\"fx\": 1, \"fy\": 1}, \"covariance\": [[1, 3], [3, 4]]"),
       "'covariance' is no covariance: 3 in row 2, column 1"},
      {native("\"device\": {}", "\"covered\": [[1, 2, 3]]"), "'covered'"},
      {native("\"device\": {}", "\"covered\": 5"), "'covered'"},
      {native("\"device\": {}", "\"views\": [5]"), "'views'"},
      {native("\"device\": {}", "\"views\": [{\"rms\": \"0\"}]"), "'views[0].rms'"},
      {native("\"device\": {}", "\"views\": [{\"timestamp\": -1}]"), "'views[0].timestamp'"},
      {native("\"device\": {}", "\"views\": [{\"held_out\": 1}]"), "'views[0].held_out'"},
      {native("\"device\": {}", "\"views\": [{\"camera_from_board\": {\"rotation\": [0, 0]}}]"),
       "'views[0].camera_from_board.rotation'"},
      {native("\"device\": {}", "\"warp\": {\"kx\": 1}"), "'warp.ky' is missing"},
      {native("\"device\": {}", "\"device\": 5"), "'device'"},
      {native("\"device\": {}", "\"device\": {\"name\": 5}"), "'device.name'"},
      {native("\"device\": {}", "\"device\": {\"autofocus\": 1}"), "'device.autofocus'"},
      {native("\"device\": {}", "\"sensor_crop\": [0, 0, 0, 480]"), "'sensor_crop'"},
      {native("\"device\": {}", "\"sensor_crop\": [0, 0, 641, 480]"), "'sensor_crop'"},
      {native("\"device\": {}", "\"sensor_crop\": [0, 1, 640, 480]"), "'sensor_crop'"},
  };
  for (const Bad& bad : table) expect_refused(bad);
}

// 100,000 of them once took 20 s, and four times as long each time that they were twice as many.
TEST(BadContent, NamesWithoutEndAreRefusedBeforeTheyAreLookedUp) {
  std::string names;
  for (int i = 0; names.size() < kMaxCalibrationBytes - 1000; ++i) {
    names += fmt::format("\"a{}\": 1, ", i);
  }
  expect_refused(
      {native("\"fx\": 520", names + "\"fx\": 520"), "no camera model has more than 64"});
}

TEST(BadContent, TooLarge) {
  const std::string space(kMaxCalibrationBytes - std::string(test::kNativeFile).size(), ' ');
  EXPECT_TRUE(parse_calibration(test::kNativeFile + space));
  expect_refused({test::kNativeFile + space + " ", "16 MiB"});
}

TEST(BadContent, OtherFormats) {
  if (!CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built without formats";
  const char* ros = test::kRosFile;
  const char* yaml = test::kOpenCvYamlFile;
  const char* xml = test::kOpenCvXmlFile;
  const char* json = test::kOpenCvJsonFile;
  const std::vector<Bad> table = {
      {in(ros, "[520,", "[.nan,"), "'camera_matrix.data' is not a finite number"},
      {in(ros, "[520,", "[nan,"), "'camera_matrix.data'"},
      {in(ros, "[520,", "[.inf,"), "'camera_matrix.data'"},
      {in(ros, "[520,", "[-520,"), "positive"},
      {in(ros, "[520,", "[520,5,"), "'camera_matrix.data'"},
      {in(ros, "[520, 0,", "[520, 0, 0,"), "'camera_matrix.data'"},
      {in(ros, "0, 0, 1]", "0, 0, 2]"), "camera matrix"},
      {in(ros, "rows: 3", "rows: 2"), "'camera_matrix.data'"},
      {in(ros, "rows: 3", "rows: -3"), "'camera_matrix.data'"},
      {in(ros, "rows: 3", "rows: many"), "'camera_matrix.rows'"},
      {in(ros, "plumb_bob", "kannala_x"), "kannala_x"},
      {in(ros, "plumb_bob", "equidistant"), "'distortion_coefficients' are 5"},
      {in(ros, "plumb_bob", "[1]"), "distortion_model"},
      {in(ros, "image_width: 640\n", ""), "'image_width' is missing"},
      {in(ros, "640", "-640"), "not positive"},
      {in(ros, "640", "640.5"), "'image_width'"},
      {in(ros, "640", "70000"), "65536"},
      {in(ros, "camera_matrix:", "camera:"), "'camera_matrix' is missing"},
      {in(ros, "  cols: 5\n", "  cols: 5\n  cols: 5\n"), "twice"},
      {in(ros, "-0.28, 0.09", "-0.28 0.09"), "'distortion_coefficients.data'"},
      {in(yaml, "520.", ".Nan"), "'camera_matrix.data'"},
      {in(yaml, "520.", "-.Inf"), "'camera_matrix.data'"},
      {in(yaml, "520.", "520,"), ""},
      {in(yaml, "dt: d", "dt: \"2d\""), "'camera_matrix.dt'"},
      {in(yaml, "rows: 5", "rows: 6"), "'distortion_coefficients.data'"},
      {in(yaml, "image_width: 640", "image_width: 0"), "image_width"},
      {in(yaml, "flags: 0", "fisheye_model: 1"), "fisheye"},
      {in(yaml, "flags: 0", "fisheye_model: 7"), "fisheye_model"},
      {in(yaml, "0.097", ".Nan"), "'avg_reprojection_error'"},
      {in(yaml, "distortion_coefficients", "distortions"), "'distortion_coefficients' is missing"},
      {in(yaml, "[ 520.", "\"$base64$AAAA\" #"), "base64"},
      {in(xml, "520.", "NaN"), "'cameraMatrix.data'"},
      {in(xml, "520.", "0x10"), "'cameraMatrix.data'"},
      {in(xml, "520.", "&fx;"), "'cameraMatrix.data'"},
      {in(xml, "520. 0.", "520."), "'cameraMatrix.data'"},
      {in(xml, "<rows>1</rows>", ""), "'distCoeffs.rows' is missing"},
      {in(xml, "</cameraMatrix>", ""), "broken"},
      {in(json, "520.0", "null"), "'cameraMatrix.data'"},
      {in(json, "[ 640, 480 ]", "[ 640 ]"), "cameraResolution"},
      {in(json, "\"cols\": 5", "\"cols\": 1e30"), "'dist_coeffs.cols'"},
      {in(json, "\"cols\": 5", "\"cols\": 0"), "'dist_coeffs.data'"},
      {in(json, "0.0005, -0.0007, 0.0 ]", "0.0005 ]"), "'dist_coeffs.data'"},
  };
  for (const Bad& bad : table) expect_refused(bad);
}

// Models that are not there yet are named, as soon as a coefficient says that they are meant.
TEST(BadContent, EightCoefficientsAreTheRationalModel) {
  const auto calibration =
      parse_calibration(in(in(test::kOpenCvJsonFile, "\"cols\": 5", "\"cols\": 8").c_str(),
                           "-0.0007, 0.0 ]", "-0.0007, 0.0, 0.1, 0, 0 ]"));
  ASSERT_TRUE(calibration) << calibration.error().message;
  EXPECT_EQ(calibration->model, "rational8");
  EXPECT_EQ(calibration->find("k4")->value, 0.1);
}

TEST(BadContent, BuildWithoutFormats) {
  if (CALVIN_HAVE_FORMATS) GTEST_SKIP() << "built with formats";
  for (const char* file : {test::kRosFile, test::kOpenCvYamlFile, test::kOpenCvXmlFile}) {
    const auto calibration = parse_calibration(file);
    ASSERT_FALSE(calibration);
    EXPECT_EQ(calibration.error().code, ErrorCode::kUnsupported);
    const std::string& said = calibration.error().message;
    EXPECT_NE(said.find("-Dformats=enabled"), std::string::npos) << said;
    EXPECT_EQ(said.find("OpenCV's YAML"), std::string::npos) << said;
  }
}

// Cut off anywhere: an error, or the whole camera where what is missing says nothing of it.
TEST(BadContent, Truncated) {
  for (const std::string& file : test::sample_files()) {
    for (std::size_t length = 0; length < file.size(); ++length) {
      const auto result = parse_calibration(std::string_view(file).substr(0, length));
      expect_sound(result, file.substr(0, length));
      if (result) {
        EXPECT_EQ(result->find("k2")->value, 0.09) << file.substr(0, length);
        EXPECT_EQ(result->find("p2")->value, -0.0007) << file.substr(0, length);
      }
    }
  }
}

TEST(BadContent, FlippedBitsAndBytes) {
  std::mt19937 random(7);
  const int count = std::getenv("CALVIN_FULL") != nullptr ? 20000 : 1500;
  for (const std::string& file : test::sample_files()) {
    for (int i = 0; i < count; ++i) {
      std::string text = file;
      for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
        char& c = text[random() % text.size()];
        c = random() % 2 != 0 ? static_cast<char>(c ^ (1 << random() % 8))
                              : "-.:,[]{}<>\"&*!%#\n \te0"[random() % 22];
      }
      expect_sound(parse_calibration(text), text);
    }
  }
}

}  // namespace
}  // namespace calvin
