// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// How long a solve goes on after it is told to stop.
#pragma once

#include <algorithm>
#include <chrono>
#include <stop_token>
#include <thread>

#include "calvin/solve/solve.hpp"
#include "solve_problem.hpp"

namespace bench {

// The longest of several such waits, ms, the stop requested at even distances over the time that
// the solve takes with all its checks.
inline double longest_stop(const Problem& problem) {
  using Clock = std::chrono::steady_clock;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  constexpr int kStops = 40;
  calvin::SolveOptions options;
  options.model = problem.model;
  const auto solve = [&](std::stop_token stop) {
    return calvin::solve(problem.views, kSize, options, std::move(stop)).has_value();
  };
  (void)solve({});  // memory and caches
  const auto begin = Clock::now();
  (void)solve({});
  const Milliseconds whole = Clock::now() - begin;
  double longest = 0;
  for (int i = 0; i < kStops; ++i) {
    std::stop_source source;
    Clock::time_point asked;
    std::jthread stopper([&] {
      std::this_thread::sleep_for(whole * ((i + 0.5) / kStops));
      asked = Clock::now();
      source.request_stop();
    });
    const bool finished = solve(source.get_token());
    const auto end = Clock::now();
    stopper.join();
    if (!finished) longest = std::max(longest, Milliseconds(end - asked).count());
  }
  return longest;
}

}  // namespace bench
