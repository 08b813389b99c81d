// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Several boards in one picture: equal ones, ones of other sizes, ones that are partly hidden.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/detect/checkerboard/sheets/sheet.hpp"
#include "calvin/detect/detector.hpp"
#include "calvin/geometry/convex_hull.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;

constexpr std::uint64_t kFrame = 33'333'333;  // ns
const Board kLarger = Checkerboard{10, 7, 0.025};
const Board kSmall = Checkerboard{5, 4, 0.03};

// What a camera sees that looks at several sheets.
class Table : public ::testing::Test {
 protected:
  struct Sheet {
    Board board;
    SE3 pose;
  };

  // Later sheets lie upon earlier ones.
  GrayImage picture(const std::vector<Sheet>& sheets, std::uint64_t seed = 1) const {
    RenderOptions options{.noise = 2, .blur = 0.8, .seed = seed};
    GrayImage image(camera_.image_size().width, camera_.image_size().height, 128);
    for (const Sheet& sheet : sheets) {
      options.background = 0;
      const GrayImage on_black = renderer_.render(sheet.board, sheet.pose, options);
      options.background = 255;
      const GrayImage on_white = renderer_.render(sheet.board, sheet.pose, options);
      for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        if (on_white.pixels[i] - on_black.pixels[i] < 128) image.pixels[i] = on_black.pixels[i];
      }
    }
    return image;
  }

  // A pose whose middle of the board lies at (x, y) m in a plane `z` m off.
  static SE3 at(const Board& board, double x, double y, double z, const Eigen::Vector3d& turn) {
    const BoardArea area = board.extent();
    const Eigen::Vector3d middle((area.left + area.right) / 2, (area.top + area.bottom) / 2, 0);
    const Eigen::Matrix3d rotation = exp_so3(turn);
    return {rotation, Eigen::Vector3d(x, y, z) - rotation * middle};
  }

  // The largest distance of a corner from the truth, px; of none where it is another sheet.
  double error(const Detection& d, const Sheet& sheet) const {
    const Observation truth = true_observation(camera_, sheet.board, sheet.pose);
    double most = d.observation.found() ? 0 : HUGE_VAL;
    for (std::size_t i = 0; i < d.observation.ids.size(); ++i) {
      const auto it = std::find(truth.ids.begin(), truth.ids.end(), d.observation.ids[i]);
      if (it == truth.ids.end()) return HUGE_VAL;
      const Pixel p = truth.uv[static_cast<std::size_t>(it - truth.ids.begin())];
      most = std::max(most, std::hypot(d.observation.uv[i].u - p.u, d.observation.uv[i].v - p.v));
    }
    return most;
  }

  Camera camera_ = default_camera({1280, 960});
  BoardRenderer renderer_{camera_};
};

TEST_F(Table, TwoEqualBoardsAreTwoObservationsEachWithItsOwnGrid) {
  const auto detector = make_detector(kBoard).value();
  scenes::Random random(4);
  const int pictures = scenes::full_count() ? 200 : 10;
  for (int n = 0; n < pictures; ++n) {
    const auto draw = [&](double most) { return scenes::uniform(random, -most, most); };
    const auto turn = [&] { return Eigen::Vector3d(draw(0.4), draw(0.4), draw(0.4)); };
    const double z = 0.8 + draw(0.15);
    const Sheet one = {kBoard, at(kBoard, -0.2 * z / 0.65, draw(0.08), z, turn())};
    const Sheet two = {kBoard, at(kBoard, 0.2 * z / 0.65, draw(0.08), z + draw(0.02), turn())};
    const auto seen = detector->detect_all(picture({one, two}, n).view());
    ASSERT_EQ(seen.size(), 2u) << n;
    const bool swapped = error(seen[0], one) > 0.3;
    EXPECT_LT(error(seen[0], swapped ? two : one), 0.3) << n;
    EXPECT_LT(error(seen[1], swapped ? one : two), 0.3) << n;
    for (const Detection& d : seen) {
      EXPECT_EQ(d.observation.ids.size(), 54u) << n;
      EXPECT_EQ(d.observation.board, kBoard.text());
      EXPECT_EQ(d.board, 0u);
    }
  }
}

// Three times as far away, a sheet is seen in a finer level only.
TEST_F(Table, ABoardThatIsListedTwiceIsLookedForUntilBothSheetsAreFound) {
  const auto detector = make_detector(std::vector<Board>{kBoard, kBoard}).value();
  const Sheet near = {kBoard, at(kBoard, -0.12, 0, 0.5, {0.2, 0.1, 0})};
  const Sheet far = {kBoard, at(kBoard, 0.55, -0.2, 1.5, {-0.2, 0.2, 0.3})};
  const auto seen = detector->detect_all(picture({near, far}).view());
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_LT(std::min(error(seen[0], near), error(seen[1], near)), 0.3);
  EXPECT_LT(std::min(error(seen[0], far), error(seen[1], far)), 0.3);
  EXPECT_EQ(seen[0].board + seen[1].board, 1u);
}

TEST_F(Table, BoardsOfThreeSizesOneOfThemPartlyHidden) {
  const std::vector<Board> list = {kSmall, kLarger, kBoard};
  const auto detector = make_detector(list).value();
  const std::vector<Sheet> sheets = {
      {kSmall, at(kSmall, -0.28, -0.2, 0.8, {0.2, 0, 0.4})},
      {kLarger, at(kLarger, 0.22, -0.12, 0.9, {0, 0.3, 0.1})},
      {kBoard, at(kBoard, -0.18, 0.16, 0.85, {-0.3, 0.1, -0.2})},
  };
  GrayImage image = picture(sheets);
  // A card upon the corner of the larger board.
  const Pixel corner = true_observation(camera_, kLarger, sheets[1].pose).uv[0];
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (std::hypot(x - corner.u, y - corner.v) < 60) image.row(y)[x] = 100;
    }
  }
  const auto seen = detector->detect_all(image.view());
  ASSERT_EQ(seen.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(seen[i].board, i);
    EXPECT_EQ(seen[i].observation.board, list[i].text());
    EXPECT_LT(error(seen[i], sheets[i]), 0.3) << list[i].text();
  }
  EXPECT_LT(seen[1].observation.ids.size(), 69u);
  EXPECT_GT(seen[1].observation.ids.size(), 50u);
}

// A 9x6 board could be a part of a 10x7 board, and a 10x7 board shows one of 9x6: each is the board
// that leaves nothing to be excused.
// A checkerboard and AprilGrids of two spacings, one of them by its first tag: each is what its
// place in the list says.
TEST_F(Table, BoardsWhoseLinesAreSpacedUnlikeEachOther) {
  std::vector<Board> boards = {kSmall};
  for (const char* text :
       {"aprilgrid:3x3:40mm:0.3", "aprilgrid:3x3:40mm:0.5", "aprilgrid:3x3:40mm:0.3:first=9"}) {
    const auto board = parse_board(text);
    if (!board) GTEST_SKIP() << "this build knows no dictionary of markers";
    boards.push_back(*board);
  }
  std::vector<Sheet> sheets;
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const double x = i % 2 == 0 ? -0.15 : 0.15;
    const double y = i < 2 ? -0.11 : 0.11;
    sheets.push_back({boards[i], at(boards[i], x, y, 0.6, {0.1, -0.1, 0.2 * (i + 1.0)})});
  }
  const auto detector = make_detector(boards).value();
  for (const bool followed : {false, true}) {
    const GrayImage image = picture(sheets);
    const auto seen =
        followed ? detector->follow_all(image.view(), kFrame) : detector->detect_all(image.view());
    ASSERT_EQ(seen.size(), boards.size());
    for (std::size_t i = 0; i < boards.size(); ++i) {
      EXPECT_EQ(seen[i].board, i);
      EXPECT_EQ(seen[i].observation.board, boards[i].text());
      EXPECT_EQ(seen[i].observation.ids.size(), boards[i].ids().size()) << boards[i].text();
      EXPECT_LT(error(seen[i], sheets[i]), 0.3) << boards[i].text();
    }
  }
}

TEST_F(Table, ABoardIsNotTakenForAPartOfALargerOne) {
  for (const bool larger_first : {true, false}) {
    const std::vector<Board> list =
        larger_first ? std::vector<Board>{kLarger, kBoard} : std::vector<Board>{kBoard, kLarger};
    const auto detector = make_detector(list).value();
    for (int n = 0; n < 6; ++n) {
      const Board& shown = n % 2 == 0 ? kBoard : kLarger;
      const Sheet sheet = {shown, at(shown, 0.02 * n, -0.02 * n, 0.6, {0.1 * n, 0.3, 0.1 * n})};
      for (const Detection& d : detector->detect_all(picture({sheet}).view())) {
        const bool is_it = list[d.board] == shown;
        EXPECT_EQ(d.observation.found(), is_it) << n;
        EXPECT_EQ(d.reason, is_it ? Reason::kAccepted : Reason::kNotFound) << n;
        if (is_it) {
          EXPECT_LT(error(d, sheet), 0.3) << n;
        }
      }
    }
  }
}

// An arm across a sheet leaves two parts of one board, which are no two sheets of it.
TEST_F(Table, WhatIsLeftOnBothSidesOfAnArmIsOneSheet) {
  for (const std::size_t listed : {1u, 2u}) {
    const auto detector = make_detector(std::vector<Board>(listed, kBoard)).value();
    for (int n = 0; n < 8; ++n) {
      const Sheet sheet = {kBoard, at(kBoard, 0, 0, 0.45, {0.05 * n, 0.2, 0.04 * n})};
      GrayImage image = picture({sheet});
      const Observation truth = true_observation(camera_, kBoard, sheet.pose);
      const double middle = truth.uv[22].u + 6 * n - 20;
      for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
          if (std::abs(x - middle + 0.2 * (y - 480)) < 40 + 4 * n) image.row(y)[x] = 90;
        }
      }
      int found = 0;
      for (const Detection& d : detector->detect_all(image.view())) {
        found += d.observation.found() ? 1 : 0;
      }
      EXPECT_LE(found, 1) << n;
    }
  }
}

// Two sheets go round each other; each keeps its place among the results.
TEST_F(Table, SheetsThatSwapPlacesAreFollowedEach) {
  const int frames = scenes::full_count() ? 46 : 27;  // a whole turn, and half of one
  for (const std::size_t listed : {1u, 2u}) {
    const auto detector = make_detector(std::vector<Board>(listed, kBoard)).value();
    std::size_t first = 0;
    for (int n = 0; n < frames; ++n) {
      const double angle = 4.0 * n * std::numbers::pi / 180;
      const double x = 0.21 * std::cos(angle);
      const double y = 0.21 * std::sin(angle);
      const Sheet sheets[] = {{kBoard, at(kBoard, -x, -y, 0.9, {0.1, 0.2, 0})},
                              {kBoard, at(kBoard, x, y, 0.9, {-0.2, 0.1, 0})}};
      const auto seen = detector->follow_all(picture({sheets[0], sheets[1]}, n).view(),
                                             static_cast<std::uint64_t>(n) * kFrame);
      ASSERT_EQ(seen.size(), 2u) << n;
      if (n == 0) first = error(seen[0], sheets[0]) < 0.3 ? 0 : 1;
      EXPECT_LT(error(seen[0], sheets[first]), 0.3) << n;
      EXPECT_LT(error(seen[1], sheets[1 - first]), 0.3) << n;
    }
  }
}

TEST_F(Table, ASheetThatLeavesTakesNoOtherAlong) {
  for (const std::size_t listed : {1u, 2u}) {
    const auto detector = make_detector(std::vector<Board>(listed, kBoard)).value();
    for (int n = 0; n < 12; ++n) {
      const Sheet leaves = {kBoard, at(kBoard, -0.25, -0.05, 0.8, {0.1, 0.2, 0})};
      const Sheet stays = {kBoard, at(kBoard, 0.15 + 0.003 * n, 0.05, 0.8, {-0.2, 0.1, 0})};
      const bool both = n < 5 || n > 8;
      const auto seen = detector->follow_all(
          picture(both ? std::vector{leaves, stays} : std::vector{stays}, n).view(),
          static_cast<std::uint64_t>(n) * kFrame);
      if (both && (listed == 2 || n < 5)) {
        ASSERT_EQ(seen.size(), 2u) << n;
        EXPECT_LT(error(seen[0], leaves), 0.3) << n;
        EXPECT_LT(error(seen[1], stays), 0.3) << n;
      } else if (!both) {
        // A place of the list stays empty; what nobody asked for has none.
        ASSERT_EQ(seen.size(), listed) << n;
        EXPECT_LT(error(seen.back(), stays), 0.3) << n;
        if (listed == 2) {
          EXPECT_EQ(seen[0].reason, Reason::kNotFound) << n;
        }
      }
    }
  }
}

// However long a board is, its outline is about half a square larger, where the printed squares at
// its border end: beyond that there may be another sheet.
TEST(Outlines, AreHalfASquareLargerAlongBothSides) {
  constexpr double kSquare = 30;  // px
  const Grid board = {12, 3, 0.03};
  Observation corners;
  for (const int id : board.ids()) {
    const GridPlace place = board.place(id);
    corners.ids.push_back(id);
    corners.uv.push_back({kSquare * place.col, kSquare * place.row});
  }
  const auto outline = detect::outline_of(corners, board);
  for (const auto& [u, v, within] : {std::tuple{-0.55, 1.0, true},
                                     {-0.65, 1.0, false},
                                     {11.55, 1.0, true},
                                     {11.65, 1.0, false},
                                     {5.0, -0.55, true},
                                     {5.0, 2.65, false}}) {
    EXPECT_EQ(contains(outline, {kSquare * u, kSquare * v}), within) << u << ", " << v;
  }
}

TEST(ListOfBoards, IsNotEmpty) {
  const auto made = make_detector(std::vector<Board>{});
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, ErrorCode::kInvalidArgument);
}

// The next board begins two squares behind the end of a long one.
TEST_F(Table, AShortBoardBehindALongOneIsNoPartOfIt) {
  const Board kLong = Checkerboard{12, 3, 0.03};
  const Board kShort = Checkerboard{4, 3, 0.03};
  const Sheet sheets[] = {{kLong, at(kLong, -0.12, 0, 0.75, {0.1, 0.1, 0})},
                          {kShort, at(kShort, 0.153, 0, 0.75, {0.1, 0.1, 0})}};
  const auto detector = make_detector(std::vector{kLong, kShort}).value();
  const auto seen = detector->detect_all(picture({sheets[0], sheets[1]}).view());
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_LT(error(seen[0], sheets[0]), 0.3);
  EXPECT_LT(error(seen[1], sheets[1]), 0.3);
}

// A frame of which nothing is there, where sheets of the last one are followed.
TEST_F(Table, AFrameWithoutPixelsShowsNoBoard) {
  const Sheet sheet = {kBoard, at(kBoard, 0, 0, 0.6, {0.1, 0.2, 0})};
  const auto detector = make_detector(kBoard).value();
  const GrayImage image = picture({sheet});
  for (std::uint64_t n = 0; n < 2; ++n) {
    EXPECT_TRUE(detector->follow(image.view(), n * kFrame).observation.found());
  }
  ImageView nothing = image.view();
  nothing.data = nullptr;
  EXPECT_EQ(detector->follow(nothing, 2 * kFrame).reason, Reason::kNotFound);
  EXPECT_TRUE(detector->follow(image.view(), 3 * kFrame).observation.found());
}

}  // namespace
}  // namespace calvin
