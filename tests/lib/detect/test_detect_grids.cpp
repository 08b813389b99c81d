// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Grids of dots and lines that go on beyond the picture: every point of one that is in view, each
// in its place in the grid, whatever the lens bends, lights, hides or soils.
#include <algorithm>
#include <cmath>
#include <map>
#include <ostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr ImageSize kSize = {960, 720};

Board board_of(const char* text) { return parse_board(text).value(); }

// The middle of the grid before the middle of the camera, `columns` across the picture.
SE3 pose_of(const Camera& camera, const Board& board, const Eigen::Vector3d& turn, double columns) {
  const Grid grid = board.grid().value();
  const Eigen::Vector3d middle(grid.distance_to(grid.cols / 2), grid.distance_to(grid.rows / 2), 0);
  SE3 pose = {exp_so3(turn), {}};
  pose.translation = Eigen::Vector3d(0, 0, camera.fx() * columns * grid.pitch / kSize.width) -
                     pose.rotation * middle;
  return pose;
}

struct Compared {
  int truly = 0;                         // points well within the picture
  int found = 0;                         // of them
  int others = 0;                        // that are where no point is
  double rms = 0;                        // px
  std::set<std::pair<int, int>> shifts;  // columns and rows from the true labels
};

// Of a detection with labels that are not turned. Points whose neighbours are in view, too, count.
Compared compare(const Board& board, const Observation& seen, const Observation& truth) {
  constexpr double kMargin = 12;  // px
  constexpr double kNear = 1;
  const Grid grid = board.grid().value();
  Compared c;
  std::map<std::pair<int, int>, std::size_t> by_place;  // of the truth, by whole px / 4
  const auto bucket = [](const Pixel& p) {
    return std::pair(static_cast<int>(std::floor(p.u / 4)), static_cast<int>(std::floor(p.v / 4)));
  };
  for (std::size_t i = 0; i < truth.ids.size(); ++i) by_place[bucket(truth.uv[i])] = i;
  std::set<std::size_t> matched;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    bool is_point = false;
    for (int step = 0; step < 9 && !is_point; ++step) {
      const auto [x, y] = bucket(seen.uv[i]);
      const auto at = by_place.find({x + step % 3 - 1, y + step / 3 - 1});
      if (at == by_place.end()) continue;
      const Pixel& p = truth.uv[at->second];
      const double off = std::hypot(p.u - seen.uv[i].u, p.v - seen.uv[i].v);
      if (off > kNear) continue;
      is_point = true;
      matched.insert(at->second);
      c.rms += off * off;
      const GridPlace own = grid.place(seen.ids[i]);
      const GridPlace right = grid.place(truth.ids[at->second]);
      c.shifts.insert({own.col - right.col, own.row - right.row});
    }
    c.others += is_point ? 0 : 1;
  }
  c.rms = std::sqrt(c.rms / std::max<double>(1, static_cast<double>(matched.size())));
  const std::set<int> in_view(truth.ids.begin(), truth.ids.end());
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const Pixel& p = truth.uv[i];
    const auto around = board.neighbours(truth.ids[i]);
    if (p.u < kMargin || p.v < kMargin || p.u > kSize.width - 1 - kMargin ||
        p.v > kSize.height - 1 - kMargin || around.size() < 4 ||
        !std::ranges::all_of(around, [&](int id) { return in_view.contains(id); })) {
      continue;
    }
    ++c.truly;
    c.found += matched.contains(i) ? 1 : 0;
  }
  return c;
}

struct GridCase {
  const char* name;
  const char* board;
  const char* model;
  std::vector<double> camera;
  Eigen::Vector3d turn;
  double columns;

  friend std::ostream& operator<<(std::ostream& out, const GridCase& c) { return out << c.name; }
};

const std::vector<double> kBarrel = {900, 900, 470, 366, -0.3, 0.1, 0, 0, 0};
const std::vector<double> kFisheye = {620, 620, 480, 358, 0.01, -0.004, 0, 0};
const std::vector<GridCase> kCases = {
    {"Dots", "dots:5mm", "brown5", kBarrel, {0.02, -0.01, 0.03}, 50},
    {"TiltedDots", "dots:5mm", "brown5", kBarrel, {0.6, 0.2, 0.2}, 40},
    {"DotsBeforeAFisheye", "dots:5mm", "fisheye", kFisheye, {0.05, 0.1, -0.1}, 30},
    {"LightDots", "dots:5mm:inverted", "brown5", kBarrel, {0.02, 0.3, -0.2}, 30},
    {"Lines", "lines:5mm", "brown5", kBarrel, {0.02, -0.01, 0.03}, 40},
    {"TiltedLines", "lines:5mm", "brown5", kBarrel, {0.5, 0.2, 0.2}, 24},
    {"LinesFarApart", "lines:5mm", "brown5", kBarrel, {0.1, 0.1, -0.3}, 9},
    {"LightLines", "lines:5mm:inverted", "brown5", kBarrel, {0.02, 0.3, -0.2}, 30},
};

class Grids : public ::testing::TestWithParam<GridCase> {
 protected:
  static Board board() { return board_of(GetParam().board); }
  static bool is_lines() { return std::string(GetParam().board).starts_with("lines"); }
  static Camera camera() {
    return Camera::make(GetParam().model, kSize, GetParam().camera).value();
  }
  static SE3 pose() { return pose_of(camera(), board(), GetParam().turn, GetParam().columns); }
  static GrayImage picture() {
    RenderOptions options;
    options.blur = 0.7;
    options.noise = 1.5;
    options.seed = 5;
    return render_board(camera(), board(), pose(), options);
  }
  static Detection detect(const GrayImage& image) {
    return make_detector(board()).value()->detect(image.view());
  }
  static Compared compare(const Observation& seen) {
    return calvin::compare(board(), seen, true_observation(camera(), board(), pose()));
  }
};
INSTANTIATE_TEST_SUITE_P(Cases, Grids, ::testing::ValuesIn(kCases),
                         [](const auto& test) { return test.param.name; });

TEST_P(Grids, AreFoundWithEveryPointInItsPlace) {
  const Detection found = detect(picture());
  ASSERT_EQ(found.reason, Reason::kAccepted);
  const Compared c = compare(found.observation);
  EXPECT_GT(c.truly, 40);
  EXPECT_GE(c.found, (is_lines() ? 0.97 : 0.99) * c.truly) << "of " << c.truly;
  EXPECT_EQ(c.others, 0);
  EXPECT_EQ(c.shifts.size(), 1u) << "one shift for all labels";
  EXPECT_LT(c.rms, 0.06);
  EXPECT_EQ(found.observation.board, GetParam().board);
  EXPECT_EQ(found.observation.ambiguous, (std::vector<Relabelling>{{1}, {2}, {3}}));
}

// Two rows are painted over from one side to the other, and there is dirt.
TEST_P(Grids, AreWholeWhereRowsAreMissingAndDirtLies) {
  if (GetParam().columns < 20) GTEST_SKIP() << "few rows";
  GrayImage image = picture();
  const Observation truth = true_observation(camera(), board(), pose());
  const Grid grid = board().grid().value();
  const auto paint = [&image](const Pixel& at, int half, std::uint8_t grey) {
    for (int y = std::max(0, static_cast<int>(at.v) - half);
         y < std::min(image.height, static_cast<int>(at.v) + half); ++y) {
      for (int x = std::max(0, static_cast<int>(at.u) - half);
           x < std::min(image.width, static_cast<int>(at.u) + half); ++x) {
        image.row(y)[x] = grey;
      }
    }
  };
  const bool inverted = std::string(GetParam().board).ends_with("inverted");
  const std::uint8_t ground = inverted ? 30 : 220;
  int hidden = 0;
  for (std::size_t i = 0; i < truth.ids.size(); ++i) {
    const GridPlace p = grid.place(truth.ids[i]);
    const bool in_rows = p.row == grid.rows / 2 - 4 || p.row == grid.rows / 2 - 3;
    if (in_rows) paint(truth.uv[i], 7, ground);
    if (!in_rows && i % 97 == 0) paint({truth.uv[i].u + 5, truth.uv[i].v + 3}, 6, 110);
    hidden += in_rows || i % 97 == 0 ? 1 : 0;
  }
  const Detection found = detect(image);
  ASSERT_EQ(found.reason, Reason::kAccepted);
  const Compared c = compare(found.observation);
  EXPECT_EQ(c.shifts.size(), 1u);
  // Lines that are cut off leave their neighbours without an arm.
  EXPECT_GE(c.found, 0.98 * c.truly - (is_lines() ? 3.2 : 1.4) * hidden)
      << c.truly << " " << hidden;
  EXPECT_LE(c.others, hidden / 4);
}

// Thousands of dots that are 4 px apart where they are far: the next one may be that of the next
// row, and a row may go on as another one. Fitted to the true camera, each is near its place.
TEST(GridsAtAFlatAngle, KeepTheirNumbers) {
  constexpr ImageSize kSmall = {643, 481};
  const Camera camera = default_camera(kSmall);
  const Board board = board_of("dots:10mm");
  const Motion motion(MotionKind::kOrbit, camera, board, 7);
  const BoardRenderer renderer(camera);
  const auto detector = make_detector(board).value();
  for (const int n : {6, 7, 10, 11, 13, 20, 21, 23, 25, 50}) {
    const GrayImage picture =
        renderer.render(board, motion.camera_from_board(n),
                        {.noise = 2, .blur = 0.7, .seed = static_cast<std::uint64_t>(n)});
    const Observation seen = detector->detect(picture.view()).observation;
    EXPECT_GT(seen.ids.size(), 2000U) << n;
    PoseQuality quality;
    ASSERT_TRUE(solve_pose(camera, board, seen, &quality)) << n;
    EXPECT_LT(quality.rms, 0.1) << n;
  }
}

TEST(GridsThatAreNone, AreNotFound) {
  const Camera camera = default_camera(kSize);
  const GrayImage grey(kSize.width, kSize.height, 128);
  GrayImage noise(kSize.width, kSize.height);
  std::uint32_t state = 1;
  for (std::uint8_t& p : noise.pixels) {
    state = state * 1664525 + 1013904223;
    p = static_cast<std::uint8_t>(state >> 24);
  }
  const Board squares = board_of("checkerboard:20x14:5mm");
  SE3 pose;
  pose.translation = {-0.05, -0.035, 0.12};
  const GrayImage checkerboard = render_board(camera, squares, pose);
  for (const char* text : {"dots:5mm", "dots:5mm:inverted", "lines:5mm", "lines:5mm:inverted"}) {
    const auto detector = make_detector(board_of(text)).value();
    for (const GrayImage& image : {grey, noise, checkerboard}) {
      const Detection found = detector->detect(image.view());
      EXPECT_EQ(found.reason, Reason::kNotFound) << text << ": " << found.observation.ids.size();
    }
    EXPECT_EQ(detector->detect({}).reason, Reason::kNotFound);
  }
}

// A list of several boards, one of them twice: each grid is found once.
TEST(SeveralGrids, AreFoundEachByItsPattern) {
  const Camera camera = default_camera(kSize);
  const Board lines = board_of("lines:5mm");
  const std::vector<Board> list = {board_of("dots:5mm"), lines, board_of("checkerboard:9x6:25mm"),
                                   lines};
  const GrayImage image = render_board(camera, lines, pose_of(camera, lines, {0, 0, 0}, 30));
  const auto found = make_detector(list).value()->detect_all(image.view());
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].reason, Reason::kNotFound);
  EXPECT_EQ(found[1].reason, Reason::kAccepted);
  EXPECT_NE(found[2].reason, Reason::kAccepted);
  EXPECT_EQ(found[3].reason, Reason::kNotFound);
}

}  // namespace
}  // namespace calvin
