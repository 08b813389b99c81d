// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sets of views for table2: simulated after the paper, or drawn from files of observations.
#pragma once

#include <algorithm>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/core/file.hpp"
#include "calvin/core/text.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/io/observations.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/board.hpp"
#include "calvin/target/kinds.hpp"

namespace table2 {

using Random = std::mt19937_64;
using Sets = std::vector<std::vector<calvin::View>>;

// One row of the paper's Table 2 (ten sets of 25 pictures of 640x480).
struct PaperRow {
  std::string_view name;
  double mean;  // where the paper tells it; else 0
  double spread;
};
inline constexpr PaperRow kPaper[] = {
    {"fx", 1424.32, 2.74},  {"fy", 1424.06, 2.72}, {"cx", 302.71, 3.67}, {"cy", 240.95, 2.88},
    {"k1", -0.243, 0.0124}, {"k2", 0.391, 0.255},  {"p1", 0, 0.00036},   {"p2", 0, 0.00056}};

// What gives the paper's spreads: the noise of its detector is not told.
inline constexpr calvin::ImageSize kSize = {640, 480};
inline constexpr double kSigma = 0.28;   // px
inline constexpr double kFillLow = 0.5;  // of the width
inline constexpr double kFillHigh = 0.9;
inline constexpr double kMaxTilt = std::numbers::pi / 4;

inline calvin::Camera paper_camera() {
  std::vector<double> parameters;
  for (const PaperRow& row : kPaper) parameters.push_back(row.mean);
  return calvin::Camera::make("brown4", kSize, parameters).value();
}

// A pose of the board, wholly in the picture: tilted 0 to 45 degrees to any side.
inline calvin::SE3 random_pose(const calvin::Camera& camera, const calvin::Board& board,
                               Random& random) {
  const auto draw = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto points = board.points();
  const Eigen::Vector3d centre = (points.front() + points.back()) / 2;
  for (;;) {
    const double width = draw(kFillLow, kFillHigh) * kSize.width;  // px, seen from the front
    const double distance = camera.fx() * board.extent().width() / width;
    const double tilt = draw(0, kMaxTilt);
    const double side = draw(0, 2 * std::numbers::pi);
    const auto ray = camera.unproject({draw(0, kSize.width - 1), draw(0, kSize.height - 1)});
    if (!ray) continue;
    const Eigen::Matrix3d turn = calvin::rotation_between(Eigen::Vector3d::UnitZ(), *ray) *
                                 calvin::exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0});
    calvin::SE3 pose = {turn, *ray * distance - turn * centre};
    const bool inside = std::all_of(points.begin(), points.end(), [&](const Eigen::Vector3d& p) {
      const auto at = camera.project(pose * p);
      return at && at->u >= 0 && at->v >= 0 && at->u <= kSize.width - 1 &&
             at->v <= kSize.height - 1;
    });
    if (inside) return pose;
  }
}

inline calvin::Board paper_board() { return calvin::Checkerboard{9, 6, 0.03125}; }

inline std::vector<calvin::View> simulate(int views, Random& random) {
  static const calvin::Camera kCamera = paper_camera();
  const calvin::Board board = paper_board();
  const auto points = board.points();
  std::normal_distribution<double> noise(0, kSigma);
  std::vector<calvin::View> set;
  for (int v = 0; v < views; ++v) {
    const calvin::SE3 pose = random_pose(kCamera, board, random);
    calvin::View view;
    view.board = board;
    view.observation.board = board.text();
    view.observation.image_size = kSize;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const calvin::Pixel at = kCamera.project(pose * points[i]).value();
      view.observation.ids.push_back(static_cast<int>(i));
      view.observation.uv.push_back({at.u + noise(random), at.v + noise(random)});
      view.observation.sigma.push_back(kSigma);
    }
    set.push_back(std::move(view));
  }
  return set;
}

// The views of one file: JSON lines, or corners.vnl, which `board` and `size` belong to.
inline calvin::Result<std::vector<calvin::View>> read_views(const std::string& path,
                                                            const std::string& board,
                                                            calvin::ImageSize size) {
  const auto content = calvin::read_file(path);
  if (!content) return tl::unexpected(content.error());
  std::vector<calvin::Observation> observations;
  if (content->starts_with('{')) {
    auto file = calvin::parse_observations(*content, path);
    if (!file) return tl::unexpected(file.error());
    observations = std::move(file->observations);
  } else {
    if (board.empty() || size.width == 0) {
      return calvin::make_error(
          calvin::ErrorCode::kInvalidArgument,
          fmt::format("{} does not tell the board and the size of its pictures: give --board and "
                      "--size.",
                      path));
    }
    auto corners = calvin::parse_corners_vnl(*content, board, size, path);
    if (!corners) return tl::unexpected(corners.error());
    observations = std::move(*corners);
  }
  std::vector<calvin::View> views;
  for (calvin::Observation& seen : observations) {
    if (!seen.found()) continue;
    const auto parsed = calvin::parse_board(board.empty() ? seen.board : board);
    if (!parsed) return tl::unexpected(parsed.error());
    views.push_back({std::move(seen), *parsed});
  }
  return views;
}

// Shuffled and cut into sets; where they do not suffice for `count` sets, all are shuffled again
// for each, so that sets share views.
inline Sets cut(std::vector<calvin::View> views, int count, int each, Random& random) {
  Sets sets;
  const auto size = static_cast<std::size_t>(each);
  std::size_t at = views.size();
  for (int i = 0; i < count && views.size() >= size; ++i) {
    if (at + size > views.size()) {
      std::shuffle(views.begin(), views.end(), random);
      at = 0;
    }
    sets.emplace_back(views.begin() + static_cast<std::ptrdiff_t>(at),
                      views.begin() + static_cast<std::ptrdiff_t>(at + size));
    at += size;
  }
  return sets;
}

}  // namespace table2
