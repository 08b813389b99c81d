// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The solve against published results: Zhang's, and fisheye lenses past 90 degrees.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/judge/solve_points.hpp"
#include "calvin/solve/residuals/points.hpp"

namespace calvin {
namespace {

std::vector<double> read_numbers(const std::filesystem::path& path) {
  std::ifstream file(path);
  file.imbue(std::locale::classic());
  std::vector<double> numbers;
  // A line that starts with # is a heading.
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    for (double x; words >> x;) numbers.push_back(x);
  }
  return numbers;
}

// The file below $CALVIN_DATA; empty where there is none.
std::filesystem::path data_file(const char* name) {
  const char* data = std::getenv("CALVIN_DATA");
  if (data == nullptr) return {};
  auto path = std::filesystem::path(data) / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path();
}

// The five views of a plane with 64 squares, in inches.
std::vector<PointSet> read_zhang(const std::filesystem::path& folder) {
  const auto model = read_numbers(folder / "Model.txt");
  std::vector<PointSet> views;
  for (int v = 1; v <= 5; ++v) {
    const auto data = read_numbers(folder / ("data" + std::to_string(v) + ".txt"));
    PointSet view;
    view.index = static_cast<std::size_t>(v - 1);
    for (std::size_t i = 0; i + 1 < std::min(model.size(), data.size()); i += 2) {
      view.ids.push_back(static_cast<int>(i / 2));
      view.points.emplace_back(model[i], model[i + 1], 0);
      view.uv.push_back({data[i], data[i + 1]});
      view.weight.push_back(1);
    }
    views.push_back(std::move(view));
  }
  return views;
}

TEST(Zhang, PublishedResultIsReproduced) {
  const auto file = data_file("zhang/Model.txt");
  if (file.empty()) GTEST_SKIP() << "CALVIN_DATA does not name a folder with zhang/Model.txt";
  const auto folder = file.parent_path();
  auto views = read_zhang(folder);
  ASSERT_EQ(views[4].size(), 256u);
  SolveOptions options;
  options.model = "brown4";
  options.skew = true;
  options.fix = {"p1", "p2"};
  options.reject_outliers = false;
  const auto solution = solve_points(std::move(views), {}, {640, 480}, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  const Calibration& c = solution->calibration;
  EXPECT_NEAR(c.find("fx")->value, 832.5, 0.01);
  EXPECT_NEAR(c.find("fy")->value, 832.53, 0.01);
  EXPECT_NEAR(c.find("skew")->value, 0.204494, 0.001);
  EXPECT_NEAR(c.find("cx")->value, 303.959, 0.01);
  EXPECT_NEAR(c.find("cy")->value, 206.585, 0.01);
  EXPECT_NEAR(c.find("k1")->value, -0.228601, 1e-4);
  EXPECT_NEAR(c.find("k2")->value, 0.190353, 1e-4);
  EXPECT_NEAR(*c.rms, 0.336, 0.002);

  // Camera and two coefficients, then R and t of each view.
  const auto told = read_numbers(folder / "calibration-result-zhang-withdistortion.txt");
  ASSERT_EQ(told.size(), 7u + 5 * 12);
  for (std::size_t v = 0; v < 5; ++v) {
    const double* row = &told[7 + 12 * v];
    const SE3 ours = to_se3(c.views[v].camera_from_board);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(row);
    const Eigen::Matrix3d between = rotation.transpose() * ours.rotation;
    EXPECT_LT(log_so3(closest_rotation(between)).norm() * 180 / std::numbers::pi, 0.01) << v;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(ours.translation[k], row[9 + k], 0.001) << v;
  }
}

struct Fisheye {
  const char* file;
  int columns;  // view u v ... X Y Z
  double unit;  // of X Y Z, m
  ImageSize size;
  double rms;    // px, of another solver's KB4
  double digit;  // px, half of the last that is told
};

class FisheyePoints : public ::testing::TestWithParam<Fisheye> {};
INSTANTIATE_TEST_SUITE_P(
    Peers, FisheyePoints,
    ::testing::Values(
        Fisheye{"aprilgrid-ovplane/points_train.txt", 7, 0.01, {1280, 800}, 0.4815, 5e-5},
        Fisheye{"fisheye190-ocamcalib/corners.txt", 6, 1e-3, {752, 480}, 1.48, 5e-3}));

TEST_P(FisheyePoints, AreFittedAsWellAsAnywhere) {
  const Fisheye& set = GetParam();
  const auto file = data_file(set.file);
  if (file.empty()) GTEST_SKIP() << "CALVIN_DATA does not name a folder with " << set.file;
  const auto numbers = read_numbers(file);
  std::vector<PointSet> views;
  double view = -1;
  const auto columns = static_cast<std::size_t>(set.columns);
  for (std::size_t at = 0; at + columns <= numbers.size(); at += columns) {
    const double* row = &numbers[at];
    if (row[0] != view) views.emplace_back().index = views.size() - 1;
    view = row[0];
    PointSet& points = views.back();
    points.ids.push_back(static_cast<int>(points.ids.size()));
    const double* xyz = row + columns - 3;
    points.points.emplace_back(set.unit * xyz[0], set.unit * xyz[1], set.unit * xyz[2]);
    points.uv.push_back({row[1], row[2]});
    points.weight.push_back(1);
  }
  ASSERT_GE(views.size(), 7u);
  SolveOptions options;
  options.model = "fisheye";
  options.reject_outliers = false;
  const auto solution = solve_points(std::move(views), {}, set.size, options);
  ASSERT_TRUE(solution.has_value()) << solution.error().message;
  EXPECT_LE(*solution->calibration.rms, 1.001 * (set.rms + set.digit));
  // And no view was left out for it.
  EXPECT_TRUE(solution->rejected.empty());
}

}  // namespace
}  // namespace calvin
