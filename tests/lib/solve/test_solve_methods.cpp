// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The methods of the tools that came before: on points without noise each finds the camera, on
// noisy ones each leads to the optimum that the truth leads to, and what none can tell is refused.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "calvin/core/calibration.hpp"
#include "calvin/geometry/se3.hpp"
#include "calvin/solve/methods/methods.hpp"
#include "calvin/solve/methods/radial_alignment.hpp"
#include "calvin/solve/methods/tsai.hpp"
#include "calvin/solve/solve.hpp"
#include "calvin/target/kinds.hpp"
#include "known_points.hpp"

namespace calvin {
namespace {

using scenes::kSize;
using scenes::Object;
using scenes::Random;
using scenes::uniform;

// A method, what it takes, and what a single view or a plane leaves to be known before.
struct MethodCase {
  const char* name;
  const char* method;
  Object object;
  int views;
  const char* model;
  std::vector<std::string> fix;

  friend std::ostream& operator<<(std::ostream& out, const MethodCase& c) { return out << c.name; }
};
const std::vector<MethodCase> kCases = {
    {"DltOfOneView", "dlt", Object::kSpace, 1, "brown4", {}},
    {"DltOfThreeViews", "dlt", Object::kSpace, 3, "brown5", {}},
    {"TsaiInSpace", "tsai", Object::kSpace, 1, "brown4", {"k2", "p1", "p2"}},
    {"TsaiOfAPlane", "tsai", Object::kPlane, 1, "brown4", {"center", "aspect", "k2", "p1", "p2"}},
    {"ZhangOfOneView", "zhang", Object::kPlane, 1, "brown4", {"center", "aspect", "p1", "p2"}},
    {"ZhangOfTwoViews", "zhang", Object::kPlane, 2, "brown4", {"center", "aspect"}},
    {"ZhangOfFiveViews", "zhang", Object::kPlane, 5, "brown4", {}},
    {"BaksteinOfFiveViews", "bakstein", Object::kPlane, 5, "brown4", {}},
    {"HeikkilaOfOneView", "heikkila", Object::kSpace, 1, "brown4", {}},
    {"HeikkilaOfAPlane", "heikkila", Object::kPlane, 1, "brown4", {"center", "aspect", "p1", "p2"}},
    {"HeikkilaOfFiveViews", "heikkila", Object::kPlane, 5, "brown4", {}},
};

// A lens whose free parameters are those of the case; it bends the corners by some ten px.
Camera camera_for(const MethodCase& c, Random& random) {
  const auto is_fixed = [&c](const char* name) {
    return std::find(c.fix.begin(), c.fix.end(), name) != c.fix.end();
  };
  const double fx = kSize.width * uniform(random, 0.8, 1.4);
  const double fy = is_fixed("aspect") ? fx : fx * uniform(random, 0.995, 1.005);
  Pixel center = image_center(kSize);
  if (!is_fixed("center")) {
    center = {kSize.width * uniform(random, 0.48, 0.52),
              kSize.height * uniform(random, 0.48, 0.52)};
  }
  std::vector<double> p = {fx,
                           fy,
                           center.u,
                           center.v,
                           uniform(random, -0.2, 0.1),
                           is_fixed("k2") ? 0 : uniform(random, -0.02, 0.05),
                           0,
                           0};
  if (!is_fixed("p1")) p[6] = uniform(random, -0.001, 0.001);
  if (!is_fixed("p2")) p[7] = uniform(random, -0.001, 0.001);
  if (std::string_view(c.model) == "brown5") p.push_back(0);
  return Camera::make(c.model, kSize, p).value();
}

struct Problem {
  Camera camera;
  std::vector<SE3> poses;
  std::vector<View> views;
};

Problem problem_for(const MethodCase& c, double noise, Random& random) {
  Problem problem = {camera_for(c, random), {}, {}};
  const Board board = scenes::object(c.object, random);
  for (int v = 0; v < c.views; ++v) {
    problem.poses.push_back(scenes::pose_for(problem.camera, board, c.object, random));
    problem.views.push_back(
        scenes::observe(problem.camera, board, problem.poses.back(), noise, random));
  }
  return problem;
}

SolveOptions options_for(const MethodCase& c) {
  SolveOptions options;
  options.model = c.model;
  options.method = c.method;
  options.fix = c.fix;
  options.warp = false;
  options.checks = false;
  options.reject_outliers = false;
  return options;
}

class Methods : public ::testing::TestWithParam<MethodCase> {};
INSTANTIATE_TEST_SUITE_P(Solve, Methods, ::testing::ValuesIn(kCases),
                         [](const auto& c) { return std::string(c.param.name); });

// Without noise, and without distortion, which only the least squares take account of, the linear
// steps are exact.
TEST_P(Methods, AreExactForAPinhole) {
  const MethodCase& c = GetParam();
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const Problem bent = problem_for(c, 0, random);
    const auto& p = bent.camera.parameters();
    Camera camera = Camera::make("pinhole", kSize, {p[0], p[1], p[2], p[3]}).value();
    if (std::string_view(c.method) == "tsai") {
      const Pixel center = image_center(kSize);
      camera = Camera::make("pinhole", kSize, {p[0], p[1], center.u, center.v}).value();
    }
    std::vector<View> views;
    for (const SE3& pose : bent.poses) {
      views.push_back(scenes::observe(camera, bent.views.front().board, pose, 0, random));
    }
    SolveOptions options = options_for(c);
    options.refine = false;
    const auto found = solve(views, kSize, options);
    ASSERT_TRUE(found) << found.error().message;
    if (std::string_view(c.method) == "bakstein") {
      // Its turns end near the camera, not in it.
      EXPECT_LT(*found->calibration.rms, 10);
      EXPECT_NEAR(found->calibration.find("fx")->value, camera.fx(), 0.1 * camera.fx());
      continue;
    }
    EXPECT_LT(*found->calibration.rms, 1e-3);
    EXPECT_NEAR(found->calibration.find("fx")->value, camera.fx(), 2e-4 * camera.fx());
    EXPECT_NEAR(found->calibration.find("cy")->value, camera.cy(), 0.2);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const SE3 pose = to_se3(found->calibration.views[v].camera_from_board);
      EXPECT_LT((pose.translation - bent.poses[v].translation).norm(),
                1e-3 * bent.poses[v].translation.norm());
    }
  }
}

// The square of what separates the estimated parameters from the truth, over their covariance and
// over what is free of them: with the aspect held fx and fy are one unknown.
double normalised(const Calibration& found, const Camera& truth) {
  std::vector<double> error;  // sigmas
  std::vector<double> sigmas;
  const auto names = parameter_names(truth.model());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Parameter* p = found.find(names[i]);
    if (!p->sigma) continue;
    sigmas.push_back(*p->sigma);
    error.push_back((p->value - truth.parameters()[i]) / *p->sigma);
  }
  const auto n = static_cast<Eigen::Index>(error.size());
  const Eigen::VectorXd scale = Eigen::Map<const Eigen::VectorXd>(sigmas.data(), n).cwiseInverse();
  const Eigen::MatrixXd correlation =
      scale.asDiagonal() * Eigen::Map<const Eigen::MatrixXd>(found.covariance.data(), n, n) *
      scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation);
  const Eigen::VectorXd along =
      eigen.eigenvectors().transpose() * Eigen::Map<const Eigen::VectorXd>(error.data(), n);
  constexpr double kNothing = 1e-9;  // of a variance
  double square = 0;
  int free = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (eigen.eigenvalues()[i] < kNothing) continue;
    square += along[i] * along[i] / eigen.eigenvalues()[i];
    ++free;
  }
  return square / free;
}

double focal_error(const Calibration& found, const Camera& truth) {
  return std::abs(found.find("fx")->value / truth.fx() - 1);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// From the method as from the truth: the least squares end at the same optimum, and its sigmas
// are true.
TEST_P(Methods, LeadWhereTheTruthLeads) {
  const MethodCase& c = GetParam();
  const int count = scenes::full_count() ? 2000 : 60;
  Random random(17);
  int same = 0;
  int refused = 0;
  double squares = 0;
  std::vector<double> by_itself;  // errors of fx, parts of it
  std::vector<double> refined;
  for (int trial = 0; trial < count; ++trial) {
    const Problem problem = problem_for(c, 0.1, random);
    SolveOptions options = options_for(c);
    options.refine = false;
    const auto raw = solve(problem.views, kSize, options);
    if (raw) by_itself.push_back(focal_error(raw->calibration, problem.camera));
    options.refine = true;
    const auto found = solve(problem.views, kSize, options);
    options.method.clear();
    options.initial = problem.camera.to_calibration();
    const auto best = solve(problem.views, kSize, options);
    if (!best) {
      EXPECT_FALSE(found) << "what the truth does not lead to is no result";
      ++refused;
      continue;
    }
    if (!found) {
      ADD_FAILURE() << found.error().message;
      continue;
    }
    const double ratio = *found->calibration.rms / *best->calibration.rms;
    if (ratio < 1 + 1e-5) ++same;
    squares += normalised(found->calibration, problem.camera);
    refined.push_back(focal_error(found->calibration, problem.camera));
  }
  RecordProperty("focal_by_itself", std::to_string(median(by_itself)));
  RecordProperty("focal_refined", std::to_string(median(refined)));
  EXPECT_LE(median(refined), 1.05 * median(by_itself));
  const int solved = count - refused;
  EXPECT_LE(refused, count / 20);
  EXPECT_GE(same, 0.99 * solved);
  const double ratio = std::sqrt(squares / solved);
  RecordProperty("true_over_predicted", std::to_string(ratio));
  const double luck = scenes::full_count() ? 0 : 0.15;
  EXPECT_GT(ratio, 0.9 - luck);
  EXPECT_LT(ratio, 1.1 + luck);
}

// A distortion that is Tsai's own: his model is found, and a camera of ours follows it.
TEST(Tsai, FindsItsOwnDistortion) {
  Random random(3);
  const MethodCase& c = kCases[2];
  for (int trial = 0; trial < 20; ++trial) {
    const Board board = scenes::object(Object::kSpace, random);
    TsaiCamera truth;
    truth.focal = uniform(random, 900, 1500);
    truth.kappa = uniform(random, -2e-7, 2e-7);
    truth.center = image_center(kSize);
    truth.sx = uniform(random, 0.98, 1.02);
    const Camera pinhole =
        Camera::make("pinhole", kSize, {truth.focal, truth.focal, truth.center.u, truth.center.v})
            .value();
    truth.camera_from_board = scenes::pose_for(pinhole, board, c.object, random);
    PointSet view =
        scenes::points_of(scenes::observe(pinhole, board, truth.camera_from_board, 0, random));
    for (std::size_t i = 0; i < view.size(); ++i) view.uv[i] = truth.project(view.points[i]);
    // Directions do not know of the distortion: these are exact before any iteration.
    const auto linear = radial_alignment(view, truth.center);
    ASSERT_TRUE(linear) << linear.error().message;
    EXPECT_NEAR(linear->sx, truth.sx, 1e-9);
    const SE3& pose = linear->camera_from_board;
    EXPECT_NEAR(pose.translation.x(), truth.camera_from_board.translation.x(), 1e-9);
    EXPECT_NEAR(pose.translation.y(), truth.camera_from_board.translation.y(), 1e-9);
    EXPECT_LT((pose.rotation - truth.camera_from_board.rotation).norm(), 1e-8);
    const auto found = tsai(view, truth.center);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_NEAR(found->focal, truth.focal, 1e-3);
    EXPECT_NEAR(found->kappa, truth.kappa, 1e-12);
    const NearestCamera near = nearest_camera(*found, kSize);
    EXPECT_LT(near.residual, 0.02);
    const Camera ours = Camera::make(near.model, kSize, near.parameters).value();
    for (std::size_t i = 0; i < view.size(); ++i) {
      const Pixel at = ours.project(truth.camera_from_board * view.points[i]).value();
      EXPECT_LT(std::hypot(at.u - view.uv[i].u, at.v - view.uv[i].v), near.residual * 1.1 + 1e-3);
    }
  }
}

// What each cannot tell it refuses, with what to do about it.
TEST(Methods, RefuseWhatTheyCannotTell) {
  Random random(7);
  const auto refuses = [](MethodCase c, const std::vector<View>& views, std::string_view why) {
    // So that the least squares would have equations enough.
    if (views.size() == 1) c.fix = {"center", "aspect"};
    for (const bool refine : {false, true}) {
      SolveOptions options = options_for(c);
      options.refine = refine;
      const auto found = solve(views, kSize, options);
      ASSERT_FALSE(found) << c.name << ": " << why;
      EXPECT_NE(found.error().message.find(why), std::string::npos) << found.error().message;
    }
  };
  const auto find = [](std::string_view name) -> const MethodCase& {
    return *std::find_if(kCases.begin(), kCases.end(),
                         [name](const MethodCase& c) { return c.name == name; });
  };
  const Problem plane = problem_for(find("ZhangOfFiveViews"), 0.1, random);
  const Problem space = problem_for(find("DltOfOneView"), 0.1, random);
  refuses(find("DltOfOneView"), plane.views, "lie in a plane");
  refuses(find("ZhangOfFiveViews"), space.views, "takes");
  refuses(find("TsaiInSpace"), plane.views, "takes one view");
  for (const MethodCase& c : kCases) {
    EXPECT_EQ(takes_one_view(c.method), std::string_view(c.method) == "tsai") << c.method;
  }
  EXPECT_FALSE(takes_one_view(""));
  refuses(find("BaksteinOfFiveViews"), {plane.views[0]}, "two views");

  Problem few = space;
  few.views[0].observation.ids.resize(5);
  few.views[0].observation.uv.resize(5);
  few.views[0].observation.sigma.resize(5);
  refuses(find("DltOfOneView"), few.views, "too few");

  // Mirrored: one axis of the object turned round.
  Problem mirrored = space;
  std::vector<PointBoard::Dot> dots = mirrored.views[0].board.as<PointBoard>()->dots();
  for (PointBoard::Dot& dot : dots) dot.x = -dot.x;
  mirrored.views[0].board = PointBoard::make("box", dots).value();
  refuses(find("DltOfOneView"), mirrored.views, "left-handed");
  refuses(find("TsaiInSpace"), mirrored.views, "left-handed");

  // A plane seen head-on.
  const Camera camera = camera_for(find("TsaiOfAPlane"), random);
  const auto& p = camera.parameters();
  const Camera pinhole = Camera::make("pinhole", kSize, {p[0], p[1], p[2], p[3]}).value();
  const SE3 head_on = {Eigen::Matrix3d::Identity(), {-0.1, -0.06, 0.3}};
  refuses(find("TsaiOfAPlane"), {scenes::observe(pinhole, scenes::kBoard, head_on, 0, random)},
          "head-on");

  SolveOptions unknown;
  unknown.method = "magic";
  const auto none = check(unknown);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("tsai"), std::string::npos) << none.error().message;
  unknown.method.clear();
  unknown.refine = false;
  EXPECT_FALSE(check(unknown));
}

TEST(Fix, HoldsAtANumber) {
  Random random(37);
  const Problem problem = problem_for(kCases[1], 0.1, random);
  SolveOptions options;
  options.fix = {"fx=1100", " cy = 470.5 "};
  const auto found = solve(problem.views, kSize, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->calibration.find("fx")->value, 1100);
  EXPECT_FALSE(found->calibration.find("fx")->sigma);
  EXPECT_EQ(found->calibration.find("cy")->value, 470.5);
  options.fix = {"fx=-5"};
  EXPECT_FALSE(check(options));
}

}  // namespace
}  // namespace calvin
