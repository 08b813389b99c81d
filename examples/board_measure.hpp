// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// calvin-board measure: the shape of a named board, from what one or several cameras saw of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "calvin/detect/detector.hpp"
#include "calvin/io/board_names.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/measured/board_measurement.hpp"
#ifdef BOARD_OPENCV
#include "read_picture.hpp"
#endif

namespace board_measure {

// What one camera saw.
struct CameraViews {
  std::string name;
  std::vector<calvin::View> views;
};

// The pictures of a folder are those of one camera; a picture of another size is another camera's.
inline calvin::Result<std::vector<CameraViews>> in_pictures(const std::filesystem::path& folder,
                                                            const calvin::Board& board) {
#ifdef BOARD_OPENCV
  const auto detector = calvin::make_detector(board);
  if (!detector) return tl::unexpected<calvin::Error>(detector.error());
  std::vector<std::filesystem::path> files;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none)) {
    if (entry.is_regular_file(none)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::map<std::pair<int, int>, CameraViews> cameras;
  for (const auto& file : files) {
    const cv::Mat picture = read_picture(file);
    if (picture.empty()) continue;
    auto found = (*detector)->detect({picture.data, picture.cols, picture.rows,
                                      static_cast<std::ptrdiff_t>(picture.step[0]), 1});
    if (found.reason != calvin::Reason::kAccepted) continue;
    found.observation.image_size = {picture.cols, picture.rows};
    CameraViews& camera = cameras[{picture.cols, picture.rows}];
    camera.name = fmt::format("{} ({}x{})", folder.string(), picture.cols, picture.rows);
    camera.views.push_back({std::move(found.observation), board});
  }
  std::vector<CameraViews> all;
  for (auto& [size, camera] : cameras) all.push_back(std::move(camera));
  return all;
#else
  return calvin::make_error(
      calvin::ErrorCode::kUnsupported,
      fmt::format("'{}' is a folder, and this program was built without OpenCV, which reads "
                  "pictures: give files of observations (for {}).",
                  folder.string(), board.text()));
#endif
}

inline calvin::Result<std::vector<CameraViews>> in_observations(const std::filesystem::path& path,
                                                                const calvin::Board& board) {
  auto file = calvin::read_observations(path);
  if (!file) return tl::unexpected<calvin::Error>(file.error());
  std::map<std::tuple<std::string, int, int>, CameraViews> cameras;
  for (calvin::Observation& seen : file->observations) {
    const auto own = calvin::parse_board(seen.board.empty() ? file->board : seen.board);
    if (!seen.found() || !own || *own != board) continue;
    CameraViews& camera = cameras[{seen.camera, seen.image_size.width, seen.image_size.height}];
    camera.name =
        fmt::format("{} of {}", seen.camera.empty() ? "the camera" : seen.camera, path.string());
    camera.views.push_back({std::move(seen), board});
  }
  std::vector<CameraViews> all;
  for (auto& [key, camera] : cameras) all.push_back(std::move(camera));
  return all;
}

// The mean sigma of a corner in the plane of the board, m.
inline double sigma_of(const calvin::BoardMeasurement& measured) {
  double sum = 0;
  for (Eigen::Index i = 0; i < measured.covariance.rows(); i += 3) {
    sum += measured.covariance(i, i) + measured.covariance(i + 1, i + 1);
  }
  return std::sqrt(sum / (2 * static_cast<double>(measured.offsets.size())));
}

// Takes out the views that measured the board already: they count once.
inline void leave_known_out(std::vector<calvin::View>& views,
                            const calvin::BoardMeasurement& known) {
  std::erase_if(views, [&known](const calvin::View& view) {
    const calvin::ViewMark mark = calvin::mark_of(view.observation);
    return std::any_of(known.views.begin(), known.views.end(),
                       [&mark](const calvin::ViewMark& k) { return calvin::same_view(mark, k); });
  });
}

// Adds what one camera says to what is known. False where it says nothing, which is printed.
inline bool add_camera(CameraViews camera, const std::string& model,
                       std::shared_ptr<const calvin::BoardMeasurement>& known) {
  calvin::SolveOptions options;
  options.model = model;
  options.offsets = true;
  options.measured = known;
  const auto left_out = [&camera](const std::string& why) {
    fmt::print("{}: {} views, left out: {}\n", camera.name, camera.views.size(), why);
    return false;
  };
  if (known) leave_known_out(camera.views, *known);
  if (camera.views.empty()) return left_out("views that measured the board already count once");
  const auto solution =
      calvin::solve(camera.views, camera.views.front().observation.image_size, options);
  if (!solution) return left_out(solution.error().message);
  if (solution->other_board) {
    return left_out("they show another sheet than the one that was measured, or it is bent");
  }
  if (!solution->measured) {
    return left_out("it takes 8 views or more, most of which show which way round the board is");
  }
  known = solution->measured;
  fmt::print("{}: {} views, rms {:.3f} px; corners are known to {:.1f} um\n", camera.name,
             camera.views.size(), solution->calibration.rms.value_or(0), 1e6 * sigma_of(*known));
  return true;
}

// Measures the board `named` by what is in `sources`, and stores it. Returns whether anything was
// learnt.
inline calvin::Result<bool> measure(const std::string& named, const std::string& model,
                                    const std::vector<std::string>& sources) {
  const auto boards = calvin::parse_boards(named);
  if (!boards) return tl::unexpected<calvin::Error>(boards.error());
  if (boards->size() != 1 || !calvin::names_a_file(named)) {
    return calvin::make_error(calvin::ErrorCode::kInvalidArgument,
                              fmt::format("'{}' is not the name of one board: give it one with "
                                          "'calvin-board add', and then FILE.json#NAME.",
                                          named));
  }
  const calvin::Board& board = boards->front();
  if (const auto can = calvin::can_be_measured(board); !can) {
    return tl::unexpected<calvin::Error>(can.error());
  }
  auto known = calvin::read_measurement(named);
  if (!known) return tl::unexpected<calvin::Error>(known.error());
  bool learnt = false;
  for (const std::string& source : sources) {
    std::error_code none;
    const auto cameras = std::filesystem::is_directory(source, none)
                             ? in_pictures(source, board)
                             : in_observations(source, board);
    if (!cameras) return tl::unexpected<calvin::Error>(cameras.error());
    if (cameras->empty()) fmt::print("{}: {} is nowhere to be seen\n", source, board.text());
    for (const CameraViews& camera : *cameras) learnt = add_camera(camera, model, *known) || learnt;
  }
  if (!learnt) return false;
  if (const auto stored = calvin::store_measurement(named, **known); !stored) {
    return tl::unexpected<calvin::Error>(stored.error());
  }
  return true;
}

}  // namespace board_measure
