// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What is said of a board whose text is wrong by a length, or that a printer has stretched.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/solve/solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr std::size_t kViews = 25;

// About the middle of the board.
SE3 quarter_turn(const Board& board) {
  const BoardArea area = board.extent();
  const Eigen::Vector3d middle((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
  const Eigen::Matrix3d turn = exp_so3({0, 0, std::numbers::pi / 2});
  return {turn, middle - turn * middle};
}

// Views of a board whose points are where `moved` has them, named by the text of another one. Every
// second one is turned: all upright, a stretched board looks as one before another camera.
template <typename Moved>
std::vector<View> views_of(const std::string& text, const Moved& moved, unsigned seed) {
  scenes::Random random(seed);
  std::normal_distribution<double> noise(0, 0.05);
  const Board board = parse_board(text).value();
  const Camera camera = scenes::random_camera("brown4", random);
  std::vector<View> views;
  while (views.size() < kViews) {
    SE3 pose = scenes::random_pose(camera, board, random, scenes::uniform(random, 0.1, 0.7));
    if (views.size() % 2 == 1) pose = pose * quarter_turn(board);
    if (!scenes::sees_all(camera, board, pose)) continue;
    View view = scenes::observe(camera, board, pose, 0.05, random);
    for (std::size_t i = 0; i < view.observation.uv.size(); ++i) {
      const Pixel at = camera.project(pose * moved(board, i)).value();
      view.observation.uv[i] = {at.u + noise(random), at.v + noise(random)};
    }
    views.push_back(view);
  }
  return views;
}

std::string remarks_of(const std::vector<View>& views, bool offsets = false) {
  SolveOptions options;
  options.model = "brown4";
  options.offsets = offsets;
  const auto solution = solve(views, scenes::kSize, options);
  EXPECT_TRUE(solution.has_value()) << solution.error().message;
  std::string all;
  if (solution) {
    for (const std::string& remark : solution->calibration.remarks) all += remark + "\n";
  }
  return all;
}

// Gaps are measured as well as the text has them, to a few thousandths of a tag.
TEST(BoardText, IsSaidToHaveOtherGaps) {
  struct Case {
    const char* grid;
    double gap;
    bool offsets;
  };
  for (const auto& [grid, gap, offsets] : {Case{"6x6", 0.24, false},
                                           {"6x6", 0.28, false},
                                           {"6x6", 0.31, false},
                                           {"6x4", 0.35, false},
                                           {"6x6", 0.28, true},
                                           {"6x4", 0.31, true}}) {
    const std::string board = std::string("aprilgrid:") + grid + ":88mm:";
    const auto points = parse_board(board + std::to_string(gap))->points();
    const auto views = views_of(
        board + "0.3", [&](const Board& /*board*/, std::size_t i) { return points[i]; }, 3);
    const std::string said = remarks_of(views, offsets);
    double measured = 0;
    double printed = 0;
    const auto at = said.find("gaps of");
    ASSERT_NE(at, std::string::npos) << gap << ": " << said;
    ASSERT_EQ(std::sscanf(said.c_str() + at, "gaps of %lf of a tag (%*f mm) instead of %lf",
                          &measured, &printed),
              2);
    EXPECT_NEAR(measured, gap, 0.003 + 0.1 * std::abs(gap - 0.3)) << said;
    EXPECT_EQ(printed, 0.3);
  }
}

TEST(BoardText, IsSaidToBeOfABoardThatIsStretched) {
  for (const double longer : {-0.01, -0.003, 0.004, 0.02}) {
    const std::string said = remarks_of(views_of(
        "checkerboard:9x6:25mm",
        [&](const Board& board, std::size_t i) -> Eigen::Vector3d {
          return board.points()[i].cwiseProduct(Eigen::Vector3d(1 + longer, 1, 1));
        },
        5));
    const char* along = longer > 0 ? "longer along its rows" : "longer along its columns";
    EXPECT_NE(said.find(along), std::string::npos) << longer << ": " << said;
  }
}

// Corners that are off each by itself are off in no pattern.
TEST(BoardText, IsNotBlamedForCornersThatAreOffByThemselves) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    scenes::Random random(100 + seed);
    std::normal_distribution<double> off(0, 0.0003);
    for (const char* text : {"checkerboard:9x6:25mm", "aprilgrid:4x4:88mm:0.3"}) {
      std::vector<Eigen::Vector3d> points = parse_board(text)->points();
      for (Eigen::Vector3d& p : points) p += Eigen::Vector3d(off(random), off(random), 0);
      const std::string said = remarks_of(views_of(
          text, [&](const Board& /*board*/, std::size_t i) { return points[i]; }, seed));
      EXPECT_NE(said.find("The corners of the board are"), std::string::npos) << said;
      EXPECT_EQ(said.find("would have them"), std::string::npos) << said;
    }
  }
}

}  // namespace
}  // namespace calvin
