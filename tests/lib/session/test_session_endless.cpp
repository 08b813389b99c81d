// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Streams that go on for hours: the views that are kept are few, and different.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <iostream>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include <unistd.h>

#include "calvin/session/views/view_spacing.hpp"
#include "session_fixture.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

double resident_megabytes() {
  std::ifstream statm("/proc/self/statm");
  double all = 0;
  double resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

class EndlessStreams : public CalibrationSessions {
 protected:
  // A board that a hand moves on and on, as a detector with little noise sees it.
  Observation moving(int n) {
    const double t = n / 30.0;
    SE3 pose;
    const Eigen::Vector3d turn = {0.5 * std::sin(0.7 * t), 0.5 * std::sin(0.9 * t + 1),
                                  0.2 * std::sin(0.31 * t)};
    pose.rotation = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    pose.translation = {0.05 * std::sin(0.53 * t) - 0.1, 0.05 * std::sin(0.41 * t) - 0.07,
                        0.75 + 0.15 * std::sin(0.23 * t)};
    Observation o = scenes::observe(camera_, kBoard, pose, 0.05, random_).observation;
    o.timestamp = times(n).timestamp;
    return o;
  }

  Random random_{5};
};

// Two hours of a recording: 216,000 frames, each of which is a view.
TEST_F(EndlessStreams, KeepAThousandViewsAtMost) {
  begin();
  const int frames = scenes::full_count() ? 216'000 : 12'000;
  const int settled = frames / 3;
  double before = 0;
  std::size_t solves = 0;
  std::size_t most = 0;
  std::set<Reason> reasons;
  for (int n = 0; n < frames; ++n) {
    reasons.insert(session_.offer(moving(n), times(n)).reason);
    most = std::max(most, session_.views().views().size());
    if (const auto job = session_.take_solve()) {
      ++solves;
      ASSERT_TRUE(session_.newly_rejected(*job, found(*job, 0.1)).empty());
    }
    if (n == settled) before = resident_megabytes();
  }
  const double after = resident_megabytes();
  std::cout << frames << " frames: " << solves << " solves, " << after << " MB, " << before
            << " MB after a third of them\n";
  EXPECT_EQ(most, 1000U);
  EXPECT_LT(after - before, 4);
  // Views that are solved again by the quarter: 250 new ones each, once there are a thousand.
  EXPECT_LE(solves, 25U + static_cast<std::size_t>(frames) / 250U);
  EXPECT_EQ(reasons, (std::set<Reason>{Reason::kAccepted, Reason::kTooSimilar}));
}

// What was seen of the board before it was put down stays, whatever long it lies there.
TEST_F(EndlessStreams, KeepTheViewsThatDiffer) {
  begin();
  show(40);
  for (int n = 40; n < 3000; ++n) {
    Observation still = moving(40);
    still.timestamp = times(n).timestamp;
    (void)session_.offer(still, times(n));
  }
  const auto& views = session_.views().views();
  ASSERT_EQ(views.size(), 1000U);
  for (std::size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(views[i]->observation.timestamp, times(static_cast<int>(i)).timestamp);
  }
  EXPECT_GT(views.back()->observation.timestamp, times(40).timestamp);
}

// What the board shows late is new all the same: one of those that are nearly alike has to go.
TEST_F(EndlessStreams, KeepWhatIsShownLate) {
  begin();
  for (int n = 0; n < 1100; ++n) {
    Observation still = moving(0);
    still.timestamp = times(n).timestamp;
    (void)session_.offer(still, times(n));
  }
  frame_ = 1100;
  std::set<std::uint64_t> late;
  for (int i = 0; i < 20; ++i) {
    late.insert(times(frame_).timestamp);
    EXPECT_EQ(show(1).reason, Reason::kAccepted) << i;
  }
  const auto& views = session_.views().views();
  EXPECT_EQ(
      std::count_if(views.begin(), views.end(),
                    [&late](const auto& v) { return late.contains(v->observation.timestamp); }),
      20);
}

// A view that was left out is named once, wherever it stands by then: of those before it many have
// had to go while the solve ran.
TEST_F(EndlessStreams, NameTheViewThatASolveLeftOut) {
  constexpr std::size_t kOutlier = 950;
  begin();
  for (int n = 0; n < 900; ++n) (void)session_.offer(moving(n), times(n));
  frame_ = 900;
  show(99);
  const auto job = session_.take_solve();
  ASSERT_TRUE(job);
  ASSERT_EQ(job->views.size(), 999U);
  Solution solution = found(*job, 0.1);
  solution.rejected = {{kOutlier, Reason::kOutlier}};
  for (int n = 999; n < 1800; ++n) (void)session_.offer(moving(n), times(n));
  ASSERT_NE(session_.views().views()[kOutlier], job->views[kOutlier]);
  const auto rejected = session_.newly_rejected(*job, solution);
  ASSERT_EQ(rejected.size(), 1U);
  EXPECT_EQ(rejected[0].times.timestamp, times(kOutlier).timestamp);
  EXPECT_EQ(rejected[0].reason, Reason::kOutlier);
  EXPECT_TRUE(session_.newly_rejected(*job, solution).empty());
}

// Whoever asks for views one by one keeps each of them.
TEST(ManyViews, ThatWereAskedForAllStay) {
  Session session({CaptureMode::kManual, 3});
  Random random(1);
  const Camera camera = scenes::random_camera("pinhole", random);
  const SE3 pose = scenes::random_poses(camera, kBoard, random, 1)[0];
  for (int i = 0; i < 1200; ++i) {
    session.capture_next();
    View view = scenes::observe(camera, kBoard, pose, 0.05, random);
    view.observation.timestamp = static_cast<std::uint64_t>(i) * 1'000'000;
    ASSERT_EQ(session.offer(view), Reason::kAccepted);
  }
  EXPECT_EQ(session.views().size(), 1200U);
}

// A board of 40,000 corners whose ids come in any order: corners are looked up, not searched for,
// and fewer views are kept. A search takes minutes.
TEST(LargeBoards, AreHeldAgainstEachOtherQuickly) {
  constexpr int kSide = 200;
  Session session({CaptureMode::kAll, 3});
  Random random(4);
  std::vector<int> ids(kSide * kSide);
  std::iota(ids.begin(), ids.end(), 0);
  const Board board = parse_board("checkerboard:200x200:2mm").value();
  for (int n = 0; n < 60; ++n) {
    std::shuffle(ids.begin(), ids.end(), random);
    View view;
    view.board = board;
    view.observation.board = board.text();
    view.observation.image_size = scenes::kSize;
    view.observation.timestamp = static_cast<std::uint64_t>(n) * 33'333'333;
    view.observation.ids.assign(ids.begin(), ids.end() - n);
    for (const int id : view.observation.ids) {
      view.observation.uv.push_back({100.0 + 4 * (id % kSide) + n, 100.0 + 4 * (id / kSide)});
    }
    EXPECT_EQ(session.offer(view) == Reason::kAccepted || n >= 50, true);
  }
  EXPECT_EQ(session.views().size(), 50U);
}

// ---- Distances ----------------------------------------------------------------------------------

View at(Pixel place, std::size_t corners = 54) {
  View view;
  view.board = kBoard;
  view.observation.board = kBoard.text();
  view.observation.image_size = scenes::kSize;
  for (std::size_t i = 0; i < corners; ++i) {
    view.observation.ids.push_back(static_cast<int>(i));
    view.observation.uv.push_back(
        {place.u + static_cast<double>(i % 9) * 20, place.v + static_cast<double>(i / 9) * 20});
  }
  return view;
}

TEST(ViewDistances, AreThoseOfTheCornersShared) {
  EXPECT_DOUBLE_EQ(view_distance(at({100, 100}), at({103, 104})), 5);
  EXPECT_NEAR(view_distance(at({100, 100}), at({103, 204}, 45)), std::hypot(3, 104), 1e-9);
  EXPECT_NEAR(view_distance(at({100, 100}), at({100, 100}, 45)), 10, 1e-9) << "other parts";
  EXPECT_EQ(view_distance(at({100, 100}), at({100, 100}, 20)), HUGE_VAL) << "too few are shared";
  View other = at({100, 100});
  other.observation.board = "checkerboard:9x6:30mm";
  EXPECT_EQ(view_distance(at({100, 100}), other), HUGE_VAL);
}

// Views come and go in any order; a search over all pairs tells the same.
TEST(ViewSpacings, KnowTheMostCrowdedView) {
  Random random(3);
  ViewSpacing spacing;
  std::vector<std::shared_ptr<const View>> views;
  for (int step = 0; step < 400; ++step) {
    if (views.size() > 3 && scenes::uniform(random, 0, 1) < 0.4) {
      const auto gone = static_cast<std::size_t>(
          scenes::uniform(random, 0, static_cast<double>(views.size()) - 1e-9));
      spacing.remove(gone);
      views.erase(views.begin() + static_cast<std::ptrdiff_t>(gone));
    } else {
      views.push_back(std::make_shared<const View>(
          at({scenes::uniform(random, 0, 900), scenes::uniform(random, 0, 700)},
             scenes::uniform(random, 0, 1) < 0.2 ? 20 : 54)));
      spacing.add(views.back());
    }
    if (views.size() < 2) continue;
    std::pair<double, std::size_t> crowded = {HUGE_VAL, 0};
    for (std::size_t i = 0; i < views.size(); ++i) {
      double nearest = HUGE_VAL;
      for (std::size_t j = 0; j < views.size(); ++j) {
        if (i != j) nearest = std::min(nearest, view_distance(*views[j], *views[i]));
      }
      if (nearest <= crowded.first) crowded = {nearest, i};
    }
    ASSERT_EQ(spacing.most_crowded(views.size()), crowded.second) << step;
  }
}

}  // namespace
}  // namespace calvin
