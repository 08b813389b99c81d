// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners of a tag from its sides: fitted roughly, fully, and again from a rough fit; and by
// the other tags of its board where its own quad told too little.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/detect/detector.hpp"
#include "calvin/detect/tags/tag_fit.hpp"
#include "calvin/detect/tags/tag_reader.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {
namespace {

constexpr const char* kBoard = "aruco:6x5:60mm:15mm:DICT_6X6_250";
constexpr double kNoise = 4;

// Pictures of a board in one pose after the other.
class Views {
 public:
  Views(const char* board, ImageSize size, std::uint64_t seed, double noise, double blur)
      : board_(parse_board(board).value()),
        camera_(default_camera(size)),
        motion_(MotionKind::kRandom, camera_, board_, seed),
        noise_(noise),
        blur_(blur) {}

  [[nodiscard]] const Board& board() const { return board_; }
  [[nodiscard]] GrayImage picture(int n) const {
    return render_board(camera_, board_, motion_.camera_from_board(n),
                        {.noise = noise_, .blur = blur_, .seed = unsigned(n)});
  }
  [[nodiscard]] Observation truth(int n) const {
    return true_observation(camera_, board_, motion_.camera_from_board(n));
  }

 private:
  Board board_;
  Camera camera_;
  Motion motion_;
  double noise_;
  double blur_;
};

// The true corners of a tag, from its upper left one on clockwise; the ids of a grid of tags go
// along the corners of a whole row.
detect::Quad true_quad(const Observation& truth, const TagGrid& grid, int col, int row) {
  constexpr std::array<std::pair<int, int>, 4> kClockwise = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  detect::Quad quad;
  for (std::size_t i = 0; i < 4; ++i) {
    const int id = (2 * row + kClockwise[i].second) * 2 * grid.cols + 2 * col + kClockwise[i].first;
    const auto at = std::ranges::find(truth.ids, id) - truth.ids.begin();
    quad[i] = detect::point_of(truth.uv[static_cast<std::size_t>(at)]);
  }
  return quad;
}

double worst_distance(const detect::Quad& a, const detect::Quad& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

TEST(TagFits, RoughlyFullyAndAgain) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Views views(kBoard, {1280, 720}, 4, kNoise, 0.7);
  const TagGrid& grid = *views.board().as<TagGrid>();
  const detect::TagReader reader(detect::TagStyle(grid), grid.gap / grid.tag);
  double square = 0;
  int count = 0;
  for (int n = 0; n < 4; ++n) {
    const GrayImage image = views.picture(n);
    const Observation truth = views.truth(n);
    ASSERT_EQ(truth.ids.size(), 120U) << "the whole board is in view";
    for (int tag = 0; tag < grid.cols * grid.rows; ++tag) {
      const int col = tag % grid.cols;
      const int row = tag / grid.cols;
      const detect::Quad quad = true_quad(truth, grid, col, row);
      const detect::TagPattern pattern = reader.pattern_of(grid.tag_in(col, row));
      detect::TagGuess guess{quad, 3, detect::unknown_bends(quad)};
      for (detect::Point& corner : guess.corners) corner += detect::Point(1.5, -1);
      guess.care = detect::SideCare::kRough;
      const detect::TagFit rough = fit_tag(image.view(), guess, pattern);
      guess.care = detect::SideCare::kFull;
      const detect::TagFit full = fit_tag(image.view(), guess, pattern);
      guess = {rough.corners, 1, guess.bends, rough.width, detect::SideCare::kAgain};
      const detect::TagFit again = fit_tag(image.view(), guess, pattern);
      ASSERT_EQ(rough.seen(), 4);
      ASSERT_EQ(full.seen(), 4);
      ASSERT_EQ(again.seen(), 4);
      EXPECT_TRUE(rough.is_rough);
      EXPECT_FALSE(full.is_rough || again.is_rough);
      EXPECT_LT(worst_distance(rough.corners, quad), 0.5);
      for (std::size_t i = 0; i < 4; ++i) {
        // What all pixels leave, whichever were taken. A fit does not depend on the guess: bits
        // beside a side that are thought to be a pixel off would move it by more than a sigma.
        EXPECT_NEAR(rough.sigma[i] / full.sigma[i], 1, 0.6);
        EXPECT_NEAR(again.sigma[i] / full.sigma[i], 1, 0.15);
        EXPECT_LT((again.corners[i] - full.corners[i]).norm(), 0.5 * full.sigma[i]);
        square += (full.corners[i] - quad[i]).squaredNorm() / 2 / std::pow(full.sigma[i], 2);
        ++count;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(square / count), 1, 0.15);
}

// The quads of a picture are found where its pixels are as large as those of a quarter of it: some
// corners are pixels off, and of their tags not all sides are found at once.
TEST(TagFits, OfQuadsThatAreFarOff) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Views views(kBoard, {1920, 1080}, 3, 2, 1);
  const auto detector = make_detector(views.board()).value();
  for (const int n : {1, 8}) {
    const Observation seen = detector->detect(views.picture(n).view()).observation;
    EXPECT_EQ(seen.ids, views.truth(n).ids) << n;
  }
}

// Single tags, of which there are too few for a map of the lens, and tags with bits outside of
// their borders: the errors of corners are what their sigmas say.
TEST(TagCorners, AreAsGoodAsTheySay) {
  if (!has_april_tag_3()) GTEST_SKIP() << "this build knows no families of AprilTag 3";
  for (const char* text : {"apriltag:tag36h11:80mm:0=0,0+3=180mm,-30mm,30",
                           "apriltag:tagStandard41h12:6x4:50mm:40mm"}) {
    const Views views(text, {1280, 720}, 6, kNoise, 0.7);
    const auto detector = make_detector(views.board()).value();
    double square = 0;
    int count = 0;
    for (int n = 0; n < 12; ++n) {
      const Observation truth = views.truth(n);
      const Observation seen = detector->detect(views.picture(n).view()).observation;
      for (std::size_t i = 0; i < seen.ids.size(); ++i) {
        const auto at = std::ranges::find(truth.ids, seen.ids[i]) - truth.ids.begin();
        const Pixel& is = truth.uv[static_cast<std::size_t>(at)];
        square += (std::pow(seen.uv[i].u - is.u, 2) + std::pow(seen.uv[i].v - is.v, 2)) / 2 /
                  std::pow(seen.sigma[i], 2);
        ++count;
      }
    }
    EXPECT_GT(count, 80) << text;
    EXPECT_NEAR(std::sqrt(square / count), 1, 0.25) << text;
  }
}

// A side that a rough fit has left where it is ends with its first step, which still mends the grey
// levels beside it: in a quiet picture, what they were before is many times the noise, and a corner
// of which so little seems to be known is not reported.
TEST(TagCorners, OfQuietPicturesAreAllReported) {
  if (!has_opencv_dictionaries()) GTEST_SKIP() << "this build knows no dictionary of markers";
  const Views views(kBoard, {1280, 720}, 7, 1, 1.2);
  const auto detector = make_detector(views.board()).value();
  for (int n = 0; n < 20; ++n) {
    const Observation seen = detector->detect(views.picture(n).view()).observation;
    EXPECT_EQ(seen.ids, views.truth(n).ids) << n;
    const auto [least, most] = std::ranges::minmax(seen.sigma);
    EXPECT_LT(most, 4 * least) << n;
  }
}

}  // namespace
}  // namespace calvin
