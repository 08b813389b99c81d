// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures without the board, and boards in the midst of what looks like one.
#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/board_match.hpp"
#include "calvin/detect/checkerboard/corner_graph.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/detect/identify.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"
#include "detect_scenes.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

ImageView view_of(const cv::Mat& image) {
  return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1};
}

// Clutter, tiles, textiles, text, keys and boards of other sizes.
class NegativesFor : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Boards, NegativesFor,
                         ::testing::Values("checkerboard:9x6:25mm", "circles:7x5:30mm",
                                           "circles:4x4:30mm:inverted", "acircles:4x11:20mm",
                                           "dots:5mm", "lines:5mm", "dots:9x9:20mm:big=0.0", "dot",
                                           "checkerboard:9x6:25mm:circles",
                                           "apriltag:tag36h11:80mm:0=0,0+1=1m,0+2=0,1m"));
// Of tags of AprilTag 3 any light region with a dark line around it may be one.
INSTANTIATE_TEST_SUITE_P(AprilTag3, NegativesFor,
                         ::testing::Values("apriltag:tagStandard41h12:80mm:0=0,0+1=1m,0+2=0,1m",
                                           "apriltag:tagCircle49h12:2x2:80mm:110mm"));
TEST_P(NegativesFor, HaveNoBoard) {
  const auto board = parse_board(GetParam());
  if (!board) GTEST_SKIP() << board.error().message;
  const auto finder = make_detector(*board).value();
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{800, 600};
  for (std::uint64_t seed = 0; seed < (full ? 1200 : 16); ++seed) {
    const Detection d = finder->detect(view_of(bench::make_negative(size, 5000 + seed)));
    EXPECT_FALSE(d.observation.found()) << seed;
  }
}

// One after the other they are a video in which everything changes all the time.
TEST(Negatives, HaveNoLightOneAfterTheOther) {
  const auto finder = make_detector(parse_board("dot").value()).value();
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{800, 600};
  for (std::uint64_t seed = 0; seed < (full ? 1200 : 40); ++seed) {
    const Detection d =
        finder->follow(view_of(bench::make_negative(size, 5000 + seed)), 33'333'333 * seed);
    EXPECT_FALSE(d.observation.found()) << seed;
  }
}

// Some of them have checkerboards, which are said to be in view; nothing else is.
TEST(Negatives, ShowNoBoardWithACodeAndNoCircles) {
  const bool full = scenes::full_count();
  const ImageSize size = full ? ImageSize{1920, 1080} : ImageSize{800, 600};
  for (std::uint64_t seed = 0; seed < (full ? 1200 : 10); ++seed) {
    for (const IdentifiedBoard& seen :
         identify_boards(view_of(bench::make_negative(size, 5000 + seed)), 0.025)) {
      EXPECT_TRUE(seen.board.as<Checkerboard>() != nullptr) << seed << seen.board.text();
    }
  }
}

// Fabrics and floors of which some corners are seen, three squares apart or nine, and boards of
// another size that end a few px above the border of the picture: they were taken for the board
// once.
TEST(Negatives, AreNoPartsOfTheBoard) {
  const auto finder = std::move(*make_detector(scenes::kBoard));
  for (const std::uint64_t seed : {5253, 5571, 5629, 10071, 11133, 12201, 12102, 20112}) {
    const Detection d = finder->detect(view_of(bench::make_negative({1920, 1080}, seed)));
    EXPECT_FALSE(d.observation.found()) << seed;
  }
}

TEST(Neighbours, AreJoinedByOneEdge) {
  constexpr int kSide = 12;  // px
  GrayImage image(240, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 240; ++x) {
      image.row(y)[x] = (x / kSide + y / kSide) % 2 == 0 ? 200 : 40;
    }
  }
  for (const int every : {1, 3, 5, 7}) {
    std::vector<detect::Corner> corners;
    for (int row = 1; row < 19; row += every) {
      for (int col = 1; col < 19; col += every) {
        // Bright at the top left of even ones.
        const detect::Direction right = {1, 0};
        const detect::Direction down = {0, 1};
        const auto u = static_cast<float>(col * kSide) - 0.5F;
        const auto v = static_cast<float>(row * kSide) - 0.5F;
        const bool even = (col + row) % 2 == 0;
        corners.push_back({u, v, even ? right : down, even ? down : -right, 160});
      }
    }
    detect::CornerGraph graph;
    graph.build(image.view(), corners, 144, {});
    std::size_t links = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto& ways = graph.neighbours(static_cast<int>(i));
      links += ways.size() - std::count(ways.begin(), ways.end(), detect::kNoCorner);
    }
    EXPECT_EQ(links, every == 1 ? 4 * 18 * 17 : 0) << every;
  }
}

// The corners of a board, exact.
detect::Lattice lattice_of(const Camera& camera, const Checkerboard& board, const SE3& pose) {
  detect::Lattice lattice(20);
  const auto points = board.grid().points();
  const auto at = [&](int col, int row) {
    return camera.project(pose * points[static_cast<std::size_t>(row * board.cols + col)]).value();
  };
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      detect::Node node;
      node.x = static_cast<float>(at(col, row).u);
      node.y = static_cast<float>(at(col, row).v);
      node.contrast = 190;
      lattice.put({col + 1, row}, node);
    }
  }
  return lattice;
}

// Corners that are the board's in number are not the board where the squares go on.
TEST(Negatives, AreWindowsOfALargerBoard) {
  const Camera camera = default_camera({1280, 720});
  const Checkerboard window = scenes::kSquares;
  scenes::Random random(8);
  int boards = 0;
  for (int n = 0; n < 60; ++n) {
    const SE3 pose = scenes::random_pose(camera, window, random, 0.6);
    // Its first square two columns before that of the window.
    Checkerboard larger = window;
    larger.cols += n % 2 == 0 ? 4 : 2;
    larger.rows += 2;
    const SE3 moved = {pose.rotation,
                       pose.translation - pose.rotation * Eigen::Vector3d(2 * window.size, 0, 0)};
    if (!scenes::sees_all(camera, larger, moved)) continue;
    ++boards;
    detect::Lattice lattice = lattice_of(camera, window, pose);
    const GrayImage own = render_board(camera, window, pose, {.noise = 2, .blur = 1});
    EXPECT_EQ(detect::match_board(own.view(), window, lattice).reason, Reason::kAccepted) << n;
    const GrayImage other = render_board(camera, larger, moved, {.noise = 2, .blur = 1});
    EXPECT_EQ(detect::match_board(other.view(), window, lattice).reason, Reason::kWrongBoard) << n;
  }
  EXPECT_GE(boards, 10);
}

// A floor of tiles is a board far too large; the board that lies on it is still one.
TEST(Boards, AreFoundOnACheckeredFloor) {
  const auto finder = std::move(*make_detector(scenes::kBoard));
  const Camera camera = default_camera({1280, 720});
  const BoardRenderer renderer(camera);
  const int images = scenes::full_count() ? 100 : 8;
  scenes::Random random(6);
  int found = 0;
  for (int n = 0; n < images; ++n) {
    const double tile = scenes::uniform(random, 0.04, 0.15);
    const Board floor = Checkerboard{40, 30, tile};
    const SE3 at = {
        exp_so3({scenes::uniform(random, -0.4, 0.4), 0.2, scenes::uniform(random, 0, 1)}),
        {-20 * tile, -15 * tile, 1.2}};
    const SE3 pose = scenes::random_pose(camera, scenes::kBoard, random, 0.4);
    GrayImage image =
        renderer.render(floor, at, {.noise = 2, .blur = 0.8, .dark = 60, .light = 170});
    const GrayImage on_black = renderer.render(
        scenes::kBoard, pose, {.noise = 2, .blur = 0.8, .seed = 1, .background = 0});
    const GrayImage on_white = renderer.render(
        scenes::kBoard, pose, {.noise = 2, .blur = 0.8, .seed = 1, .background = 255});
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      if (on_white.pixels[i] - on_black.pixels[i] < 128) image.pixels[i] = on_black.pixels[i];
    }
    const Observation o = finder->detect(image.view()).observation;
    const Observation truth = true_observation(camera, scenes::kBoard, pose);
    for (std::size_t i = 0; i < o.uv.size() && o.ids == truth.ids; ++i) {
      EXPECT_LT(std::hypot(o.uv[i].u - truth.uv[i].u, o.uv[i].v - truth.uv[i].v), 0.2);
    }
    found += o.ids == truth.ids ? 1 : 0;
  }
  std::cout << "  " << found << " of " << images << '\n';
  EXPECT_GE(found, images * 95 / 100);
}

}  // namespace
}  // namespace calvin
