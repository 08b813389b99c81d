// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The solve against Zhang's published result.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/points.hpp"
#include "calvin/solve/solve_points.hpp"

namespace calvin {
namespace {

// The five views of a plane with 64 squares, in inches.
std::vector<PointSet> read_zhang(const std::filesystem::path& folder) {
  const auto read = [&folder](const std::string& name) {
    std::ifstream file(folder / name);
    file.imbue(std::locale::classic());
    std::vector<double> numbers;
    for (double x; file >> x;) numbers.push_back(x);
    return numbers;
  };
  const auto model = read("Model.txt");
  std::vector<PointSet> views;
  for (int v = 1; v <= 5; ++v) {
    const auto data = read("data" + std::to_string(v) + ".txt");
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
  const char* data = std::getenv("CALVIN_DATA");
  const auto folder = std::filesystem::path(data == nullptr ? "" : data) / "zhang";
  if (data == nullptr || !std::filesystem::exists(folder / "Model.txt")) {
    GTEST_SKIP() << "CALVIN_DATA does not name a folder with zhang/Model.txt";
  }
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
}

}  // namespace
}  // namespace calvin
