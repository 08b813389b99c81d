// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is written, to the letter: every format with every lens that it holds, no two numbers alike,
// against the order that OpenCV's and ROS's own documentation gives.
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_io.hpp"
#include "io_samples.hpp"

namespace calvin {
namespace {

using Words = std::vector<std::string>;

const Words kPinhole = {"fx", "fy", "cx", "cy"};

// The coefficients of a lens in the order of OpenCV's documentation of cv::projectPoints().
const std::map<std::string, Words> kOpenCvOrder = {
    {"pinhole", {}},
    {"brown4", {"k1", "k2", "p1", "p2"}},
    {"brown5", {"k1", "k2", "p1", "p2", "k3"}},
    {"rational8", {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}},
    {"thinprism12", {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"}},
    {"tilted14",
     {"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "taux", "tauy"}},
    {"fisheye", {"k1", "k2", "k3", "k4"}},
};

// The distortion_model of sensor_msgs/CameraInfo and its number of coefficients.
const std::map<std::string, std::pair<std::string, std::size_t>> kRos = {
    {"pinhole", {"plumb_bob", 5}},   {"brown4", {"plumb_bob", 5}},
    {"brown5", {"plumb_bob", 5}},    {"rational8", {"rational_polynomial", 8}},
    {"fisheye", {"equidistant", 4}},
};

// The texts of all values and sigmas, each once.
const std::map<std::string, std::string> kValues = {
    {"fx", "501.5"}, {"fy", "502.25"},  {"cx", "303.5"},   {"cy", "204.75"}, {"k1", "0.011"},
    {"k2", "0.012"}, {"p1", "0.013"},   {"p2", "0.014"},   {"k3", "0.015"},  {"k4", "0.016"},
    {"k5", "0.017"}, {"k6", "0.018"},   {"s1", "0.019"},   {"s2", "0.021"},  {"s3", "0.022"},
    {"s4", "0.023"}, {"taux", "0.024"}, {"tauy", "0.025"}, {"skew", "0.75"}};

// Those of the lenses that only the native format has come after them.
std::size_t place_of(const std::string& name) {
  std::set<std::string> others;
  for (const std::string_view model : model_names()) {
    for (const std::string_view other : parameter_names(model)) others.emplace(other);
  }
  for (const auto& [known, value] : kValues) others.erase(known);
  const auto it = kValues.find(name);
  const auto place = it != kValues.end() ? std::distance(kValues.begin(), it)
                                         : std::distance(others.begin(), others.find(name)) +
                                               static_cast<std::ptrdiff_t>(kValues.size());
  return static_cast<std::size_t>(place);
}

std::string value_of(const std::string& name) {
  const auto it = kValues.find(name);
  return it != kValues.end() ? it->second : fmt::format("0.5{}1", place_of(name));
}

std::string sigma_of(const std::string& name) { return fmt::format("{}.125", place_of(name) + 1); }

Words parameters_of(const std::string& model) {
  Words names = kPinhole;
  if (const auto it = kOpenCvOrder.find(model); it != kOpenCvOrder.end()) {
    names.insert(names.end(), it->second.begin(), it->second.end());
  } else {
    const auto known = parameter_names(model);
    names.assign(known.begin(), known.end());
  }
  names.emplace_back("skew");
  return names;
}

// Entry (row, column) of the covariance; rows in another order do not look like it.
int entry(std::size_t row, std::size_t column) {
  return static_cast<int>(100 * std::min(row, column) + std::max(row, column) + 1);
}

Calibration calibration_of(const std::string& model) {
  Calibration c;
  c.camera = "left";
  c.image_size = {1003, 702};
  c.model = model;
  const Words names = parameters_of(model);
  for (const std::string& name : names) {
    c.parameters.push_back({name, std::stod(value_of(name)), std::stod(sigma_of(name))});
  }
  // One that was not estimated has no sigma and no row.
  c.parameters[2].sigma.reset();
  for (std::size_t row = 0; row + 1 < names.size(); ++row) {
    for (std::size_t column = 0; column + 1 < names.size(); ++column) {
      c.covariance.push_back(entry(row, column));
    }
  }
  c.rms = 0.625;
  return c;
}

Words values_of(const Words& names) {
  Words values;
  for (const std::string& name : names) values.push_back(value_of(name));
  return values;
}

Words matrix_of_camera() {
  return {"501.5", "0.75", "303.5", "0.0", "502.25", "204.75", "0.0", "0.0", "1.0"};
}

// The fields of an OpenCV file of the lens, in their order: a number, or rows, columns and numbers.
struct Field {
  std::string name;
  std::size_t rows = 0;
  std::size_t cols = 0;
  Words numbers;
};

std::vector<Field> opencv_fields(const std::string& model) {
  const Words& lens = kOpenCvOrder.at(model);
  const std::size_t count = std::max<std::size_t>(lens.size(), 4);
  Words d = values_of(lens);
  d.resize(count, "0.0");
  Words sigmas;
  for (const std::string& name : lens) sigmas.push_back(sigma_of(name));
  sigmas.resize(count, "0.0");
  std::vector<Field> fields = {{"image_width", 0, 0, {"1003"}}, {"image_height", 0, 0, {"702"}}};
  if (model == "fisheye") fields.push_back({"fisheye_model", 0, 0, {"1"}});
  fields.push_back({"camera_matrix", 3, 3, matrix_of_camera()});
  fields.push_back({"distortion_coefficients", count, 1, d});
  fields.push_back(
      {"cameraMatrix_std_dev", 4, 1, {sigma_of("fx"), sigma_of("fy"), "0.0", sigma_of("cy")}});
  fields.push_back({"dist_coeffs_std_dev", count, 1, sigmas});
  fields.push_back({"avg_reprojection_error", 0, 0, {"0.625"}});
  return fields;
}

std::string yaml_of(const std::vector<Field>& fields) {
  std::string text = "%YAML:1.0\n---\n";
  for (const Field& f : fields) {
    if (f.rows == 0) {
      text += fmt::format("{}: {}\n", f.name, f.numbers[0]);
    } else {
      text += fmt::format(
          "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n"
          "   data: [ {} ]\n",
          f.name, f.rows, f.cols, join(f.numbers, ", "));
    }
  }
  return text;
}

std::string xml_of(const std::vector<Field>& fields) {
  std::string text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
  for (const Field& f : fields) {
    if (f.rows == 0) {
      text += fmt::format("<{0}>{1}</{0}>\n", f.name, f.numbers[0]);
    } else {
      text += fmt::format(
          "<{0} type_id=\"opencv-matrix\">\n  <rows>{1}</rows>\n"
          "  <cols>{2}</cols>\n  <dt>d</dt>\n  <data>\n    {3}</data></{0}>\n",
          f.name, f.rows, f.cols, join(f.numbers, " "));
    }
  }
  return text + "</opencv_storage>\n";
}

std::string json_of(const std::vector<Field>& fields) {
  Words items;
  for (const Field& f : fields) {
    if (f.rows == 0) {
      items.push_back(fmt::format("    \"{}\": {}", f.name, f.numbers[0]));
    } else {
      items.push_back(fmt::format(
          "    \"{}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {},\n"
          "        \"cols\": {},\n        \"dt\": \"d\",\n        \"data\": [ {} ]\n    }}",
          f.name, f.rows, f.cols, join(f.numbers, ", ")));
    }
  }
  return fmt::format("{{\n{}\n}}\n", join(items, ",\n"));
}

std::string ros_of(const std::string& model) {
  const auto& [name, count] = kRos.at(model);
  Words d = values_of(kOpenCvOrder.at(model));
  d.resize(count, "0.0");
  std::string text =
      "image_width: 1003\nimage_height: 702\ncamera_name: \"left\"\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [";
  text += fmt::format("{}]\ndistortion_model: {}\n", join(matrix_of_camera(), ", "), name);
  text += fmt::format("distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: [{}]\n", count,
                      join(d, ", "));
  return text +
         "rectification_matrix:\n  rows: 3\n  cols: 3\n"
         "  data: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
         "projection_matrix:\n  rows: 3\n  cols: 4\n"
         "  data: [501.5, 0.75, 303.5, 0.0, 0.0, 502.25, 204.75, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
}

std::string native_of(const std::string& model) {
  Words parameters;
  Words sigmas;
  for (const std::string& name : parameters_of(model)) {
    parameters.push_back(fmt::format("\"{}\": {}", name, value_of(name)));
    if (name != "cx") sigmas.push_back(fmt::format("\"{}\": {}", name, sigma_of(name)));
  }
  Words rows;
  for (std::size_t row = 0; row < sigmas.size(); ++row) {
    Words numbers;
    for (std::size_t i = 0; i < sigmas.size(); ++i)
      numbers.push_back(std::to_string(entry(row, i)));
    rows.push_back(fmt::format("    [{}]", join(numbers, ", ")));
  }
  return fmt::format(R"({{
  "format": "calvin-calibration",
  "version": 1,
  "camera": "left",
  "image_size": [1003, 702],
  "model": "{}",
  "parameters": {{{}}},
  "sigma": {{{}}},
  "covariance": [
{}
  ],
  "rms": 0.625
}}
)",
                     model, join(parameters, ", "), join(sigmas, ", "), join(rows, ",\n"));
}

// What `format` should hold; empty where it cannot.
std::string expected(std::string_view format, const std::string& model) {
  if (format == "calvin") return native_of(model);
  if (format == "ros") return kRos.contains(model) ? ros_of(model) : "";
  if (!kOpenCvOrder.contains(model)) return "";
  const auto fields = opencv_fields(model);
  return format == "opencv-yaml"  ? yaml_of(fields)
         : format == "opencv-xml" ? xml_of(fields)
                                  : json_of(fields);
}

TEST(FileContents, EveryFormatWithEveryLens) {
  int written = 0;
  for (const std::string_view format : test::formats_with_skew()) {
    for (const std::string_view name : model_names()) {
      const std::string model(name);
      SCOPED_TRACE(fmt::format("{} {}", format, model));
      const std::string want = expected(format, model);
      const auto text = print_calibration(calibration_of(model), format);
      EXPECT_EQ(can_hold(format, model).has_value(), !want.empty());
      ASSERT_EQ(text.has_value(), !want.empty());
      if (!text) continue;
      EXPECT_EQ(*text, want);
      ++written;
    }
  }
  EXPECT_EQ(written, static_cast<int>(model_names().size()) + 3 * 7 + 5);
}

// Coefficients make a lens of so many, be they 0: a pinhole is written with four, and ROS's
// plumb_bob has five.
std::string model_read(std::string_view format, const std::string& model) {
  if (format == "calvin" || (model != "pinhole" && model != "brown4")) return model;
  return format == "ros" ? "brown5" : "brown4";
}

// What is read is what was written, each number where it belongs.
TEST(FileContents, IsReadAsItWasWritten) {
  for (const std::string_view format : test::formats_with_skew()) {
    if (!test::readable(format)) continue;
    for (const std::string_view name : model_names()) {
      const std::string model(name);
      SCOPED_TRACE(fmt::format("{} {}", format, model));
      const std::string text = expected(format, model);
      if (text.empty()) continue;
      const auto read = parse_calibration(text);
      ASSERT_TRUE(read) << read.error().message;
      const Calibration want = calibration_of(model);
      const bool native = format == "calvin";
      EXPECT_EQ(read->model, model_read(format, model));
      EXPECT_EQ(read->image_size, want.image_size);
      EXPECT_EQ(read->camera, format == "calvin" || format == "ros" ? "left" : "");
      EXPECT_EQ(read->rms, format == "ros" ? std::nullopt : want.rms);
      for (const Parameter& p : want.parameters) {
        ASSERT_NE(read->find(p.name), nullptr) << p.name;
        EXPECT_EQ(read->find(p.name)->value, p.value) << p.name;
        const bool held = native || (format != "ros" && p.name != "skew");
        EXPECT_EQ(read->find(p.name)->sigma, held ? p.sigma : std::nullopt) << p.name;
      }
      EXPECT_EQ(read->covariance, native ? want.covariance : std::vector<double>());
    }
  }
}

// Until there were two promises, the one in a file was that of the whole picture.
TEST(FileContents, AnOldFileHasOnePromiseForBothPlaces) {
  const auto old = parse_calibration(
      R"({"format": "calvin-calibration", "version": 1, "image_size": [641, 481],
          "model": "pinhole", "parameters": {"fx": 500, "fy": 500, "cx": 320, "cy": 240},
          "expected_error": 0.5})");
  ASSERT_TRUE(old) << old.error().message;
  EXPECT_EQ(old->expected_error, 0.5);
  EXPECT_EQ(old->expected_error_anywhere, 0.5);
  EXPECT_FALSE(old->worst_place || old->split_half_ratio);
  EXPECT_TRUE(old->misfit.empty() && old->remarks.empty());
}

// All that the native format has beside the lens.
TEST(FileContents, EveryFieldOfTheNativeFormat) {
  Calibration c = calibration_of("pinhole");
  c.parameters.resize(4);
  c.covariance.clear();
  c.held_out_rms = 0.75;
  c.chi = 1.25;
  c.expected_error = 0.375;
  c.expected_error_anywhere = 0.625;
  c.worst_place = Pixel{1.5, 2};
  c.split_half_ratio = 1.125;
  c.misfit = "none";
  c.remarks = {"One.", "Two."};
  c.covered = {{1.5, 2.5}, {3.5, 4.5}, {5.5, 6.5}};
  c.board = "checkerboard:9x6:30mm";
  c.warp = BoardWarp{0.0001, -0.0002, 0.0003, 0.0004};
  c.readout = -0.03125;
  c.readout_sigma = 0.0625;
  c.views = {{7, 0.5, 54, false, {{1.5, -2.5, 3.5}, {4.5, 5.5, 6.5}}},
             {kNoTimestamp, 0.875, 53, true, {{7.5, 8.5, 9.5}, {10.5, 11.5, 12.5}}}};
  c.sensor_crop = Rectangle{11, 12, 13.5, 14};
  c.device = CaptureDevice{"/dev/video2", "A camera", "usb-1", true};
  c.focus = 15;
  c.zoom = 16.5;
  c.created = "2026-11-21T10:00:00Z";
  EXPECT_EQ(print_calibration(c).value(),
            fmt::format(R"({{
  "format": "calvin-calibration",
  "version": 1,
  "camera": "left",
  "image_size": [1003, 702],
  "model": "pinhole",
  "parameters": {{"fx": 501.5, "fy": 502.25, "cx": 303.5, "cy": 204.75}},
  "sigma": {{"fx": {}, "fy": {}, "cy": {}}},
  "rms": 0.625,
  "held_out_rms": 0.75,
  "chi": 1.25,
  "expected_error": 0.375,
  "expected_error_anywhere": 0.625,
  "worst_place": [1.5, 2],
  "split_half_ratio": 1.125,
  "misfit": "none",
  "remarks": ["One.", "Two."],
  "covered": [
    [1.5, 2.5],
    [3.5, 4.5],
    [5.5, 6.5]
  ],
  "board": "checkerboard:9x6:30mm",
  "warp": {{"kx": 0.0001, "ky": -0.0002, "kx_sigma": 0.0003, "ky_sigma": 0.0004}},
  "readout": -0.03125,
  "readout_sigma": 0.0625,
  "views": [
    {{"timestamp": 7, "rms": 0.5, "points": 54, "held_out": false, "camera_from_board": {{"rotation": [1.5, -2.5, 3.5], "translation": [4.5, 5.5, 6.5]}}}},
    {{"rms": 0.875, "points": 53, "held_out": true, "camera_from_board": {{"rotation": [7.5, 8.5, 9.5], "translation": [10.5, 11.5, 12.5]}}}}
  ],
  "sensor_crop": [11, 12, 13.5, 14],
  "device": {{"node": "/dev/video2", "name": "A camera", "bus": "usb-1", "autofocus": true}},
  "focus": 15,
  "zoom": 16.5,
  "created": "2026-11-21T10:00:00Z"
}}
)",
                        sigma_of("fx"), sigma_of("fy"), sigma_of("cy")));
  const auto read = parse_calibration(print_calibration(c).value());
  ASSERT_TRUE(read);
  EXPECT_EQ(print_calibration(*read).value(), print_calibration(c).value());
  EXPECT_EQ(read->warp->kx, 0.0001);
  EXPECT_EQ(read->warp->kx_sigma, 0.0003);
  EXPECT_EQ(read->warp->ky_sigma, 0.0004);
  EXPECT_EQ(read->readout, -0.03125);
  EXPECT_EQ(read->readout_sigma, 0.0625);
  EXPECT_EQ(read->sensor_crop->x, 11);
  EXPECT_EQ(read->sensor_crop->y, 12);
  EXPECT_EQ(read->sensor_crop->height, 14);
  EXPECT_EQ(read->device.value().name, "A camera");
  EXPECT_EQ(read->device.value().autofocus, true);
  EXPECT_EQ(read->focus, 15);
  EXPECT_EQ(read->zoom, 16.5);
  // What a driver does not tell is absent, and a device of which nothing is known is none.
  c.device = CaptureDevice{"/dev/video2", "", "", std::nullopt};
  EXPECT_NE(print_calibration(c)->find("\"device\": {\"node\": \"/dev/video2\"},"),
            std::string::npos);
  EXPECT_FALSE(parse_calibration(print_calibration(c).value())->device->autofocus);
  c.device = CaptureDevice{};
  EXPECT_EQ(print_calibration(c)->find("device"), std::string::npos);
}

}  // namespace
}  // namespace calvin
