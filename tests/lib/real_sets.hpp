// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Real sets of pictures and of points, which nobody tuned to: folders of $CALVIN_DATA. The left
// pictures of OpenCV's samples are those of Debian's opencv-doc where that folder is missing.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <locale>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/view.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin::real {

struct Views {
  ImageSize size;
  std::vector<View> views;  // empty where the set is not there
};

// A set by its name: the model that suits its lens, and whether it is read and solved at once.
struct Set {
  const char* name;
  const char* model;
  const char* folder;
  const char* prefix;  // of the names of its pictures
  const char* board;   // of the pictures
  bool quick;
};

inline const std::vector<Set> kSets = {
    {"left", "brown5", "opencv-samples", "left", "checkerboard:9x6:30mm", true},
    {"right", "brown5", "opencv-samples", "right", "checkerboard:9x6:30mm", true},
    {"carnd", "brown5", "chess-carnd-lanes", "calibration", "checkerboard:9x6:30mm", false},
    {"camodocal", "fisheye", "fisheye-camodocal", "img", "checkerboard:9x6:80mm", false},
    {"urban1", "fisheye", "fisheye-urban1", "Fisheye1", "checkerboard:8x6:32.5mm", false},
    {"derlunz", "fisheye", "fisheye-derlunz", "3D", "checkerboard:15x9:26mm", false},
    {"gloworm1280", "brown5", "photonvision-gloworm_1280_720", "img", "checkerboard:8x6:25.4mm",
     false},
    {"gloworm960", "brown5", "photonvision-gloworm_960_720", "img", "checkerboard:8x6:25.4mm",
     false},
    {"gloworm320", "brown5", "photonvision-gloworm_320_240", "img", "checkerboard:8x6:25.4mm",
     true},
    {"picam", "brown5", "photonvision-piCam_640_480", "img", "checkerboard:7x7:25.4mm", true},
    {"stereo_left", "fisheye", "fisheye-stereo-stereopi", "left", "checkerboard:9x6:25mm", true},
    {"stereo_right", "fisheye", "fisheye-stereo-stereopi", "right", "checkerboard:9x6:25mm", false},
    {"omni", "ucm", "omni-points-opencv", "", "", false},
    {"yac0", "brown5", "aprilgrid-yac-points", "cam0", "", false},
    {"yac1", "brown5", "aprilgrid-yac-points", "cam1", "", false},
    {"ovplane", "fisheye", "aprilgrid-ovplane", "", "", true},
};

inline std::filesystem::path folder_of(const Set& set) {
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / set.folder;
  if (data != nullptr && std::filesystem::is_directory(folder)) return folder;
  const std::filesystem::path debian = "/usr/share/doc/opencv-doc/examples/data";
  if (std::string(set.name) == "left" && std::filesystem::exists(debian / "left01.jpg")) {
    return debian;
  }
  return {};
}

inline Views pictures(const Set& set, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::string kind = entry.path().extension().string();
    const bool picture = kind == ".jpg" || kind == ".JPG" || kind == ".png";
    if (picture && name.starts_with(set.prefix)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const Board board = parse_board(set.board).value();
  const auto detector = make_detector(board).value();
  Views result;
  for (const auto& file : files) {
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    const ImageSize size = {image.cols, image.rows};
    if (result.views.empty()) result.size = size;
    if (image.empty() || size != result.size) continue;
    auto found = detector->detect(
        {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1});
    if (found.reason != Reason::kAccepted) continue;
    found.observation.image_size = size;
    found.observation.timestamp = 1000 * (result.views.size() + 1);
    result.views.push_back({std::move(found.observation), board});
  }
  return result;
}

// Lines of numbers; other lines are told to `other`.
template <typename Numbers, typename Other>
void read_lines(const std::filesystem::path& path, Numbers numbers, Other other) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::vector<double> row;
    for (double x; words >> x;) row.push_back(x);
    row.empty() ? other(line) : numbers(row);
  }
}

// Corners by view and id become views, each in the order of its ids.
using Corners = std::map<int, std::map<int, Pixel>>;
inline Views points(const Corners& corners, const std::vector<PointBoard::Dot>& dots,
                    ImageSize size) {
  const Board board = PointBoard::make("points.json", dots).value();
  Views result;
  result.size = size;
  for (const auto& [number, of_view] : corners) {
    View view;
    view.board = board;
    view.observation.image_size = size;
    view.observation.timestamp = static_cast<std::uint64_t>(number);
    for (const auto& [id, at] : of_view) {
      view.observation.ids.push_back(id);
      view.observation.uv.push_back(at);
    }
    result.views.push_back(std::move(view));
  }
  return result;
}

// Tags of 88 mm, 0.3 of that apart; every so many of the frames of a video.
inline Views april_grid(const std::filesystem::path& file) {
  constexpr double kTag = 0.088;
  std::vector<PointBoard::Dot> dots;
  for (int id = 0; id < 4 * 36; ++id) {
    const int corner = id % 4;
    const double right = corner == 1 || corner == 2 ? kTag : 0;
    const double down = corner >= 2 ? kTag : 0;
    dots.push_back({id, 1.3 * kTag * (id / 4 % 6) + right, -(1.3 * kTag * (id / 24) + down), 1e-3});
  }
  Corners all;
  int frame = 0;
  read_lines(
      file,
      [&](const std::vector<double>& row) {
        const int id = 4 * static_cast<int>(row[0]) + static_cast<int>(row[1]);
        all[frame][id] = {row[2], row[3]};
      },
      [&frame](const std::string& line) { frame += line.starts_with("frame") ? 1 : 0; });
  constexpr int kFrames = 57;
  constexpr std::size_t kEnough = 20;
  const int every = std::max(1, frame / kFrames);
  std::erase_if(all, [&](const auto& view) {
    return (view.first - 1) % every != 0 || view.second.size() <= kEnough;
  });
  return points(all, dots, {752, 480});
}

// A board of squares of .75 in the unit of its makers, here 1 cm.
inline Views calibu_plane(const std::filesystem::path& file) {
  Corners all;
  std::map<int, PointBoard::Dot> dots;
  read_lines(
      file,
      [&](const std::vector<double>& row) {
        const auto x = static_cast<int>(std::lround(row[4] / 0.75));
        const auto y = static_cast<int>(std::lround(row[5] / 0.75));
        const int id = 40 * y + x;
        all[static_cast<int>(row[0])][id] = {row[1], row[2]};
        dots[id] = {id, 0.01 * x, 0.01 * y, 1e-3};
      },
      [](const std::string&) {});
  std::vector<PointBoard::Dot> used;
  for (const auto& [id, dot] : dots) used.push_back(dot);
  return points(all, used, {1280, 800});
}

// OpenCV's XML: matrices of the points of the board in every view, then of where they were seen.
inline Views omni_points(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::stringstream text;
  text << stream.rdbuf();
  const std::string all = text.str();
  const std::string open = "<data>";
  std::vector<std::vector<double>> matrices;
  for (auto at = all.find(open); at != std::string::npos; at = all.find(open, at + 1)) {
    const auto first = at + open.size();
    std::istringstream words(all.substr(first, all.find("</data>", first) - first));
    words.imbue(std::locale::classic());
    matrices.emplace_back();
    for (double x; words >> x;) matrices.back().push_back(x);
  }
  const Board board = Checkerboard{6, 9, 0.2};
  Views result;
  result.size = {1280, 960};
  for (std::size_t v = matrices.size() / 2; v < matrices.size(); ++v) {
    View view;
    view.board = board;
    view.observation.image_size = result.size;
    view.observation.ids = board.ids();
    for (std::size_t i = 0; i + 1 < matrices[v].size(); i += 2) {
      view.observation.uv.push_back({matrices[v][i], matrices[v][i + 1]});
    }
    result.views.push_back(std::move(view));
  }
  return result;
}

inline Views read(const Set& set) {
  const auto folder = folder_of(set);
  if (folder.empty()) return {};
  const std::string name = set.name;
  if (name == "omni") return omni_points(folder / "omni_calib_data.xml");
  if (name == "ovplane") return calibu_plane(folder / "points_train.txt");
  if (name.starts_with("yac")) return april_grid(folder / (std::string(set.prefix) + ".txt"));
  return pictures(set, folder);
}

}  // namespace calvin::real
