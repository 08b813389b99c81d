// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Rows are to a solve what columns are: pictures and boards with the two exchanged have the same
// camera with its two axes exchanged, as sure and as good, or are refused for the same reason.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::Random;

constexpr ImageSize kSquare = {1000, 1000};

std::vector<View> exchanged(std::vector<View> views) {
  for (View& view : views) {
    const Grid was = view.board.grid().value();
    view.board = Checkerboard{was.rows, was.cols, was.pitch};
    view.observation.board = view.board.text();
    for (int& id : view.observation.ids) id = id % was.cols * was.rows + id / was.cols;
    for (Pixel& p : view.observation.uv) std::swap(p.u, p.v);
  }
  return views;
}

// What a parameter is called after that.
std::string exchanged(const std::string& name) {
  const std::vector<std::pair<const char*, const char*>> pairs = {
      {"fx", "fy"}, {"cx", "cy"}, {"p1", "p2"}, {"s1", "s3"}, {"s2", "s4"}};
  for (const auto& [a, b] : pairs) {
    if (name == a) return b;
    if (name == b) return a;
  }
  return name;
}

// By how much the second of two numbers differs from the first, as a share of it.
double share(double one, double other) { return std::abs(other / one - 1); }

// What is not the same, empty if all is.
std::string difference(const Parameter& p, const Parameter* q) {
  if (q == nullptr || p.sigma.has_value() != q->sigma.has_value()) return " " + p.name;
  if (!p.sigma) return "";
  const bool same =
      std::abs(p.value - q->value) < 0.01 * *p.sigma && share(*p.sigma, *q->sigma) < 1e-3;
  return same ? ""
              : fmt::format(" {} {} +- {}, {} +- {}", p.name, p.value, *p.sigma, q->value,
                            *q->sigma);
}

std::string difference(const char* name, std::optional<double> a, std::optional<double> b,
                       double by) {
  if (a.has_value() == b.has_value() && (!a || share(*a, *b) < by)) return "";
  return fmt::format(" {} {}, {}", name, a.value_or(0), b.value_or(0));
}

// They name numbers that are alike for both axes, or those of one of them. Whether the picture is
// much worse elsewhere depends on the grid, where it is at the limit.
std::ptrdiff_t remarks(const Calibration& c) {
  return std::count_if(c.remarks.begin(), c.remarks.end(), [](const std::string& remark) {
    return remark.find("No corner was seen") == std::string::npos;
  });
}

std::string difference(const Solution& one, const Solution& other) {
  const Calibration& a = one.calibration;
  const Calibration& b = other.calibration;
  std::string found;
  for (const Parameter& p : a.parameters) found += difference(p, b.find(exchanged(p.name)));
  found += difference("rms", a.rms, b.rms, 1e-4);
  found += difference("chi", a.chi, b.chi, 1e-4);
  found += difference("held-out", a.held_out_rms, b.held_out_rms, 0.1);
  // The grid over the image has more columns than rows, and the rim of a wide lens is between them.
  if (!scenes::is_wide(a.model)) {
    found += difference("anywhere", a.expected_error_anywhere, b.expected_error_anywhere, 0.03);
    // And few of its pixels are near the border of what corners covered, which may be small.
    found += difference("halves", one.misfit.split_half_ratio, other.misfit.split_half_ratio, 0.15);
    found += difference("covered", a.expected_error, b.expected_error, 0.15);
  }
  if (one.misfit.cause != other.misfit.cause) found += " misfit";
  if (one.rejected.size() != other.rejected.size()) found += " views";
  if (one.rejected_corners.size() != other.rejected_corners.size()) found += " corners";
  if (remarks(a) != remarks(b)) found += " remarks";
  return found;
}

class EveryModel : public ::testing::TestWithParam<std::string_view> {};
INSTANTIATE_TEST_SUITE_P(Turned, EveryModel, ::testing::ValuesIn(scenes::kSolvedModels),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(EveryModel, IsSolvedAlike) {
  for (int i = 0; i < 10; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const Camera camera = scenes::random_camera(GetParam(), random, kSquare);
    const auto views = scenes::observe_all(
        camera, kBoard, scenes::random_poses(camera, kBoard, random, 10), 0.1, random);
    SolveOptions options;
    options.model = GetParam();
    const auto one = solve(views, kSquare, options);
    const auto other = solve(exchanged(views), kSquare, options);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(difference(*one, *other), "") << i;
  }
}

// The reason without its numbers.
std::string reason(const Error& error) { return error.message.substr(0, error.message.find('(')); }

// Few views that are tilted about one axis, some of them hardly: they do not tell all.
TEST(PoorViews, AreRefusedAlike) {
  int solved = 0;
  int differ = 0;
  int center = 0;
  int focal = 0;
  for (int i = 0; i < 300; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const Camera camera = scenes::random_camera("pinhole", random, kSquare);
    const double side = scenes::uniform(random, 0, 2 * std::numbers::pi);
    const double noise = std::pow(10, scenes::uniform(random, -1, 0.7));
    std::vector<SE3> poses;
    const bool known = i % 2 == 0;  // the focal length, and one view is enough
    while (poses.size() < (known ? 1 : 3)) {
      const double tilt = std::pow(10, scenes::uniform(random, -1.7, -0.1));
      SE3 pose = {exp_so3({tilt * std::cos(side), tilt * std::sin(side), 0}), {}};
      pose.translation = {scenes::uniform(random, -0.2, 0.1), scenes::uniform(random, -0.2, 0.1),
                          scenes::uniform(random, 0.3, 0.6)};
      if (scenes::sees_all(camera, kBoard, pose)) poses.push_back(pose);
    }
    const auto views = scenes::observe_all(camera, kBoard, poses, noise, random);
    SolveOptions options;
    options.model = "pinhole";
    options.reject_outliers = false;
    if (known) {
      options.initial = camera.to_calibration();
      options.fix = {"fx", "fy"};
    }
    const auto one = solve(views, kSquare, options);
    if (options.initial) {
      std::swap(options.initial->parameters[0].value, options.initial->parameters[1].value);
      std::swap(options.initial->parameters[2].value, options.initial->parameters[3].value);
    }
    const auto other = solve(exchanged(views), kSquare, options);
    ASSERT_EQ(one.has_value(), other.has_value())
        << i << ": " << (one ? other : one).error().message;
    if (one) {
      ++solved;
      const Calibration& a = one->calibration;
      const Calibration& b = other->calibration;
      EXPECT_EQ(difference("rms", a.rms, b.rms, 1e-4), "") << i;
      EXPECT_EQ(difference("chi", a.chi, b.chi, 1e-4), "") << i;
      const std::string found = difference(*one, *other);
      if (found.empty()) continue;
      ++differ;
      std::cout << i << ":" << found << std::endl;
      continue;
    }
    // On the way to nowhere rounding decides how far they get.
    const auto lost = [](const Error& e) {
      return e.message.find("converge") != std::string::npos;
    };
    if (lost(one.error()) || lost(other.error())) continue;
    EXPECT_EQ(reason(one.error()), reason(other.error())) << i;
    center += reason(one.error()).find("principal point") != std::string::npos ? 1 : 0;
    focal += reason(one.error()).find("focal length") != std::string::npos ? 1 : 0;
  }
  // The same camera each time, but rounding may decide how it is judged: three views are hardly
  // split into halves, and what is estimated beyond noise is so where it is large enough.
  EXPECT_LE(differ, 3);
  EXPECT_GT(solved, 50);
  EXPECT_GT(center, 10);
  EXPECT_GT(focal, 10);
}

}  // namespace
}  // namespace calvin
