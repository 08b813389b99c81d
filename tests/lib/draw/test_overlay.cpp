// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The overlay's tiles: where they are, what they show, what they cost.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/draw/overlay.hpp"
#include "calvin/target/board.hpp"
#include "calvin_config.h"

namespace calvin {
namespace {

TEST(OverlayCaption, SaysWhatIsKnown) {
  Progress progress;
  EXPECT_EQ(overlay_caption(progress), "");
  progress.hint = "show the board";
  EXPECT_EQ(overlay_caption(progress), "show the board");
  progress.views = 1;
  EXPECT_EQ(overlay_caption(progress), "show the board (1 view)");
  progress.views = 12;
  progress.rms = 0.184;
  EXPECT_EQ(overlay_caption(progress), "show the board (12 views, rms 0.18 px)");
  progress.expected_error = 0.18;
  EXPECT_EQ(overlay_caption(progress), "show the board (12 views, accurate to 0.36 px)");
  // The board has not been everywhere.
  progress.expected_error_anywhere = 0.5;
  EXPECT_EQ(overlay_caption(progress), "show the board (12 views, accurate to 0.36 px)");
  progress.expected_error_anywhere = 23.87;
  EXPECT_EQ(
      overlay_caption(progress),
      "show the board (12 views, accurate to 0.36 px where the board was, 47.7 px elsewhere)");
  progress.expected_error_anywhere = 154;
  EXPECT_EQ(
      overlay_caption(progress),
      "show the board (12 views, accurate to 0.36 px where the board was, unknown elsewhere)");
  progress.expected_error_anywhere = 23.87;
  progress.wanted_error_anywhere = 0.15;
  EXPECT_EQ(overlay_caption(progress),
            "show the board (12 views, accurate to 0.36 px where the board was, 47.7 px elsewhere; "
            "0.30 px is wanted there)");
  // What is better than that is enough.
  progress.expected_error = 0.01;
  progress.expected_error_anywhere = 0.0438;
  EXPECT_EQ(
      overlay_caption(progress),
      "show the board (12 views, accurate to 0.02 px where the board was, 0.09 px elsewhere)");
  progress.hint.clear();
  progress.expected_error = std::nan("");
  EXPECT_EQ(overlay_caption(progress), "12 views, rms 0.18 px");
}

// A meta may hold a text of any length, and words are laid out for each frame.
TEST(OverlayCaption, IsNoLongerThanAnybodyReads) {
  Progress progress;
  progress.views = 12;
  for (int i = 0; i < 1000000; ++i) progress.hint += "\u00e4";
  const std::string caption = overlay_caption(progress);
  EXPECT_LT(caption.size(), 600u);
  EXPECT_TRUE(caption.starts_with("\u00e4\u00e4")) << caption;
  EXPECT_TRUE(caption.ends_with("\u00e4... (12 views)")) << caption;
}

#if CALVIN_HAVE_CAIRO

// A board parallel to the image, its control point 0 at (u, v), `pitch` px from point to point.
Observation flat_board(ImageSize size, double u, double v, double pitch) {
  Observation o;
  o.board = "checkerboard:9x6:25mm";
  o.image_size = size;
  for (int id = 0; id < 54; ++id) {
    o.ids.push_back(id);
    o.uv.push_back({u + pitch * (id % 9), v + pitch * std::floor(id / 9.0)});
    o.sigma.push_back(0.1);
  }
  return o;
}

// The tiles on a transparent frame. Counts how often a pixel is covered, which must be once.
struct Picture {
  explicit Picture(ImageSize s)
      : size(s), pixels(static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height)) {}

  void place(const OverlayTile& tile) {
    ASSERT_GT(tile.width, 0);
    ASSERT_GT(tile.height, 0);
    ASSERT_GE(tile.x, 0);
    ASSERT_GE(tile.y, 0);
    ASSERT_EQ(tile.x % 4, 0);
    ASSERT_EQ(tile.y % 4, 0);
    ASSERT_LE(tile.x + tile.width, size.width);
    ASSERT_LE(tile.y + tile.height, size.height);
    ASSERT_EQ(tile.pixels.size(), static_cast<std::size_t>(4 * tile.width * tile.height));
    for (int y = 0; y < tile.height; ++y) {
      for (int x = 0; x < tile.width; ++x) {
        Argb& pixel = at(tile.x + x, tile.y + y);
        ASSERT_FALSE(pixel.covered) << "two tiles at " << tile.x + x << ", " << tile.y + y;
        const auto* p = &tile.pixels[static_cast<std::size_t>(4 * (y * tile.width + x))];
        std::uint32_t value = 0;
        std::copy_n(p, 4, reinterpret_cast<std::uint8_t*>(&value));
        pixel = {value >> 24, value >> 16 & 255, value >> 8 & 255, value & 255, true};
        ASSERT_LE(std::max({pixel.red, pixel.green, pixel.blue}), pixel.alpha) << "premultiplied";
        ++covered;
      }
    }
  }

  struct Argb {
    unsigned alpha = 0;
    unsigned red = 0;
    unsigned green = 0;
    unsigned blue = 0;
    bool covered = false;
  };
  Argb& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                  static_cast<std::size_t>(x)];
  }
  Argb& near(double u, double v) {
    return at(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
  }

  ImageSize size;
  std::vector<Argb> pixels;
  std::size_t covered = 0;
};

Picture drawn(ImageSize size, const std::vector<Observation>& observations,
              const std::optional<Progress>& progress = {}) {
  Picture picture(size);
  const auto tiles = draw_overlay(size, observations, progress);
  EXPECT_TRUE(tiles.has_value());
  for (const OverlayTile& tile : *tiles) picture.place(tile);
  return picture;
}

TEST(Overlay, NothingToDrawIsNoTile) {
  EXPECT_TRUE(draw_overlay({640, 480}, {}, {})->empty());
  EXPECT_TRUE(draw_overlay({640, 480}, std::vector<Observation>(3), {})->empty());
}

// Boards of four corners, one beside the other.
std::vector<Observation> many_boards(int count) {
  std::vector<Observation> boards;
  for (int n = 0; n < count; ++n) {
    Observation o;
    o.board = "checkerboard:3x2:25mm";
    o.image_size = {1920, 1080};
    const Pixel at = {10.0 + n % 60 * 30, 10.0 + n / 60 % 35 * 30};
    o.ids = {0, 1, 3, 4};
    o.uv = {at, {at.u + 12, at.v}, {at.u, at.v + 12}, {at.u + 12, at.v + 12}};
    boards.push_back(o);
  }
  return boards;
}

// Who writes a meta may write anything into it, and the stream waits for what is drawn.
TEST(Overlay, DrawsNoMoreBoardsThanOneFrameCanShow) {
  const ImageSize size{1920, 1080};
  const std::vector<Observation> boards = many_boards(2000);
  Picture picture = drawn(size, boards);
  int shown = 0;
  for (const Observation& board : boards) {
    shown += picture.near(board.uv[0].u, board.uv[0].v).alpha > 150 ? 1 : 0;  // a disc
  }
  EXPECT_EQ(shown, 64);
  EXPECT_EQ(picture.near(boards[64].uv[0].u, boards[64].uv[0].v).alpha, 0u);
}

TEST(Overlay, DrawsNoMoreCornersThanOneFrameCanShow) {
  const ImageSize size{1920, 1080};
  Observation crowd;
  crowd.board = "checkerboard:100x100:25mm";
  crowd.image_size = size;
  for (int id = 0; id < 10000; ++id) {
    crowd.ids.push_back(id);
    crowd.uv.push_back({10.0 + id % 100 * 15, 10.0 + id / 100 * 10});
  }
  Picture picture = drawn(size, {crowd, flat_board(size, 1600, 500, 20)});
  const auto row_is_drawn = [&](int row) {
    return picture.near(10.0 + 50.5 * 15, 10.0 + row * 10).alpha > 150;  // between two corners
  };
  for (int row = 0; row < 100; ++row) EXPECT_EQ(row_is_drawn(row), row < 20) << row;
  EXPECT_EQ(picture.near(1600, 500).alpha, 0u);
}

TEST(Overlay, MarksEveryCornerAndJoinsTheRows) {
  const ImageSize size{641, 479};
  const Observation board = flat_board(size, 100, 100, 40);
  Picture picture = drawn(size, {board});
  for (int id = 1; id < 54; ++id) {
    const Pixel at = board.uv[static_cast<std::size_t>(id)];
    double most = 0;
    for (const double r : {3.0, 4.0, 4.5, 5.0}) {
      most = std::max(most, double{0} + picture.near(at.u, at.v - r).alpha);
    }
    EXPECT_GT(most, 150) << "no circle around corner " << id;
    EXPECT_EQ(picture.near(at.u + 20, at.v).alpha > 150, id % 9 != 8) << "right of corner " << id;
    EXPECT_EQ(picture.near(at.u, at.v + 20).alpha, 0u) << "below corner " << id;
  }
}

TEST(Overlay, ColoursFollowTheOrder) {
  const ImageSize size{640, 480};
  const Observation board = flat_board(size, 100, 100, 40);
  Picture picture = drawn(size, {board});
  const auto first = picture.near(120, 100);
  const auto middle = picture.near(100 + 6.5 * 40, 100 + 2 * 40);
  const auto last = picture.near(100 + 7.5 * 40, 100 + 5 * 40);
  EXPECT_GT(first.red, 2 * first.blue);
  EXPECT_GT(middle.green, 2 * middle.red);
  EXPECT_GT(last.blue, 2 * last.green);
}

TEST(Overlay, CornerZeroTellsWhetherItIsCertain) {
  const ImageSize size{640, 480};
  Observation board = flat_board(size, 100, 100, 40);
  EXPECT_EQ(drawn(size, {board}).at(100, 100).alpha, 255u);
  EXPECT_EQ(drawn(size, {board}).at(140, 100).alpha, 0u) << "the corner itself stays visible";
  board.ambiguous = {{2}};
  EXPECT_EQ(drawn(size, {board}).at(100, 100).alpha, 0u);
}

TEST(Overlay, CornersScaleWithTheFrame) {
  Observation board = flat_board({1280, 960}, 200, 200, 80);
  Picture picture = drawn({640, 480}, {board});
  EXPECT_EQ(picture.near(0.5 * 200.5 - 0.5, 0.5 * 200.5 - 0.5).alpha, 255u);
  EXPECT_EQ(picture.near(200, 200).alpha, 0u);
}

// A pixel of an observation of a quarter of the size covers four by four: its middle is at 1.5.
TEST(Overlay, CornersAreInTheMiddleOfTheirPixels) {
  Observation board = flat_board({160, 120}, 25, 20, 10);
  Picture picture = drawn({640, 480}, {board});
  double sum = 0;
  double u = 0;
  double v = 0;
  for (int y = 70; y < 95; ++y) {
    for (int x = 90; x < 115; ++x) {
      const double alpha = picture.at(x, y).alpha;
      sum += alpha;
      u += alpha * x;
      v += alpha * y;
    }
  }
  // The line to the next corner pulls to the right.
  EXPECT_GT(u / sum, 101);
  EXPECT_NEAR(v / sum, 81.5, 0.25);
}

TEST(Overlay, TheCostIsBounded) {
  const ImageSize size{1920, 1080};
  const double pixels = 1920.0 * 1080.0;
  Progress progress;
  EXPECT_LT(drawn(size, {flat_board(size, 200, 200, 80)}, progress).covered, 0.15 * pixels);
  progress.captured = true;
  EXPECT_LT(drawn(size, {flat_board(size, 100, 100, 180)}, progress).covered, 0.25 * pixels);
}

TEST(Overlay, BarsAreAsLongAsTheirValues) {
  const ImageSize size{640, 480};
  const auto bright = [&](double value) {
    Progress progress;
    progress.x = value;
    Picture picture = drawn(size, {}, progress);
    const auto opaque = [](const Picture::Argb& p) { return p.alpha > 250 && p.blue < 100; };
    return std::count_if(picture.pixels.begin(), picture.pixels.end(), opaque);
  };
  EXPECT_EQ(bright(0), 0);
  EXPECT_EQ(bright(std::nan("")), 0);
  EXPECT_EQ(bright(-3), 0);
  const auto full = static_cast<double>(bright(1));
  EXPECT_GT(full, 200);
  EXPECT_NEAR(static_cast<double>(bright(0.5)), full / 2, 0.05 * full);
  EXPECT_EQ(static_cast<double>(bright(7)), full);
}

// The inset is a small picture: what lies where in it is covered there.
TEST(Overlay, TheMapShowsWhatWasCovered) {
  const ImageSize size{640, 480};
  Progress progress;
  progress.coverage_map.columns = 0;
  const OverlayBox panel = overlay_panel_box(size, progress, PanelSide::kLeft);
  const int right = panel.x + panel.width;
  const int middle = panel.x + panel.width / 2;
  const auto greens = [&](int left, int top, int to_right, int bottom) {
    Picture picture = drawn(size, {}, progress);
    int count = 0;
    for (int y = top; y < bottom; ++y) {
      for (int x = left; x < to_right; ++x) {
        const auto& p = picture.at(x, y);
        count += p.alpha > 250 && p.green > 200 && p.red < 100 ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(greens(0, 0, 640, 480), 0);
  progress.coverage_map = {4, std::vector<bool>(12, false)};
  EXPECT_EQ(greens(0, 0, 640, 480), 0);
  progress.coverage_map.covered.assign(12, true);
  const int all = greens(0, 0, 640, 480);
  EXPECT_GT(all, 4000);
  EXPECT_EQ(greens(0, 0, right, 200), all) << "it is in the panel";
  progress.coverage_map.covered.assign(12, false);
  progress.coverage_map.covered[0] = progress.coverage_map.covered[1] = true;
  const int two = greens(0, 0, 640, 480);
  EXPECT_NEAR(two, all / 6.0, 0.1 * all / 6.0);
  // From the left edge to the middle of the panel, and in its upper third.
  EXPECT_EQ(greens(0, 0, middle + 2, 480), two);
}

// Which corner of the outline is the board's first one.
TEST(Overlay, TheGhostSaysWhichWayRoundItIs) {
  const ImageSize size{640, 480};
  Progress progress;
  const std::vector<Pixel> corners = {{0.4, 0.4}, {0.7, 0.4}, {0.7, 0.8}, {0.4, 0.8}};
  for (std::size_t first = 0; first < 4; ++first) {
    progress.ghost.clear();
    for (std::size_t i = 0; i < 4; ++i) progress.ghost.push_back(corners[(first + i) % 4]);
    Picture picture = drawn(size, {}, progress);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& at =
          picture.at(static_cast<int>(640 * corners[i].u), static_cast<int>(480 * corners[i].v));
      EXPECT_EQ(at.red > 200 && at.green < 150, i == first) << first << ", " << i;
    }
  }
}

TEST(Overlay, PartsAreLeftOut) {
  const ImageSize size{640, 480};
  Progress progress;
  progress.x = 1;
  progress.ghost = {{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}};
  const auto covered = [&](const OverlayParts& parts) {
    Picture picture(size);
    const auto tiles = draw_overlay(size, {}, progress, parts);
    EXPECT_TRUE(tiles.has_value());
    for (const OverlayTile& tile : *tiles) picture.place(tile);
    return std::pair(picture.at(30, 30).alpha > 0, picture.at(256, 240).alpha > 0);
  };
  EXPECT_EQ(covered({}), std::pair(true, true));
  EXPECT_EQ(covered({.ghost = false}), std::pair(true, false));
  EXPECT_EQ(covered({.coverage = false}), std::pair(false, true));
  EXPECT_EQ(covered({.ghost = false, .coverage = false}), std::pair(false, false));
}

TEST(Overlay, ATakenViewFlashesTheBorder) {
  const ImageSize size{640, 480};
  Progress progress;
  EXPECT_EQ(drawn(size, {}, progress).at(320, 1).alpha, 0u);
  progress.captured = true;
  Picture picture = drawn(size, {}, progress);
  for (const auto& [x, y] : std::vector<std::array<int, 2>>{
           {0, 0}, {639, 0}, {0, 479}, {639, 479}, {320, 1}, {320, 478}, {1, 240}, {638, 240}}) {
    EXPECT_EQ(picture.at(x, y).alpha, 255u) << x << ", " << y;
    EXPECT_GT(std::min(picture.at(x, y).green, picture.at(x, y).red), 250U) << x << ", " << y;
  }
  EXPECT_EQ(picture.at(320, 240).alpha, 0u);
}

TEST(Overlay, StrangeInputDrawsNothingStrange) {
  const double inf = std::numeric_limits<double>::infinity();
  Observation wild = flat_board({640, 480}, 100, 100, 40);
  wild.uv[3] = {std::nan(""), 5};
  wild.uv[4] = {inf, -inf};
  wild.uv[5] = {1e300, 1e300};
  wild.uv[6] = {-30, -40};
  wild.ids[7] = std::numeric_limits<int>::min();
  wild.ids[8] = std::numeric_limits<int>::max();
  wild.ids.resize(20);
  Progress progress;
  progress.captured = true;
  progress.coverage_map = {7, std::vector<bool>(13, true)};  // less than two rows
  for (const ImageSize size : {ImageSize{640, 480}, ImageSize{16, 16}, ImageSize{17, 2000},
                               ImageSize{1, 1}, ImageSize{0, 0}, ImageSize{-5, 480}}) {
    for (const char* board : {"checkerboard:9x6:25mm", "", "checkerboard:2x200:1mm", "nonsense"}) {
      wild.board = board;
      const auto tiles = draw_overlay(size, std::vector{wild}, progress);
      ASSERT_TRUE(tiles.has_value());
      Picture picture({std::max(size.width, 0), std::max(size.height, 0)});
      for (const OverlayTile& tile : *tiles) picture.place(tile);
    }
  }
}

#else

TEST(Overlay, SaysThatThisBuildCannot) {
  EXPECT_EQ(draw_overlay({640, 480}, {}, {}).error().code, ErrorCode::kUnsupported);
}

#endif

}  // namespace
}  // namespace calvin
