// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// OpenCV's FileStorage, printed as YAML 1.0, XML or JSON. Reading is the same for all three and
// lives in opencv_storage.cpp.

#include <fmt/format.h>

#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_storage.hpp"

namespace calvin::io {

namespace {

// All that tells the three apart; formats of fmt.
struct Syntax {
  std::string_view head;
  std::string_view number;  // name, value
  std::string_view matrix;  // name, rows, cols, data
  std::string_view comma;   // between the numbers of a matrix
  std::string_view next;    // between fields
  std::string_view tail;
};

constexpr Syntax kYaml = {
    "%YAML:1.0\n---\n",
    "{}: {}",
    "{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]",
    ", ",
    "\n",
    "\n"};

constexpr Syntax kXml = {
    "<?xml version=\"1.0\"?>\n<opencv_storage>\n",
    "<{0}>{1}</{0}>",
    "<{0} type_id=\"opencv-matrix\">\n  <rows>{1}</rows>\n  <cols>{2}</cols>\n  <dt>d</dt>\n"
    "  <data>\n    {3}</data></{0}>",
    " ",
    "\n",
    "\n</opencv_storage>\n"};

constexpr Syntax kJson = {
    "{\n",
    "    \"{}\": {}",
    "    \"{}\": {{\n        \"type_id\": \"opencv-matrix\",\n        \"rows\": {},\n"
    "        \"cols\": {},\n        \"dt\": \"d\",\n        \"data\": [ {} ]\n    }}",
    ", ",
    ",\n",
    "\n}\n"};

std::string print_field(const Syntax& syntax, std::string_view name, const StorageValue& value) {
  const auto number = fmt::runtime(syntax.number);
  if (const int* whole = std::get_if<int>(&value)) return fmt::format(number, name, *whole);
  if (const double* real = std::get_if<double>(&value)) {
    return fmt::format(number, name, format_real(*real));
  }
  const Matrix& matrix = std::get<Matrix>(value);
  return fmt::format(fmt::runtime(syntax.matrix), name, matrix.rows, matrix.cols,
                     join_reals(matrix.data, syntax.comma));
}

std::string print_storage(const Syntax& syntax, const Storage& storage) {
  std::string text(syntax.head);
  for (const auto& [name, value] : storage) {
    if (text.size() > syntax.head.size()) text += syntax.next;
    text += print_field(syntax, name, value);
  }
  return text.append(syntax.tail);
}

Result<std::string> print_opencv(const Syntax& syntax, const Calibration& calibration) {
  const auto storage = to_storage(calibration);
  if (!storage) return tl::unexpected(storage.error());
  return print_storage(syntax, *storage);
}

}  // namespace

bool opencv_holds(std::string_view model) { return opencv_lens(model) != nullptr; }

std::string print_opencv_yaml(const Storage& storage) { return print_storage(kYaml, storage); }

Result<std::string> print_opencv_yaml(const Calibration& calibration) {
  return print_opencv(kYaml, calibration);
}

Result<std::string> print_opencv_xml(const Calibration& calibration) {
  return print_opencv(kXml, calibration);
}

Result<std::string> print_opencv_json(const Calibration& calibration) {
  return print_opencv(kJson, calibration);
}

}  // namespace calvin::io
