// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What an OpenCV calibration file holds, whatever its syntax.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/io/document.hpp"

namespace calvin::io {

struct Matrix {
  int rows = 0;
  int cols = 0;
  std::vector<double> data;  // row-major
};

using StorageValue = std::variant<int, double, Matrix>;
using Storage = std::vector<std::pair<std::string_view, StorageValue>>;

// What the root of a file of any syntax holds: XML has an element around everything.
[[nodiscard]] const Node& content_of(const Node& root) noexcept;

// The fields to write, under the names of OpenCV's own calibration sample.
[[nodiscard]] Result<Storage> to_storage(const Calibration& calibration);

// As a file in YAML.
[[nodiscard]] std::string print_opencv_yaml(const Storage& storage);

// A number that OpenCV and a JSON parser take for a real one: "520.0".
[[nodiscard]] std::string format_real(double value);
[[nodiscard]] std::string join_reals(const std::vector<double>& values, std::string_view separator);

// The names that a field goes by, as plain_key() gives them: without case, underscores, hyphens and
// blanks, which vary most.
using KeyNames = std::vector<std::string_view>;
[[nodiscard]] std::string plain_key(std::string_view key);
[[nodiscard]] bool is_one_of(std::string_view key, const KeyNames& names);

// A matrix field: rows, cols and data, as many as those say, or a list of rows, or a plain list of
// numbers, which is one column. Only finite numbers; none is an empty matrix.
[[nodiscard]] Matrix read_matrix(Fields& fields, std::string_view key);

// One of nine numbers, row-major.
[[nodiscard]] std::array<double, 9> read_3x3(Fields& fields, std::string_view key);

}  // namespace calvin::io
