// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Finds the matrices of a calibration in OpenCV's files under the keys that its programs and their
// descendants write.

#include "calvin/io/opencv_storage.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/io/calibration_formats.hpp"
#include "calvin/io/opencv_camera.hpp"
#include "calvin/io/opencv_lens.hpp"

namespace calvin::io {

namespace {

// There is no schema: these are the names that OpenCV's samples and tools, and the files found in
// the wild, use.
using Names = KeyNames;
const Names kCameraMatrix = {"cameramatrix", "intrinsicmatrix", "k", "m1", "cameramatrix1", "mtx"};
const Names kDistortion = {"distortioncoefficients",
                           "distcoeffs",
                           "distortioncoeffs",
                           "distortion",
                           "d",
                           "d1",
                           "distcoeffs1",
                           "dist"};
const Names kWidth = {"imagewidth", "imgwidth", "width"};
const Names kHeight = {"imageheight", "imgheight", "height"};
const Names kSize = {"cameraresolution", "imagesize", "resolution"};
const Names kRms = {"avgreprojectionerror"};
const Names kMatrixSigma = {"cameramatrixstddev"};
const Names kDistortionSigma = {"distcoeffsstddev"};

// The key of the file that is one of `names`; empty where there is none.
std::string find_key(const Node& map, const Names& names) {
  for (const std::string_view name : names) {
    for (const std::string& key : map.keys) {
      if (plain_key(key) == name) return key;
    }
  }
  return {};
}

ImageSize read_size(Fields& fields, const Node& map) {
  const std::string width = find_key(map, kWidth);
  const std::string height = find_key(map, kHeight);
  ImageSize size;
  if (!width.empty() && !height.empty()) {
    size = {fields.integer(width), fields.integer(height)};
  } else if (const std::string key = find_key(map, kSize); !key.empty()) {
    const auto both = fields.numbers(key);
    const auto whole = [](double v) { return v >= 1 && v <= 65536 && v == std::floor(v); };
    if (both.size() != 2 || !whole(both[0]) || !whole(both[1])) {
      fields.complain(key, "is not a width and a height in whole pixels");
      return {};
    }
    return {static_cast<int>(both[0]), static_cast<int>(both[1])};
  } else {
    return {};
  }
  if (size.width < 1) fields.complain(width, "is not a width in pixels");
  if (size.height < 1) fields.complain(height, "is not a height in pixels");
  return size;
}

// OpenCV writes 0 for what it did not estimate.
void read_sigmas(Fields& fields, const Node& map, bool fisheye, Calibration& calibration) {
  const auto take = [&](const Names& names, const std::vector<std::string_view>& parameters) {
    const std::string key = find_key(map, names);
    if (key.empty()) return;
    const Matrix sigmas = read_matrix(fields, key);
    for (Parameter& p : calibration.parameters) {
      const auto it = std::find(parameters.begin(), parameters.end(), p.name);
      const auto i = static_cast<std::size_t>(it - parameters.begin());
      if (it != parameters.end() && i < sigmas.data.size() && sigmas.data[i] > 0) {
        p.sigma = sigmas.data[i];
      }
    }
  };
  take(kMatrixSigma, {"fx", "fy", "cx", "cy"});
  take(kDistortionSigma, coefficient_names(fisheye, 14));
}

Matrix sigma_matrix(const Calibration& calibration, const std::vector<std::string_view>& names) {
  Matrix matrix{static_cast<int>(names.size()), 1, {}};
  for (const std::string_view name : names) {
    const Parameter* p = calibration.find(name);
    matrix.data.push_back(p == nullptr ? 0 : p->sigma.value_or(0));
  }
  return matrix;
}

// No numbers, and said so: a camera without distortion.
bool is_empty_matrix(const Fields& matrix) {
  const Node* data = matrix.find("data");
  const auto is_zero = [&](std::string_view key) {
    const Node* count = matrix.find(key);
    return count != nullptr && count->text == "0";
  };
  return (is_zero("rows") || is_zero("cols")) &&
         (data == nullptr || (data->items.empty() && data->text.empty()));
}

bool is_group_of_matrix(const Node& node) {
  constexpr std::array<std::string_view, 3> kKeys = {"rows", "cols", "data"};
  return std::any_of(kKeys.begin(), kKeys.end(),
                     [&](std::string_view key) { return node.find(key) != nullptr; });
}

// A list of rows, as scripts write an array of NumPy; a plain list of numbers is one column.
Matrix read_rows(Fields& fields, std::string_view key) {
  const auto rows = fields.rows(key, 0);
  Matrix matrix;
  for (const auto& row : rows) {
    if (row.size() != rows.front().size()) {
      fields.complain(
          key, fmt::format("has rows of {} and of {} numbers", rows.front().size(), row.size()));
      return {};
    }
    matrix.data.insert(matrix.data.end(), row.begin(), row.end());
  }
  if (matrix.data.empty()) return {};
  matrix.rows = static_cast<int>(rows.size());
  matrix.cols = static_cast<int>(rows.front().size());
  return matrix;
}

}  // namespace

std::string plain_key(std::string_view key) {
  std::string name;
  for (const char c : key) {
    if (c == '_' || c == '-' || c == ' ') continue;
    name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return name;
}

bool is_one_of(std::string_view key, const KeyNames& names) {
  return std::find(names.begin(), names.end(), plain_key(key)) != names.end();
}

Matrix read_matrix(Fields& fields, std::string_view key) {
  const Node* node = fields.find(key);
  if (node != nullptr && node->kind == Node::Kind::kList) return read_rows(fields, key);
  if (node != nullptr && !is_group_of_matrix(*node)) {
    fields.complain(key,
                    "is no matrix: write its rows, as [[1, 2], [3, 4]], or rows, cols and data");
    return {};
  }
  Fields matrix = fields.map(key);
  if (is_empty_matrix(matrix)) return {};
  const std::string dt = matrix.word("dt");
  if (!dt.empty() && dt != "d" && dt != "f" && dt != "i") {
    matrix.complain("dt", fmt::format("is '{}'; d, f and i are read", dt.substr(0, 8)));
  }
  const Node* data = matrix.find("data");
  // XML breaks it into words.
  const Node* start = data != nullptr && !data->items.empty() ? &data->items.front() : data;
  if (start != nullptr && start->text.starts_with("$base64$")) {
    matrix.complain("data", "is in base64; write the file as plain text", ErrorCode::kUnsupported);
  }
  Matrix result{matrix.integer("rows"), matrix.integer("cols"), {}};
  if (matrix.failed()) return {};
  result.data = matrix.numbers("data");
  if (result.rows < 1 || result.cols < 1 || result.rows > 1'000'000 || result.cols > 1000 ||
      result.data.size() != static_cast<std::size_t>(result.rows) * result.cols) {
    matrix.complain("data", fmt::format("has {} numbers, but rows and cols are {} and {}",
                                        result.data.size(), result.rows, result.cols));
  }
  return result;
}

std::array<double, 9> read_3x3(Fields& fields, std::string_view key) {
  const Matrix matrix = read_matrix(fields, key);
  std::array<double, 9> values{};
  if (matrix.data.size() != values.size()) {
    fields.complain(key,
                    "is not a matrix of 3x3: nine numbers, by rows, or three rows of three each");
    return values;
  }
  std::copy(matrix.data.begin(), matrix.data.end(), values.begin());
  return values;
}

const Node& content_of(const Node& root) noexcept {
  const Node* storage = root.find("opencv_storage");
  return storage == nullptr ? root : *storage;
}

bool is_opencv(const Node& root) {
  return root.find("opencv_storage") != nullptr || !find_key(root, kCameraMatrix).empty();
}

Result<Calibration> read_opencv(const Node& root) {
  const Node& map = content_of(root);
  std::optional<Error> problem;
  Fields fields(map, "", problem);
  const std::string k_key = find_key(map, kCameraMatrix);
  const std::string d_key = find_key(map, kDistortion);
  if (k_key.empty() || d_key.empty()) {
    fields.complain(k_key.empty() ? "camera_matrix" : "distortion_coefficients", "is missing");
    return tl::unexpected(*problem);
  }
  OpenCvCamera camera;
  camera.k = read_3x3(fields, k_key);
  camera.distortion = read_matrix(fields, d_key).data;
  camera.fisheye = read_fisheye(fields);
  const ImageSize size = read_size(fields, map);
  if (problem) return tl::unexpected(*problem);
  auto calibration = from_opencv(camera, size);
  if (!calibration) return calibration;
  read_sigmas(fields, map, camera.fisheye, *calibration);
  if (const std::string key = find_key(map, kRms); !key.empty()) {
    calibration->rms = fields.optional_number(key);
  }
  if (problem) return tl::unexpected(*problem);
  return calibration;
}

Result<Storage> to_storage(const Calibration& calibration) {
  const auto camera = to_opencv(calibration);
  if (!camera) return tl::unexpected(camera.error());
  Storage storage;
  if (calibration.image_size.width > 0) {
    storage.emplace_back("image_width", calibration.image_size.width);
    storage.emplace_back("image_height", calibration.image_size.height);
  }
  if (camera->fisheye) storage.emplace_back("fisheye_model", 1);
  storage.emplace_back("camera_matrix", Matrix{3, 3, {camera->k.begin(), camera->k.end()}});
  const int count = static_cast<int>(camera->distortion.size());
  storage.emplace_back("distortion_coefficients", Matrix{count, 1, camera->distortion});
  if (std::any_of(calibration.parameters.begin(), calibration.parameters.end(),
                  [](const Parameter& p) { return p.sigma.value_or(0) > 0; })) {
    storage.emplace_back("cameraMatrix_std_dev",
                         sigma_matrix(calibration, {"fx", "fy", "cx", "cy"}));
    storage.emplace_back(
        "dist_coeffs_std_dev",
        sigma_matrix(calibration, coefficient_names(camera->fisheye, camera->distortion.size())));
  }
  if (calibration.rms) storage.emplace_back("avg_reprojection_error", *calibration.rms);
  return storage;
}

std::string format_real(double value) {
  std::string text = format_double(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string join_reals(const std::vector<double>& values, std::string_view separator) {
  std::string text;
  for (const double value : values) {
    if (!text.empty()) text += separator;
    text += format_real(value);
  }
  return text;
}

}  // namespace calvin::io
