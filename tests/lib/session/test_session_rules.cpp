// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The numbers by which a session decides, from both sides of each limit, and what it shows of its
// views, on pictures of which every number can be worked out by hand.
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/session/session.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;

constexpr ImageSize kImage = {1200, 900};  // a diagonal of 1500 px
constexpr double kDiagonal = 1500;

// What a board of 9x6 looks like: the place of control point 0 and the ways to the next one, px.
struct Look {
  Pixel at = {400, 300};
  Pixel along = {40, 0};
  Pixel down = {0, 40};
  double left_longer = 1;  // how much longer the left edge is than the right one
  double top_longer = 1;
};

View look(const Look& l) {
  View view;
  view.board = kBoard;
  view.observation.board = kBoard.text();
  view.observation.image_size = kImage;
  // A homography of the four corners: the weights of the right and of the lower side.
  const double right = l.left_longer;
  const double lower = l.top_longer;
  for (int id = 0; id < 54; ++id) {
    const double a = id % 9 / 8.0;
    const double b = id / 9 / 5.0;
    const double w = 1 + (right - 1) * a + (lower - 1) * b;
    const Pixel p = {(8 * a * l.along.u + 5 * b * l.down.u) / w,
                     (8 * a * l.along.v + 5 * b * l.down.v) / w};
    view.observation.ids.push_back(id);
    view.observation.uv.push_back({l.at.u + p.u, l.at.v + p.v});
    view.observation.sigma.push_back(0);
  }
  return view;
}

View shifted(View view, double du, double dv) {
  for (Pixel& p : view.observation.uv) p = {p.u + du, p.v + dv};
  return view;
}

View timed(View view, double seconds) {
  view.observation.timestamp = static_cast<std::uint64_t>(std::lround(1e9 * seconds));
  return view;
}

TEST(Place, OfARectangle) {
  // 320 x 200 px from (400, 300): a square of the same area has a side of 252.98 px.
  const BoardFootprint p = footprint_of(look({})).value();
  const double side = std::sqrt(320.0 * 200);
  EXPECT_NEAR(p.x, (560 - side / 2) / (1200 - side), 1e-6);
  EXPECT_NEAR(p.y, (400 - side / 2) / (900 - side), 1e-6);
  EXPECT_NEAR(p.size, std::sqrt(320.0 * 200 / (1200 * 900)), 1e-6);
  EXPECT_NEAR(p.tilt, 0, 1e-6);
  EXPECT_NEAR(p.left_nearer, 0, 1e-6);
  EXPECT_NEAR(p.top_nearer, 0, 1e-6);
  // Turned, it is as square and as large.
  const BoardFootprint turned = footprint_of(look({{400, 300}, {30, 30}, {-30, 30}})).value();
  EXPECT_NEAR(turned.tilt, 0, 1e-6);
  EXPECT_NEAR(turned.size, std::sqrt(40 * 1800.0 / (1200 * 900)), 1e-6);
  // In a corner, and beyond the border.
  EXPECT_NEAR(footprint_of(look({{0, 0}})).value().x, (160 - side / 2) / (1200 - side), 1e-6);
  EXPECT_EQ(footprint_of(look({{880, 700}, {40, 0}, {0, 40}})).value().y, 1);
}

TEST(Place, OfAPartIsThatOfTheWholeBoard) {
  View part = look({});
  part.observation.ids.resize(18);
  part.observation.uv.resize(18);
  const BoardFootprint p = footprint_of(part).value();
  EXPECT_NEAR(p.size, std::sqrt(320.0 * 200 / (1200 * 900)), 1e-6);
  // But for its place, which is that of what is seen.
  const double side = std::sqrt(320.0 * 200);
  EXPECT_NEAR(p.y, (320 - side / 2) / (900 - side), 1e-6);
}

TEST(Place, SkewIsOfTheFarthestAngle) {
  const auto tilt_of = [](double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    return footprint_of(look({{400, 300}, {40, 0}, {40 * std::sin(angle), 40 * std::cos(angle)}}))
        .value()
        .tilt;
  };
  EXPECT_NEAR(tilt_of(10), 2 * 10 * std::numbers::pi / 180, 1e-6);
  EXPECT_NEAR(tilt_of(-20), 2 * 20 * std::numbers::pi / 180, 1e-6);
  EXPECT_NEAR(tilt_of(35), 1, 1e-6);
}

TEST(Place, TheNearerEdgeLooksLonger) {
  // The right edge is 1 / 1.25 of the left: (1 - 0.8) / (1 + 0.8).
  Look look_left;
  look_left.left_longer = 1.25;
  BoardFootprint p = footprint_of(look(look_left)).value();
  EXPECT_NEAR(p.left_nearer, 0.2 / 1.8, 1e-6);
  look_left.left_longer = 0.8;
  EXPECT_NEAR(footprint_of(look(look_left)).value().left_nearer, -0.25 / 2.25, 1e-6);
  Look look_top;
  look_top.top_longer = 1.25;
  p = footprint_of(look(look_top)).value();
  EXPECT_NEAR(p.top_nearer, 0.2 / 1.8, 1e-6);
}

TEST(Ranges, AreTheSpansOverWhatCounts) {
  ViewCoverage coverage;
  EXPECT_EQ(coverage.x() + coverage.y() + coverage.size() + coverage.tilt() + coverage.coverage(),
            0);
  const auto add = [&](const Look& l) {
    coverage.add(look(l));
    return footprint_of(look(l)).value();
  };
  const BoardFootprint a = add({{300, 300}});
  EXPECT_EQ(coverage.x(), 0);
  EXPECT_NEAR(coverage.size(), a.size / 0.4, 1e-9);
  const BoardFootprint b = add({{500, 350}, {44, 0}, {4, 40}});
  EXPECT_NEAR(coverage.x(), (b.x - a.x) / 0.7, 1e-9);
  EXPECT_NEAR(coverage.y(), (b.y - a.y) / 0.7, 1e-9);
  EXPECT_NEAR(coverage.size(), std::max(a.size, b.size) / 0.4, 1e-9);
  EXPECT_NEAR(coverage.tilt(), std::max(a.tilt, b.tilt) / 0.5, 1e-9);
  EXPECT_FALSE(coverage.spans_all());
}

// Of 16 by 12 cells, those of which the centre is inside.
TEST(Coverage, CountsCellsOnce) {
  ViewCoverage coverage;
  coverage.add(look({{260, 300}}));  // columns from 262 to 562, rows from 337 to 487 px
  EXPECT_NEAR(coverage.coverage(), 5 * 3 / 192.0, 1e-12);
  coverage.add(look({{260, 300}}));
  EXPECT_NEAR(coverage.coverage(), 5 * 3 / 192.0, 1e-12);
  coverage.add(look({{410, 300}}));  // two columns more
  EXPECT_NEAR(coverage.coverage(), 7 * 3 / 192.0, 1e-12);
  const CoverageMap map = coverage.map();
  ASSERT_EQ(map.columns, 16);
  ASSERT_EQ(map.rows(), 12);
  const Observation left = look({{260, 300}}).observation;
  const Observation right = look({{410, 300}}).observation;
  const ImageSize size = left.image_size;
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 16; ++column) {
      const double u = (column + 0.5) * size.width / 16;
      const double v = (row + 0.5) * size.height / 12;
      const bool inside = u > left.uv.front().u && u < right.uv.back().u && v > left.uv.front().v &&
                          v < left.uv.back().v;
      EXPECT_EQ(map.is_covered(column, row), inside) << column << ", " << row;
    }
  }
  EXPECT_EQ(std::ranges::count(map.covered, true), 7 * 3);
}

// Keeps `first`, then says what becomes of `then`, held still.
Reason after(const View& first, const View& then) {
  Session session({CaptureMode::kAuto, 3, 0});
  session.offer(first);
  EXPECT_EQ(session.offer(first), Reason::kAccepted);
  session.offer(then);
  return session.offer(then);
}

TEST(New, IsEightHundredthsOfTheDiagonalAway) {
  const View first = look({});
  EXPECT_EQ(after(first, shifted(first, 0.079 * kDiagonal, 0)), Reason::kTooSimilar);
  EXPECT_EQ(after(first, shifted(first, 0.081 * kDiagonal, 0)), Reason::kAccepted);
  EXPECT_EQ(after(first, shifted(first, 0, 0.079 * kDiagonal)), Reason::kTooSimilar);
  EXPECT_EQ(after(first, shifted(first, 0.048 * kDiagonal, -0.066 * kDiagonal)), Reason::kAccepted);
  // Another board may be in the same place.
  View other = first;
  other.board = Checkerboard{9, 6, 0.03};
  other.observation.board = other.board.text();
  EXPECT_EQ(after(first, other), Reason::kAccepted);
}

TEST(New, IsAnotherShapeByAFortiethOfItsSize) {
  const View first = look({});
  // A board that grows about its centre by a part: its corners move by that part of their mean
  // distance from it, and its size is the root of its own area.
  const auto grown = [](double part) {
    const double s = 40 * (1 + part);
    return look({{560 - 4 * s, 400 - 2.5 * s}, {s, 0}, {0, s}});
  };
  double mean = 0;
  for (int id = 0; id < 54; ++id) mean += 40 * std::hypot(id % 9 - 4, id / 9 - 2.5) / 54;
  // part * mean = 0.025 sqrt(320 200) (1 + part)
  const double unit = 0.025 * std::sqrt(320.0 * 200);
  const double limit = unit / (mean - unit);
  EXPECT_EQ(after(first, grown(0.98 * limit)), Reason::kTooSimilar);
  EXPECT_EQ(after(first, grown(1.02 * limit)), Reason::kAccepted);
}

TEST(New, IsAgainstEveryViewKept) {
  Session session({CaptureMode::kAuto, 3, 0});
  const View first = look({});
  const View second = shifted(first, 200, 0);
  for (const View& view : {first, first, second, second}) session.offer(view);
  ASSERT_EQ(session.views().size(), 2U);
  session.offer(first);
  EXPECT_EQ(session.offer(first), Reason::kTooSimilar);
}

TEST(Large, IsAHundredthOfThePicture) {
  const auto held = [](double square) {
    Session session({CaptureMode::kAuto, 3, 0});
    const View view = look({{400, 300}, {square, 0}, {0, square}});
    session.offer(view);
    return session.offer(view);
  };
  // 40 squares of s x s of 1080000 px: s = 16.43.
  EXPECT_EQ(held(16.4), Reason::kTooSmall);
  EXPECT_EQ(held(16.5), Reason::kAccepted);
}

TEST(Sharp, IsTwoPixelsOrAPartOfTheDiagonal) {
  const auto held = [](double blur, double scale) {
    Session session({CaptureMode::kAuto, 3, 0});
    View view = look({});
    view.observation.image_size = {static_cast<int>(1200 * scale), static_cast<int>(900 * scale)};
    view.observation.blur = blur;
    for (Pixel& p : view.observation.uv) p = {scale * p.u, scale * p.v};
    session.offer(view);
    return session.offer(view);
  };
  EXPECT_EQ(held(2.24, 1), Reason::kAccepted);  // 2.25 px
  EXPECT_EQ(held(2.26, 1), Reason::kBlurred);
  EXPECT_EQ(held(1.99, 0.5), Reason::kAccepted);
  EXPECT_EQ(held(2.01, 0.5), Reason::kBlurred);
}

// A tenth of a pixel while a frame is read out, which is the shortest time between two of them.
TEST(Still, IsATenthOfAPixelWhileAFrameIsReadOut) {
  const auto moved = [](double px, double seconds, double readout) {
    SessionOptions options{CaptureMode::kAuto, 3, 0};
    options.readout = readout;
    Session session(options);
    const View view = look({});
    session.offer(timed(shifted(view, 100, 100), 1.00));
    session.offer(timed(view, 1.04));  // 40 ms apart
    return session.offer(timed(shifted(view, px, 0), 1.04 + seconds));
  };
  EXPECT_EQ(moved(0.099, 0.04, 0), Reason::kAccepted);
  EXPECT_EQ(moved(0.101, 0.04, 0), Reason::kMoving);
  // In four times the time it may move four times as far.
  EXPECT_EQ(moved(0.39, 0.16, 0), Reason::kAccepted);
  EXPECT_EQ(moved(0.41, 0.16, 0), Reason::kMoving);
  // Read out in a quarter of it.
  EXPECT_EQ(moved(0.39, 0.04, 0.01), Reason::kAccepted);
  EXPECT_EQ(moved(0.41, 0.04, 0.01), Reason::kMoving);
}

// How long a frame takes is what the newest frames tell: neither one at a higher rate long ago, nor
// two that came in a burst.
TEST(Still, IsByTheRateOfTheFramesAtHand) {
  const View view = look({});
  Session slower({CaptureMode::kAuto, 3, 0});
  double now = 1;
  for (int i = 0; i < 60; ++i) slower.offer(timed(shifted(view, 100, 100), now += 0.01));
  for (int i = 0; i < 30; ++i) slower.offer(timed(shifted(view, 100, 100), now += 0.04));
  slower.offer(timed(view, now += 0.04));
  EXPECT_EQ(slower.offer(timed(shifted(view, 0.2, 0), now += 0.04)), Reason::kMoving);
  EXPECT_EQ(slower.offer(timed(shifted(view, 0.29, 0), now += 0.04)), Reason::kAccepted);
  Session burst({CaptureMode::kAuto, 3, 0});
  for (int i = 0; i < 10; ++i) burst.offer(timed(shifted(view, 100, 100), now += 0.04));
  burst.offer(timed(shifted(view, 100, 100), now += 0.0001));
  burst.offer(timed(view, now += 0.04));
  EXPECT_EQ(burst.offer(timed(shifted(view, 0.2, 0), now += 0.04)), Reason::kMoving);
}

// What the corners' sigmas explain of it is no motion.
TEST(Still, IsBesideTheNoiseOfTheCorners) {
  const auto moved = [](double px, double sigma) {
    Session session({CaptureMode::kAuto, 3, 0});
    View view = look({});
    view.observation.sigma.assign(54, sigma);
    session.offer(view);
    return session.offer(shifted(view, px, 0));
  };
  // px^2 less twice the variance of each of two places: 4 * 0.01 of 0.2236^2 leave 0.01.
  EXPECT_EQ(moved(0.223, 0.1), Reason::kAccepted);
  EXPECT_EQ(moved(0.225, 0.1), Reason::kMoving);
  // A sigma that no corner can have explains nothing.
  EXPECT_EQ(moved(0.225, 1e7), Reason::kMoving);
  EXPECT_EQ(moved(0.225, 1e200), Reason::kMoving);
}

TEST(Complete, AtTheLastViewOrWhereAllIsSpanned) {
  Session session({CaptureMode::kAll, 3, 0});
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(session.complete()) << i;
    session.offer(shifted(look({}), 0.1 * i, 0));
  }
  EXPECT_TRUE(session.complete());
  Session limited({CaptureMode::kAuto, 2, 3});
  for (int i = 0; i < 4; ++i) {
    const View view = shifted(look({}), 125 * i - 150, 0);
    limited.offer(view);
    EXPECT_EQ(limited.offer(view), i < 3 ? Reason::kAccepted : Reason::kTooSimilar);
    EXPECT_EQ(limited.complete(), i >= 2) << i;
  }
  EXPECT_EQ(limited.views().size(), 3U);
  // Those that were kept first.
  EXPECT_EQ(limited.views().back()->observation.uv.front().u, 500);
  EXPECT_TRUE(limited.remove_view(0));
  EXPECT_EQ(limited.views().front()->observation.uv.front().u, 375);
  EXPECT_FALSE(limited.complete());
}

TEST(Reset, ForgetsAll) {
  Session session({CaptureMode::kAuto, 1, 0});
  const View view = look({});
  session.offer(timed(view, 1));
  EXPECT_EQ(session.offer(timed(view, 1.01)), Reason::kAccepted);
  session.capture_next();
  session.reset();
  const Progress none = session.progress();
  EXPECT_EQ(none.views + none.coverage + none.x + none.y + none.size + none.tilt, 0);
  EXPECT_EQ(none.hint, Session().progress().hint);
  EXPECT_FALSE(session.complete());
  // Nor does it know what was before, that a view was asked for, or how long a frame takes.
  EXPECT_EQ(session.offer(timed(view, 2)), Reason::kMoving);
  EXPECT_EQ(session.offer(timed(shifted(view, 0.15, 0), 2.02)), Reason::kMoving);
}

TEST(Usable, SixCorners) {
  for (const std::size_t count : {5U, 6U}) {
    Session session({CaptureMode::kAll, 3, 0});
    View view = look({});
    view.observation.ids.resize(count);
    view.observation.uv.resize(count);
    EXPECT_EQ(session.offer(view), count < 6 ? Reason::kTooFewPoints : Reason::kAccepted);
  }
}

}  // namespace
}  // namespace calvin
