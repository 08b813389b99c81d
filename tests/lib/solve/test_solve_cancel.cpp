// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A solve that is stopped from another thread, at any time, in any of its stages.
#include <pthread.h>

#include <atomic>
#include <ctime>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "calvin/solve/judge/make_solution.hpp"
#include "random_problems.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

// Seconds of processor time: what a busy machine does besides does not count.
double processor_time(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Case {
  const char* name;
  const char* model;
  int views;
  void (*spoil)(std::vector<View>&, Random&);
};

// Corners of unlike quality, worse than they say.
void unlike_sigmas(std::vector<View>& views, Random& random) {
  std::normal_distribution<double> noise(0, 0.3);
  for (View& view : views) {
    for (std::size_t i = 0; i < view.observation.uv.size(); ++i) {
      view.observation.sigma[i] = i % 2 == 0 ? 0.05 : 0.2;
      view.observation.uv[i].u += noise(random);
    }
  }
}

void no_camera(std::vector<View>& views, Random& random) {
  for (View& view : views) {
    for (Pixel& p : view.observation.uv) {
      p = {scenes::uniform(random, 0, kSize.width - 1.0),
           scenes::uniform(random, 0, kSize.height - 1.0)};
    }
  }
}

void nothing(std::vector<View>&, Random&) {}

const Case kCases[] = {
    {"ManyViews", "brown5", 300, nothing},         {"Fisheye", "fisheye", 100, nothing},
    {"DoubleSphere", "doublesphere", 12, nothing}, {"FewViews", "brown5", 3, nothing},
    {"Tilted", "tilted14", 12, nothing},           {"Auto", "auto", 12, nothing},
    {"Sigmas", "brown5", 100, unlike_sigmas},      {"NoCamera", "brown5", 30, no_camera},
};

struct Stopped {
  bool cancelled = false;
  bool complete = true;  // what was found has all of its checks
  double whole = 0;      // s, of the solve
  double after = 0;      // s, from the request to the end
};

Stopped solve_and_stop(const std::vector<View>& views, const Case& c, std::optional<double> when) {
  SolveOptions options;
  options.model = c.model;
  std::stop_source source;
  Stopped result;
  double end = 0;
  std::atomic<bool> ended = false;
  std::thread solver([&] {
    const auto solution = solve(views, kSize, options, source.get_token());
    end = processor_time(CLOCK_THREAD_CPUTIME_ID);
    result.cancelled = !solution && solution.error().code == ErrorCode::kCancelled;
    result.complete = !solution || solution->held_out.size() == solution->calibration.views.size();
    ended = true;
  });
  if (when) {
    clockid_t clock{};
    pthread_getcpuclockid(solver.native_handle(), &clock);
    double at = 0;
    while (!ended && (at = processor_time(clock)) < *when) std::this_thread::yield();
    result.after = -at;
    source.request_stop();
  }
  solver.join();
  result.whole = end;
  if (when) result.after += end;
  return result;
}

class Cancel : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Solve, Cancel, ::testing::ValuesIn(kCases),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_P(Cancel, EndsSoonAfterItIsAsked) {
  const Case& c = GetParam();
  Random random(3);
  const std::string model = std::string_view(c.model) == "auto" ? "brown5" : c.model;
  const Camera camera = scenes::random_camera(model, random);
  auto views = scenes::observe_all(
      camera, kBoard, scenes::random_poses(camera, kBoard, random, c.views), 0.1, random);
  c.spoil(views, random);
  const double whole = solve_and_stop(views, c, std::nullopt).whole;
  // Of 10 ms, with room for what else a machine does to a thread, and for sanitizers.
  const double bound = std::max(0.05, whole / 4);
  int cancelled = 0;
  const int trials = scenes::full_count() ? 200 : 12;
  // A busy machine may wake who stops a short solve after its end, time and again.
  for (int i = 0; i < trials || (cancelled == 0 && i < 100 * trials); ++i) {
    const Stopped stopped = solve_and_stop(views, c, scenes::uniform(random, 0, whole));
    cancelled += stopped.cancelled ? 1 : 0;
    EXPECT_TRUE(stopped.complete);
    if (!stopped.cancelled) continue;
    EXPECT_LT(stopped.after, bound) << "of " << whole << " s";
  }
  EXPECT_GT(cancelled, 0);
}

// What is asked for during the last of its stages is not given out in part: a calibration without
// its checks promises more than it can keep.
TEST(FinishedFit, OfWhatIsStoppedIsNone) {
  Random random(5);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = scenes::observe_all(
      camera, kBoard, scenes::random_poses(camera, kBoard, random, 8), 0.1, random);
  SolveOptions options;
  options.reject_outliers = false;
  const Parameterization parameterization = make_parameterization(options, kSize).value();
  std::vector<PointSet> sets;
  for (const View& view : views)
    sets.push_back(to_points(kBoard, kBoard.points(), view.observation));
  const WeightScale scale = normalise_weights(sets);
  const BoardShape flat;
  const Fit fit = fit_camera(sets, flat, kSize, parameterization, options, {});
  const FinishedFit from = {fit, parameterization, flat, scale, 1};
  std::stop_source source;
  const auto whole = make_solution(from, kSize, options, source.get_token());
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_EQ(whole->held_out.size(), views.size());
  EXPECT_TRUE(whole->calibration.held_out_rms && whole->calibration.expected_error);
  source.request_stop();
  for (const bool checks : {false, true}) {
    options.checks = checks;
    const auto stopped = make_solution(from, kSize, options, source.get_token());
    ASSERT_FALSE(stopped) << checks;
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  }
}

}  // namespace
}  // namespace calvin
