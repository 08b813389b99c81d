// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Data that cannot be solved are refused with a reason.
#include <limits>

#include <gtest/gtest.h>

#include "calvin/solve/solve.hpp"
#include "scenes.hpp"

namespace calvin {
namespace {

using scenes::kBoard;
using scenes::kSize;
using scenes::Random;

// What is wrong, and which word the message must contain.
struct BadInput {
  const char* name;
  void (*spoil)(std::vector<View>&, ImageSize&, SolveOptions&);
  ErrorCode code;
  const char* word;
};

void keep_first_corners(std::vector<View>& views, std::size_t count) {
  for (View& view : views) {
    view.observation.ids.resize(count);
    view.observation.uv.resize(count);
    view.observation.sigma.resize(count);
  }
}

// A board that is moved and never tilted any further, before the camera that is returned.
Camera parallel_views(std::vector<View>& views, int count, double tilt = 0) {
  Random random(3);
  const Camera camera = scenes::random_camera("pinhole", random);
  views.clear();
  while (static_cast<int>(views.size()) < count) {
    const SE3 pose = {exp_so3({tilt, 0, 0}),
                      {scenes::uniform(random, -0.3, 0.1), scenes::uniform(random, -0.2, 0.1),
                       scenes::uniform(random, 0.3, 0.6)}};
    if (!scenes::sees_all(camera, kBoard, pose)) continue;
    views.push_back(scenes::observe(camera, kBoard, pose, 0, random));
  }
  return camera;
}

const BadInput kBadInputs[] = {
    {"NoViews", [](auto& views, auto&, auto&) { views.clear(); }, ErrorCode::kDegenerate,
     "no view"},
    {"NothingFound", [](auto& views, auto&, auto&) { keep_first_corners(views, 0); },
     ErrorCode::kDegenerate, "no view"},
    {"OneView", [](auto& views, auto&, auto&) { views.resize(1); }, ErrorCode::kDegenerate,
     "at least 3 views"},
    {"SameViewTenTimes", [](auto& views, auto&, auto&) { views.assign(10, views[0]); },
     ErrorCode::kDegenerate, "same place"},
    {"Collinear", [](auto& views, auto&, auto&) { keep_first_corners(views, 9); },
     ErrorCode::kDegenerate, "one line"},
    {"ThreeCorners", [](auto& views, auto&, auto&) { keep_first_corners(views, 3); },
     ErrorCode::kDegenerate, "4 corners"},
    {"FewerEquationsThanUnknowns",
     [](auto& views, auto&, auto&) {
       views.resize(3);
       for (View& view : views) {
         view.observation.ids = {0, 8, 45, 53};
         auto& uv = view.observation.uv;
         uv = {uv[0], uv[8], uv[45], uv[53]};
       }
     },
     ErrorCode::kDegenerate, "unknowns"},
    {"NanCorner",
     [](auto& views, auto&, auto&) {
       views[3].observation.uv[5].u = std::numeric_limits<double>::quiet_NaN();
     },
     ErrorCode::kInvalidArgument, "View 3"},
    {"InfiniteCorner",
     [](auto& views, auto&, auto&) {
       views[3].observation.uv[5].v = -std::numeric_limits<double>::infinity();
     },
     ErrorCode::kInvalidArgument, "outside"},
    {"FarCorner", [](auto& views, auto&, auto&) { views[3].observation.uv[5].u = 1e300; },
     ErrorCode::kInvalidArgument, "outside"},
    {"RepeatedId", [](auto& views, auto&, auto&) { views[2].observation.ids[7] = 8; },
     ErrorCode::kInvalidArgument, "twice"},
    {"IdBeyondTheBoard", [](auto& views, auto&, auto&) { views[2].observation.ids[7] = 54; },
     ErrorCode::kInvalidArgument, "not on the board"},
    {"NegativeId", [](auto& views, auto&, auto&) { views[2].observation.ids[7] = -1; },
     ErrorCode::kInvalidArgument, "not on the board"},
    {"MoreIdsThanCorners", [](auto& views, auto&, auto&) { views[2].observation.uv.pop_back(); },
     ErrorCode::kInvalidArgument, "needs its id"},
    {"NoBoard", [](auto& views, auto&, auto&) { views[2].board = Board{}; },
     ErrorCode::kInvalidArgument, "board"},
    {"NanBoard",
     [](auto& views, auto&, auto&) {
       views[2].board = Checkerboard{9, 6, std::numeric_limits<double>::quiet_NaN()};
     },
     ErrorCode::kInvalidArgument, "board"},
    {"NoImage",
     [](auto&, auto& size, auto&) {
       size = {0, 0};
     },
     ErrorCode::kInvalidArgument, "0x0"},
    {"AllOffSize",
     [](auto&, auto& size, auto&) {
       size = {640, 480};
     },
     ErrorCode::kInvalidArgument, "images of 1280x960 px, and a camera for images of 640x480"},
    {"AllOffSizeBeforeAHeldCamera",
     [](auto&, auto& size, auto& options) {
       size = {640, 480};
       options.fix = {"all"};
       options.initial = Camera::make("pinhole", size, {500, 500, 320, 240})->to_calibration();
     },
     ErrorCode::kInvalidArgument, "images of 1280x960 px"},
    {"HeldWhereNoCameraIs", [](auto&, auto&, auto& options) { options.fix = {"cx=1e300"}; },
     ErrorCode::kInvalidArgument, "'cx=1e300'"},
    {"HeldCoefficientThatNoLensHas",
     [](auto&, auto&, auto& options) { options.fix = {"k1=-1e10"}; }, ErrorCode::kInvalidArgument,
     "'k1=-1e10'"},
    {"UnknownModel", [](auto&, auto&, auto& options) { options.model = "brown99"; },
     ErrorCode::kUnsupported, "brown5"},
    {"NoIterations", [](auto&, auto&, auto& options) { options.max_iterations = 0; },
     ErrorCode::kInvalidArgument, "max_iterations"},
    {"LessThanNoIterations", [](auto&, auto&, auto& options) { options.max_iterations = -1; },
     ErrorCode::kInvalidArgument, "max_iterations"},
    {"OnePoseTwice",
     [](auto& views, auto&, auto&) {
       views = {views[0], views[0]};
     },
     ErrorCode::kDegenerate, "same place"},
    // A board of twice the size at twice the distance was moved there.
    {"AnotherBoardInThePlaceOfTheFirst",
     [](auto& views, auto&, auto&) {
       views = {views[0], views[0]};
       views[1].board = Checkerboard{9, 6, 2 * scenes::kSquares.size};
     },
     ErrorCode::kDegenerate, "never tilted"},
    {"HeldInOnePose",
     [](auto& views, auto&, auto&) {
       Random random(3);
       views.assign(10, views[0]);
       for (View& view : views) {
         for (Pixel& p : view.observation.uv) {
           p = {p.u + scenes::uniform(random, -0.1, 0.1), p.v + scenes::uniform(random, -0.1, 0.1)};
         }
       }
     },
     ErrorCode::kDegenerate, "All 10 views show the board in the same place"},
    {"MovedAndNeverTilted",
     [](auto& views, auto&, auto& options) {
       const Camera camera = parallel_views(views, 2);
       options.model = camera.model();
     },
     ErrorCode::kDegenerate, "never tilted"},
    {"TwoTiltsForASkew",
     [](auto& views, auto&, auto& options) {
       views.resize(2);
       options.model = "pinhole";
       options.skew = true;
     },
     ErrorCode::kDegenerate, "2 views cannot determine"},
    {"TwoTiltsInManyViewsForASkew",
     [](auto& views, auto&, auto& options) {
       const Camera camera = parallel_views(views, 2);
       std::vector<View> other;
       parallel_views(other, 2, 0.5);
       views.insert(views.end(), other.begin(), other.end());
       options.model = camera.model();
       options.skew = true;
     },
     ErrorCode::kDegenerate, "2 tilts"},
    {"AllCornersInOnePlace",
     [](auto& views, auto&, auto&) {
       for (View& view : views) std::fill_n(view.observation.uv.begin(), 54, Pixel{300, 300});
     },
     ErrorCode::kDegenerate, "views"},
    {"RandomCorners",
     [](auto& views, auto&, auto&) {
       Random random(5);
       for (View& view : views) {
         for (Pixel& p : view.observation.uv) {
           p = {scenes::uniform(random, 0, 1279), scenes::uniform(random, 0, 959)};
         }
       }
     },
     ErrorCode::kDegenerate, "views"},
};

// Whether anything moves in the views or not.
TEST(Readout, ThatNoFrameHasIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Random random(9);
  const Camera camera = scenes::random_camera("brown5", random);
  const auto views = scenes::observe_all(
      camera, kBoard, scenes::random_poses(camera, kBoard, random, 10), 0.1, random);
  SolveOptions options;
  for (const ReadoutTime& readout : {ReadoutTime{kNan, 0},
                                     {0.02, -1},
                                     {0.02, kNan},
                                     {0.02, kInfinity},
                                     {1e300, 0},
                                     {-61, 0},
                                     {kInfinity, 0.1}}) {
    options.readout = readout;
    EXPECT_EQ(check(options).error().code, ErrorCode::kInvalidArgument) << readout.value;
    const auto solution = solve(views, kSize, options);
    ASSERT_FALSE(solution.has_value()) << readout.value << ' ' << readout.sigma;
    EXPECT_EQ(solution.error().code, ErrorCode::kInvalidArgument);
    EXPECT_NE(solution.error().message.find("readout"), std::string::npos);
  }
  options.readout = ReadoutTime{-0.02, 0.01};
  EXPECT_TRUE(check(options).has_value());
  EXPECT_TRUE(solve(views, kSize, options).has_value());
}

class BadInputs : public ::testing::TestWithParam<BadInput> {};
INSTANTIATE_TEST_SUITE_P(Solve, BadInputs, ::testing::ValuesIn(kBadInputs),
                         [](const auto& test) { return test.param.name; });

TEST_P(BadInputs, AreRefusedWithAReason) {
  Random random(9);
  const Camera camera = scenes::random_camera("brown5", random);
  auto views = scenes::observe_all(camera, kBoard, scenes::random_poses(camera, kBoard, random, 10),
                                   0.1, random);
  ImageSize size = kSize;
  SolveOptions options;
  GetParam().spoil(views, size, options);
  const auto solution = solve(views, size, options);
  ASSERT_FALSE(solution.has_value());
  EXPECT_EQ(solution.error().code, GetParam().code) << solution.error().message;
  EXPECT_NE(solution.error().message.find(GetParam().word), std::string::npos)
      << solution.error().message;
}

// Their squares are no numbers of double precision, or nearly none.
TEST(Sigmas, ThatNoCornerCanHaveCountAsMissing) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Random random(9);
  const Camera camera = scenes::random_camera("brown5", random);
  auto views = scenes::observe_all(camera, kBoard, scenes::random_poses(camera, kBoard, random, 10),
                                   0.1, random);
  for (View& view : views) view.observation.sigma.clear();
  const auto without = solve(views, kSize);
  ASSERT_TRUE(without.has_value());
  for (const double sigma : {1e-300, 1e-154, 1e-7, 1e7, 1e155, 1e300, kInfinity}) {
    for (View& view : views) {
      view.observation.sigma.assign(view.observation.ids.size(), sigma);
    }
    const auto solution = solve(views, kSize);
    ASSERT_TRUE(solution.has_value()) << sigma << ": " << solution.error().message;
    const Calibration& found = solution->calibration;
    EXPECT_EQ(found.chi, without->calibration.chi) << sigma;
    EXPECT_EQ(found.expected_error, without->calibration.expected_error) << sigma;
    for (std::size_t i = 0; i < found.parameters.size(); ++i) {
      EXPECT_EQ(found.parameters[i].value, without->calibration.parameters[i].value) << sigma;
    }
  }
}

}  // namespace
}  // namespace calvin
