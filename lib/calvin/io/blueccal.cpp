// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads rows of numbers and makes observations of their columns.

#include "calvin/io/blueccal.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/core/utf8.hpp"
#include "calvin/io/file_text.hpp"

namespace calvin {

namespace {

constexpr const char* kPointsFile = "points.dat";
constexpr const char* kVisibleFile = "IdMat.dat";
constexpr const char* kSizesFile = "Res.dat";
constexpr const char* kNamesFile = "camera_order.txt";
constexpr std::size_t kRows = 3;  // of a camera: u, v and 1
constexpr std::size_t kMostCameras = 4096;
constexpr std::uint64_t kFrame = 1'000'000'000;  // ns

using Rows = std::vector<std::vector<double>>;

tl::unexpected<Error> malformed(std::string_view name, std::string_view file,
                                const std::string& why) {
  return make_error(ErrorCode::kMalformed,
                    fmt::format("'{}' cannot be used as what BlueCCal writes: {} {}.",
                                shortened(name, 400), file, why));
}

// NaN for what is no number, as for what was not seen.
Result<Rows> rows_of(std::string_view text, std::string_view name, std::string_view file) {
  Rows rows;
  for (const std::string_view line : io::lines_of(text)) {
    std::vector<double> row;
    for (const std::string_view word : words_of(line)) {
      const auto number = parse_double(word);
      if (!number && word != "NaN" && word != "nan") {
        return malformed(name, file,
                         fmt::format("has '{}', which is no number", shortened(word, 40)));
      }
      row.push_back(number.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    if (row.empty()) continue;
    if (!rows.empty() && row.size() != rows.front().size()) {
      return malformed(name, file,
                       fmt::format("has {} columns in its row {}, and {} in the first", row.size(),
                                   rows.size() + 1, rows.front().size()));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

struct Tables {
  Rows points;
  Rows visible;
  Rows sizes;
  std::vector<std::string> names;

  [[nodiscard]] std::size_t cameras() const { return sizes.size(); }
  [[nodiscard]] std::size_t frames() const { return points.front().size(); }
  [[nodiscard]] bool is_seen(std::size_t camera, std::size_t frame) const {
    return (visible.empty() || visible[camera][frame] > 0) &&
           std::isfinite(points[kRows * camera][frame]) &&
           std::isfinite(points[kRows * camera + 1][frame]);
  }
};

Status check(const Tables& tables, std::string_view name) {
  if (tables.sizes.empty() || tables.sizes.size() > kMostCameras ||
      tables.sizes.front().size() != 2) {
    return malformed(name, kSizesFile,
                     "is not the width and the height of each camera, a row for each");
  }
  for (const auto& size : tables.sizes) {
    for (const double side : size) {
      if (side >= 1 && side <= 65536 && side == std::floor(side)) continue;
      return malformed(name, kSizesFile, "has a size that is not 1 to 65536 whole pixels");
    }
  }
  if (tables.points.size() != kRows * tables.cameras()) {
    return malformed(name, kPointsFile,
                     fmt::format("has {} rows, where {} cameras have three each: u, v and 1",
                                 tables.points.size(), tables.cameras()));
  }
  if (!tables.visible.empty() && (tables.visible.size() != tables.cameras() ||
                                  tables.visible.front().size() != tables.frames())) {
    return malformed(
        name, kVisibleFile,
        fmt::format("has not a row for each of {} cameras with a column for each of {} "
                    "frames",
                    tables.cameras(), tables.frames()));
  }
  if (!tables.names.empty() && tables.names.size() != tables.cameras()) {
    return malformed(
        name, kNamesFile,
        fmt::format("has {} names of {} cameras", tables.names.size(), tables.cameras()));
  }
  return {};
}

std::vector<ObservationFile> observations_of(const Tables& tables) {
  constexpr const char* kBoard = "dot";
  std::vector<ObservationFile> files;
  for (std::size_t c = 0; c < tables.cameras(); ++c) {
    ObservationFile& file = files.emplace_back();
    file.board = kBoard;
    for (std::size_t frame = 0; frame < tables.frames(); ++frame) {
      if (!tables.is_seen(c, frame)) continue;
      Observation seen;
      seen.camera = tables.names.empty() ? fmt::format("cam{}", c) : tables.names[c];
      seen.board = kBoard;
      seen.timestamp = frame * kFrame;
      seen.image_size = {static_cast<int>(tables.sizes[c][0]),
                         static_cast<int>(tables.sizes[c][1])};
      seen.ids = {0};
      seen.uv = {{tables.points[kRows * c][frame], tables.points[kRows * c + 1][frame]}};
      seen.sigma = {1};
      file.observations.push_back(std::move(seen));
    }
  }
  return files;
}

// The content of a file that may be missing.
Result<std::string> read_if_there(const std::filesystem::path& path) {
  auto content = read_file(path.string());
  if (!content && content.error().code == ErrorCode::kNotFound) return std::string();
  return content;
}

// That of one that has to be there. Whoever gives a folder of other things learns what it takes.
Result<std::string> read_needed(const std::filesystem::path& folder, const char* file) {
  auto content = read_file((folder / file).string());
  std::error_code none;
  if (content || content.error().code != ErrorCode::kNotFound ||
      !std::filesystem::is_directory(folder, none)) {
    return content;
  }
  return make_error(
      ErrorCode::kNotFound,
      fmt::format("'{}' cannot be used as what BlueCCal writes: {} is missing in it. The folder "
                  "has to hold {} and {}, and may hold {} and {}.",
                  shortened(folder.string(), 400), file, kPointsFile, kSizesFile, kVisibleFile,
                  kNamesFile));
}

}  // namespace

Result<std::vector<ObservationFile>> parse_blueccal(const BlueCcalText& text,
                                                    std::string_view name) {
  Tables tables;
  const std::pair<Rows Tables::*, std::pair<std::string_view, const char*>> files[] = {
      {&Tables::points, {text.points, kPointsFile}},
      {&Tables::visible, {text.visible, kVisibleFile}},
      {&Tables::sizes, {text.sizes, kSizesFile}}};
  for (const auto& [rows, file] : files) {
    auto read = rows_of(file.first, name, file.second);
    if (!read) return tl::unexpected(read.error());
    tables.*rows = *std::move(read);
  }
  for (const std::string_view line : io::lines_of(text.names)) {
    if (!trim(line).empty()) tables.names.emplace_back(trim(line));
  }
  if (const Status fits = check(tables, name); !fits) return tl::unexpected(fits.error());
  return observations_of(tables);
}

Result<std::vector<ObservationFile>> read_blueccal(const std::filesystem::path& folder) {
  const auto points = read_needed(folder, kPointsFile);
  if (!points) return tl::unexpected(points.error());
  const auto sizes = read_needed(folder, kSizesFile);
  if (!sizes) return tl::unexpected(sizes.error());
  const auto visible = read_if_there(folder / kVisibleFile);
  if (!visible) return tl::unexpected(visible.error());
  const auto names = read_if_there(folder / kNamesFile);
  if (!names) return tl::unexpected(names.error());
  return parse_blueccal({*points, *visible, *sizes, *names}, folder.string());
}

}  // namespace calvin
