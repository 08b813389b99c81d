// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Boards of every size and both colours are found whole, wherever they are seen from.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"

namespace calvin {
namespace {

// The id that a control point has once the board was turned by so many quarters: an odd number of
// them for a square one only.
int turned(const Grid& board, int id, int quarters) {
  int col = id % board.cols;
  int row = id / board.cols;
  if (quarters >= 2) {
    col = board.cols - 1 - col;
    row = board.rows - 1 - row;
  }
  if (quarters % 2 == 1) {
    std::swap(col, row);
    row = board.rows - 1 - row;
  }
  return row * board.cols + col;
}

double largest_error(const Board& board, const Observation& found, const Observation& truth,
                     int quarters) {
  double most = 0;
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    const auto id = static_cast<std::size_t>(turned(*board.grid(), found.ids[i], quarters));
    most =
        std::max(most, std::hypot(found.uv[i].u - truth.uv[id].u, found.uv[i].v - truth.uv[id].v));
  }
  return most;
}

struct Kind {
  const char* text;
  bool inverted;
};

class EveryBoard : public ::testing::TestWithParam<Kind> {};
constexpr Kind kKinds[] = {
    {"3x3", false}, {"3x3", true},  {"3x4", false},   {"4x4", true},  {"5x3", true},
    {"6x9", true},  {"7x5", true},  {"5x7", true},    {"7x7", true},  {"8x6", false},
    {"8x6", true},  {"3x10", true}, {"20x15", false}, {"40x3", true}, {"30x20", true},
};
INSTANTIATE_TEST_SUITE_P(Boards, EveryBoard, ::testing::ValuesIn(kKinds), [](const auto& test) {
  return std::string(test.param.text) + (test.param.inverted ? "_inverted" : "");
});

// One in a hundred may be missed: without one of its corners an inverted board may be another one.
TEST_P(EveryBoard, IsFoundWhole) {
  const Board board = parse_board(std::string("checkerboard:") + GetParam().text + ":20mm").value();
  const ImageSize size = {1280, 960};
  const Camera camera = default_camera(size);
  const Motion motion(MotionKind::kRandom, camera, board, 3);
  const auto detector = make_detector(board).value();
  const int poses = std::getenv("CALVIN_FULL") != nullptr ? 100 : 8;
  int missed = 0;
  for (int n = 0; n < poses; ++n) {
    RenderOptions options{.noise = 2, .blur = 0.8, .seed = static_cast<std::uint64_t>(n)};
    if (GetParam().inverted) std::swap(options.dark, options.light);
    const SE3 pose = motion.camera_from_board(n);
    const Detection d = detector->detect(render_board(camera, board, pose, options).view());
    if (d.reason != Reason::kAccepted && ++missed <= poses / 100) continue;
    ASSERT_EQ(d.reason, Reason::kAccepted) << n;
    const Observation truth = true_observation(camera, board, pose);
    ASSERT_EQ(d.observation.ids.size(), truth.ids.size()) << n;
    double least = HUGE_VAL;
    for (int quarters = 0; quarters < 4; ++quarters) {
      if (quarters % 2 == 1 && board.grid()->cols != board.grid()->rows) continue;
      least = std::min(least, largest_error(board, d.observation, truth, quarters));
    }
    EXPECT_LT(least, 0.15) << n;
  }
}

// Close before a fisheye the squares of a board are of very different sizes: from 60 mm, tilted by
// 20 degrees, by 8 times.
// The middle of a board, with none of its edges: any board could be that, or a floor. One edge more
// tells that it is one.
TEST(PartsOfABoard, AreNoneWithoutAnEdge) {
  const Board b = parse_board("checkerboard:13x10:25mm").value();
  const Camera camera = default_camera({640, 480});
  const auto detector = std::move(*make_detector(b));
  const auto found = [&](double x) {
    const SE3 pose = {exp_so3({0.05, -0.08, 0.1}), {x, -0.1, 0.17}};
    const auto seen =
        detector->detect(render_board(camera, b, pose, {.noise = 2, .blur = 0.7}).view());
    const std::size_t corners = true_observation(camera, b, pose).ids.size();
    EXPECT_GT(corners, 0.3 * b.point_count()) << x;
    return seen.observation.found();
  };
  EXPECT_FALSE(found(-0.15));
  EXPECT_TRUE(found(-0.06));
}

TEST(WideView, IsFilledByABoard) {
  const Board board = parse_board("checkerboard:8x6:32.5mm").value();
  const ImageSize size = {1032, 778};
  const Camera camera =
      Camera::make("fisheye", size, {336, 336, 543, 377, 0.003, -0.01, 0.0035, -0.0012}).value();
  const auto detector = make_detector(board).value();
  int whole = 0;
  for (int n = 0; n < 12; ++n) {
    const int place = n / 4;
    const SE3 pose = {exp_so3({0.35 + 0.01 * (n % 4), 0.05, -0.01}),
                      {-0.133 + 0.003 * place, -0.05, 0.0586}};
    const Observation truth = true_observation(camera, board, pose);
    ASSERT_EQ(static_cast<int>(truth.ids.size()), board.point_count()) << n;
    RenderOptions options{.noise = 1, .blur = 0.7, .seed = static_cast<std::uint64_t>(n)};
    const Detection d = detector->detect(render_board(camera, board, pose, options).view());
    EXPECT_GE(10 * d.observation.ids.size(), 8 * truth.ids.size()) << n;
    whole += d.observation.ids.size() == truth.ids.size() ? 1 : 0;
    EXPECT_LT(std::min(largest_error(board, d.observation, truth, 0),
                       largest_error(board, d.observation, truth, 2)),
              0.2)
        << n;
  }
  EXPECT_GE(whole, 10);
}

}  // namespace
}  // namespace calvin
