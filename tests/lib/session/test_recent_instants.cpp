// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Pictures of one time come out together, whole and once, in whichever order cameras deliver them.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/session/rig/recent_instants.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

constexpr std::uint64_t kMs = 1'000'000;  // ns
constexpr std::uint64_t kTolerance = 10 * kMs;

SharedView view_at(std::uint64_t timestamp) {
  View view{{}, scenes::kBoard};
  view.observation.timestamp = timestamp;
  return std::make_shared<const View>(std::move(view));
}

using Taken = std::vector<std::vector<SharedView>>;

std::vector<std::uint64_t> times_of(const std::vector<SharedView>& views) {
  std::vector<std::uint64_t> times;
  for (const SharedView& view : views) times.push_back(view->observation.timestamp);
  return times;
}

// Three cameras of which one looks in between the others, and views are asked for after each: two
// that look at one time are never taken apart.
TEST(RecentInstants, AreTakenAsAWhole) {
  for (const std::uint64_t other : {12 * kMs, 17 * kMs, 22 * kMs}) {
    RecentInstants recent;
    std::vector<std::uint64_t> a;
    std::vector<std::uint64_t> b;
    const auto take = [&] {
      const Taken taken = recent.take(kTolerance, kMs);
      for (const std::uint64_t t : times_of(taken[0])) a.push_back(t);
      if (taken.size() < 2) return;
      for (const std::uint64_t t : times_of(taken[1])) b.push_back(t);
      EXPECT_EQ(taken[0].size(), taken[1].size());
    };
    for (std::uint64_t n = 1; n <= 60; ++n) {
      const std::uint64_t now = 33 * kMs * n;
      recent.add(0, view_at(now));
      take();
      recent.add(1, view_at(now + 5 * kMs));
      take();
      recent.add(2, view_at(now + other));
      take();
    }
    ASSERT_GE(a.size(), 57U) << other;
    for (std::size_t i = 0; i < a.size(); ++i) {
      EXPECT_EQ(a[i], 33 * kMs * (i + 1));
      EXPECT_EQ(b.at(i), a[i] + 5 * kMs);
    }
  }
}

// A camera that is late by half a second is waited for; one that has stopped holds nobody up.
TEST(RecentInstants, WaitForLateCamerasButNotForEver) {
  RecentInstants recent;
  std::size_t pairs = 0;
  for (std::uint64_t n = 1; n <= 60; ++n) {
    recent.add(0, view_at(50 * kMs * n));
    if (n > 10) recent.add(1, view_at(50 * kMs * (n - 10)));
    const Taken taken = recent.take(kTolerance, kMs);
    pairs += taken.size() > 1 ? taken[1].size() : 0;
  }
  // But for those before the second camera was known of.
  EXPECT_GE(pairs, 39U);
  // From here on the second camera has stopped, and a third one sees what the first one does.
  pairs = 0;
  for (std::uint64_t n = 61; n <= 160; ++n) {
    recent.add(0, view_at(50 * kMs * n));
    recent.add(2, view_at(50 * kMs * n));
    const Taken taken = recent.take(kTolerance, kMs);
    pairs += taken.size() > 2 ? taken[2].size() : 0;
  }
  EXPECT_GE(pairs, 55U);
}

TEST(RecentInstants, AreNoMoreThanWereAskedFor) {
  RecentInstants recent;
  std::vector<std::uint64_t> times;
  for (std::uint64_t n = 1; n <= 300; ++n) {
    for (std::size_t c = 0; c < 2; ++c) recent.add(c, view_at(10 * kMs * n + c));
    for (const std::uint64_t t : times_of(recent.take(kMs, 100 * kMs)[0])) times.push_back(t);
  }
  ASSERT_GE(times.size(), 20U);
  for (std::size_t i = 1; i < times.size(); ++i) EXPECT_GE(times[i] - times[i - 1], 100 * kMs);
}

}  // namespace
}  // namespace calvin
