// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-rig, calvin-hand-eye and calvin-solve: what one camera has seen, from a file of
// observations or from pictures.
#pragma once

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/core/text.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/solve/view.hpp"

#include "given_board.hpp"
#ifdef RIG_OPENCV
#include "read_picture.hpp"
#endif

namespace rig_views {

namespace fs = std::filesystem;

// The files of a folder, or those whose names begin as `FOLDER/PREFIX*` says.
inline std::vector<fs::path> files_of(const std::string& source) {
  const bool is_pattern = source.ends_with('*');
  const fs::path path = is_pattern ? source.substr(0, source.size() - 1) : source;
  const fs::path folder = is_pattern ? path.parent_path() : path;
  const std::string prefix = is_pattern ? path.filename().string() : "";
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, none)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file(none) && name.starts_with(prefix)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The last number in the name of a file: pictures of one instant have the same.
inline std::optional<std::uint64_t> number_of(const fs::path& file) {
  const std::string name = file.stem().string();
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  auto end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  auto begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  if (begin == end || end - begin > 18) return std::nullopt;
  return std::stoull(name.substr(begin, end - begin));
}

// Pictures by the numbers in their names, or by their order where these are no numbers of their
// own.
inline std::vector<std::pair<std::uint64_t, fs::path>> numbered(
    const std::vector<fs::path>& files) {
  std::set<std::uint64_t> numbers;
  for (const auto& file : files) {
    if (const auto number = number_of(file)) numbers.insert(*number);
  }
  std::vector<std::pair<std::uint64_t, fs::path>> all;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const bool by_name = numbers.size() == files.size();
    all.emplace_back(by_name ? number_of(files[i]).value() : i, files[i]);
  }
  return all;
}

// Whether VIEWS are pictures: a folder, or a pattern.
inline bool are_pictures(const std::string& source) {
  std::error_code none;
  return source.ends_with('*') || fs::is_directory(source, none);
}

// Between views of pictures with numbers one apart, ns.
inline constexpr std::uint64_t kNumber = 1'000'000'000;

// The pictures of a source, with their numbers; none where OpenCV is not there to read them.
inline std::vector<std::pair<std::uint64_t, fs::path>> pictures_of(const std::string& source) {
  std::vector<fs::path> pictures = files_of(source);
#ifdef RIG_OPENCV
  std::erase_if(pictures, [](const fs::path& file) { return !cv::haveImageReader(file.string()); });
#else
  pictures.clear();
#endif
  return numbered(pictures);
}

// What is done to an observation once it is found, with the picture at hand; or nothing.
using OnFound = calvin::Observation (*)(const calvin::ImageView&, const calvin::Observation&,
                                        const calvin::Board&);

inline calvin::Result<std::vector<calvin::View>> in_pictures(
    const std::string& source, const std::vector<calvin::Board>& boards, OnFound on_found) {
#ifdef RIG_OPENCV
  const auto detector = calvin::make_detector(boards);
  if (!detector) return tl::unexpected<calvin::Error>(detector.error());
  std::vector<calvin::View> views;
  for (const auto& [number, file] : pictures_of(source)) {
    const cv::Mat picture = read_picture(file);
    if (picture.empty()) continue;
    const calvin::ImageView image = {picture.data, picture.cols, picture.rows,
                                     static_cast<std::ptrdiff_t>(picture.step[0]), 1};
    for (auto& found : (*detector)->detect_all(image)) {
      if (found.reason != calvin::Reason::kAccepted) continue;
      if (on_found != nullptr) {
        found.observation = on_found(image, found.observation, boards[found.board]);
      }
      found.observation.image_size = {picture.cols, picture.rows};
      found.observation.timestamp = number * kNumber;
      views.push_back({std::move(found.observation), boards[found.board]});
    }
  }
  return views;
#else
  static_cast<void>(on_found);
  return calvin::make_error(
      calvin::ErrorCode::kUnsupported,
      fmt::format("'{}' are pictures, and this program was built without OpenCV, which reads "
                  "them: give a file of observations (of {} boards).",
                  source, boards.size()));
#endif
}

// `board`: that of --board, or empty.
inline calvin::Result<std::vector<calvin::View>> in_observations(const std::string& path,
                                                                 const std::string& board) {
  auto file = calvin::read_observations(path);
  if (!file) return tl::unexpected<calvin::Error>(file.error());
  given_board::BoardsOfFile boards(path, board);
  std::vector<calvin::View> views;
  for (calvin::Observation& seen : file->observations) {
    const auto of = boards.board_of(seen.board.empty() ? file->board : seen.board);
    if (!of) return tl::unexpected<calvin::Error>(of.error());
    seen.board = of->text();
    if (seen.found()) views.push_back({std::move(seen), *of});
  }
  return views;
}

// Of a folder, a pattern or a file of observations; `board`: that of --board, or empty.
inline calvin::Result<std::vector<calvin::View>> read(const std::string& source,
                                                      const std::string& board,
                                                      OnFound on_found = nullptr) {
  if (!are_pictures(source)) return in_observations(source, board);
  const auto boards = calvin::parse_boards(given_board::or_usual(board));
  if (!boards) return tl::unexpected<calvin::Error>(boards.error());
  return in_pictures(source, *boards, on_found);
}

}  // namespace rig_views
