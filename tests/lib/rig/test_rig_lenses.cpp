// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Intrinsics that are solved together with the places of the cameras.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/camera/camera.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "simulated_rig.hpp"

namespace calvin {
namespace {

using scenes::Random;

constexpr double kPart = 0.004;  // of the focal length, 1 sigma of what was known before

// 1 sigma of each parameter of brown5, px or none.
std::vector<double> sigmas_of(const Camera& camera) {
  const double f = kPart * camera.fx();
  return {f, f, 0.5 * f, 0.5 * f, 0.01, 0.02, 0.0005, 0.0005, 0.02};
}

// What a file says of a camera that was calibrated before: off by what its sigmas say.
Calibration known_before(const Camera& camera, const std::string& name, Random& random) {
  Calibration known = camera.to_calibration();
  known.camera = name;
  const auto sigmas = sigmas_of(camera);
  const std::size_t size = sigmas.size();
  known.covariance.assign(size * size, 0.0);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < size; ++i) {
    known.parameters[i].sigma = sigmas[i];
    known.parameters[i].value += sigmas[i] * normal(random);
    known.covariance[i * (size + 1)] = sigmas[i] * sigmas[i];
  }
  // Errors of the focal lengths are nearly one.
  constexpr double kAlike = 0.99;
  const double both = kAlike * sigmas[0] * sigmas[1];
  known.covariance[1] = known.covariance[size] = both;
  const double first = (known.parameters[0].value - camera.parameters()[0]) / sigmas[0];
  known.parameters[1].value =
      camera.parameters()[1] +
      sigmas[1] * (kAlike * first + std::sqrt(1 - kAlike * kAlike) * normal(random));
  return known;
}

struct Known {
  scenes::SimulatedRig rig;
  std::vector<RigCameraViews> seen;
};

// Three cameras that look at one place from the same side.
Known make_known(int instants, Random& random) {
  Known all = {scenes::stereo_rig(random), {}};
  all.rig.cameras.push_back(scenes::random_camera("brown5", random));
  const Eigen::Vector3d from(-0.15, 0.2, 0.05);
  const Eigen::Vector3d forward = (all.rig.middle - from).normalized();
  all.rig.world_from_camera.push_back({rotation_between(Eigen::Vector3d::UnitZ(), forward), from});
  all.seen = scenes::seen_by(all.rig, instants, 0.7, random);
  for (std::size_t c = 0; c < all.seen.size(); ++c) {
    all.seen[c].calibration =
        known_before(all.rig.cameras[c], all.seen[c].calibration.camera, random);
  }
  return all;
}

// e^T C^-1 e of the intrinsics of a calibration.
double lens_square(const Calibration& found, const Camera& truth) {
  const auto n = static_cast<Eigen::Index>(found.parameters.size());
  Eigen::VectorXd e(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    e[i] = found.parameters[k].value - truth.parameters()[k];
  }
  const Eigen::Map<const Eigen::MatrixXd> covariance(found.covariance.data(), n, n);
  return e.dot(solve_symmetric(covariance, e).col(0)) / static_cast<double>(n);
}

struct Way {
  const char* name;
  RigIntrinsics intrinsics;
  int instants;

  friend std::ostream& operator<<(std::ostream& out, const Way& way) { return out << way.name; }
};
class Lenses : public ::testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Rig, Lenses,
                         ::testing::Values(Way{"Held", RigIntrinsics::kHeld, 20},
                                           Way{"Prior", RigIntrinsics::kPrior, 20},
                                           Way{"Free", RigIntrinsics::kFree, 60}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST_P(Lenses, AreAsWellKnownAsTheySay) {
  const Way& way = GetParam();
  const int trials = scenes::full_count() ? 500 : 40;
  Random random(31);
  double places = 0;
  double lenses = 0;
  double focal = 0;
  double turns = 0;
  int count = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Known known = make_known(way.instants, random);
    RigOptions options;
    options.intrinsics = way.intrinsics;
    const auto found = solve_rig(known.seen, options);
    ASSERT_TRUE(found) << trial << ": " << found.error().message;
    const auto& cameras = found->rig.cameras;
    const SE3 world_from_first = known.rig.world_from_camera.front();
    for (std::size_t c = 0; c < cameras.size(); ++c) {
      const Camera& truth = known.rig.cameras[c];
      lenses += lens_square(cameras[c].calibration, truth);
      focal += std::abs(cameras[c].calibration.parameters[0].value / truth.fx() - 1);
      if (c == 0) continue;
      const auto error = scenes::place_error(
          cameras[c], world_from_first.inverse() * known.rig.world_from_camera[c]);
      places += error.square;
      turns += error.turn;
      ++count;
    }
  }
  const double of_places = places / count;
  const double of_lenses = lenses / (3 * trials);
  std::cout << way << ": e^T C^-1 e / n of the places " << of_places << ", of the lenses "
            << of_lenses << ", focal lengths off by " << 100 * focal / (3 * trials)
            << " %, turns by " << 1e3 * turns / count << " mrad\n";
  const double luck = scenes::full_count() ? 0.1 : 0.25;
  EXPECT_NEAR(of_places, 1, luck);
  EXPECT_NEAR(of_lenses, 1, luck);
}

bool says(const RigSolution& solution, std::string_view words) {
  return std::ranges::any_of(solution.remarks, [&](const std::string& remark) {
    return remark.find(words) != std::string::npos;
  });
}

// From files without sigmas, as other programs write them, and from lenses that are far off.
TEST(RigLenses, AreFoundFromRoughOnes) {
  Random random(5);
  Known known = make_known(60, random);
  RigOptions options;
  options.intrinsics = RigIntrinsics::kFree;
  const auto near = solve_rig(known.seen, options);
  ASSERT_TRUE(near) << near.error().message;
  for (RigCameraViews& camera : known.seen) {
    Calibration& rough = camera.calibration;
    rough.covariance.clear();
    for (Parameter& p : rough.parameters) {
      p.sigma.reset();
      if (p.name[0] == 'f') p.value *= 1.06;
      if (p.name[0] == 'c') p.value += 25;
      if (p.name == "k1") p.value = 0;
    }
  }
  const auto far = solve_rig(known.seen, options);
  ASSERT_TRUE(far) << far.error().message;
  EXPECT_NEAR(far->rig.rms.value(), near->rig.rms.value(), 1e-5);
  for (std::size_t c = 0; c < 3; ++c) {
    const Calibration& a = near->rig.cameras[c].calibration;
    const Calibration& b = far->rig.cameras[c].calibration;
    EXPECT_NEAR(a.parameters[0].value, b.parameters[0].value, 0.05 * a.parameters[0].sigma.value());
    EXPECT_NEAR(a.parameters[0].sigma.value(), b.parameters[0].sigma.value(),
                0.01 * a.parameters[0].sigma.value());
    EXPECT_TRUE(b.expected_error) << "what corners covered is known";
  }
}

// What repeats in all pictures is as much a part of the errors as the calibrations say.
TEST(RigLenses, HaveTheSystematicErrorsOfTheCalibrations) {
  Random random(14);
  Known known = make_known(40, random);
  RigOptions options;
  options.intrinsics = RigIntrinsics::kFree;
  const auto noise = solve_rig(known.seen, options);
  known.seen[2].calibration.systematic = 0.75;
  const auto all = solve_rig(known.seen, options);
  ASSERT_TRUE(noise && all);
  const auto sigma = [](const RigSolution& of) {
    return of.rig.cameras[1].calibration.parameters[0].sigma.value();
  };
  EXPECT_NEAR(sigma(*all), 2 * sigma(*noise), 1e-6 * sigma(*all));
  EXPECT_NEAR(all->rig.cameras[1].covariance[0], 4 * noise->rig.cameras[1].covariance[0],
              1e-5 * all->rig.cameras[1].covariance[0]);
}

// Views that one camera has by itself tell of its lens.
TEST(RigLenses, AreToldByViewsOfOneCamera) {
  Random random(15);
  Known known = make_known(30, random);
  RigOptions options;
  options.intrinsics = RigIntrinsics::kFree;
  const auto fewer = solve_rig(known.seen, options);
  const auto more = scenes::seen_by(known.rig, 90, 0.7, random);
  for (View view : more[0].views) {
    view.observation.timestamp += 1'000'000'000'000;
    known.seen[0].views.push_back(std::move(view));
  }
  const auto all = solve_rig(known.seen, options);
  ASSERT_TRUE(all && fewer);
  EXPECT_LT(all->rig.cameras[0].calibration.parameters[0].sigma.value(),
            0.9 * fewer->rig.cameras[0].calibration.parameters[0].sigma.value());
}

// Boards that are parallel to the image, all as far away, tell no focal length.
TEST(RigLenses, StayWhereViewsDoNotTellThem) {
  Random random(6);
  Known known = make_known(1, random);
  known.rig.world_from_camera[1] = {Eigen::Matrix3d::Identity(), {0.1, 0, 0}};
  known.rig.cameras.pop_back();
  known.rig.world_from_camera.pop_back();
  known.rig.reach = {0.1, 0.06, 0};
  known.seen.pop_back();
  for (std::size_t c = 0; c < 2; ++c) {
    known.seen[c].views.clear();
    for (int n = 0; n < 12; ++n) {
      const SE3 board = {Eigen::Matrix3d::Identity(), {-0.12 + 0.012 * n, -0.08 + 0.004 * n, 0.6}};
      const SE3 pose = known.rig.world_from_camera[c].inverse() * board;
      View view = scenes::observe(known.rig.cameras[c], known.rig.board, pose, 0.1, random);
      view.observation.timestamp = static_cast<std::uint64_t>(n + 1) * 1'000'000'000;
      known.seen[c].views.push_back(std::move(view));
    }
  }
  RigOptions options;
  options.intrinsics = RigIntrinsics::kFree;
  const auto found = solve_rig(known.seen, options);
  ASSERT_TRUE(found) << found.error().message;
  // How well they are known is then a part of the places, as where nothing is estimated.
  const auto held = solve_rig(known.seen);
  ASSERT_TRUE(held);
  for (std::size_t i = 0; i < 36; i += 7) {
    const double variance = held->rig.cameras[1].covariance[i];
    EXPECT_NEAR(found->rig.cameras[1].covariance[i], variance, 1e-3 * variance) << i;
  }
  EXPECT_TRUE(says(*found, "do not tell its focal length"));
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(found->rig.cameras[c].calibration.parameters[0].value,
              known.seen[c].calibration.parameters[0].value);
  }
}

TEST(RigLenses, OfWhichNothingIsKnownAreHeldWithAPrior) {
  Random random(9);
  Known known = make_known(20, random);
  Calibration& first = known.seen[0].calibration;
  first = known.rig.cameras[0].to_calibration();
  first.camera = "cam0";
  RigOptions options;
  options.intrinsics = RigIntrinsics::kPrior;
  const auto found = solve_rig(known.seen, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(says(*found, "'cam0' stay as they are"));
  EXPECT_FALSE(says(*found, "'cam1'"));
  EXPECT_EQ(found->rig.cameras[0].calibration.parameters[0].value, first.parameters[0].value);
  EXPECT_NE(found->rig.cameras[1].calibration.parameters[0].value,
            known.seen[1].calibration.parameters[0].value);
}

// A file that is surer of itself than it may be, and an aspect that was held.
TEST(RigLenses, ContradictAFileThatIsTooSure) {
  Random random(10);
  Known known = make_known(30, random);
  Calibration& sure = known.seen[1].calibration;
  sure = known.rig.cameras[1].to_calibration();
  sure.camera = "cam1";
  for (std::size_t i = 0; i < 2; ++i) {
    sure.parameters[i].value = 1.02 * known.rig.cameras[1].fx();
    sure.parameters[i].sigma = 1;
  }
  sure.covariance = {1, 1, 1, 1};
  RigOptions options;
  options.intrinsics = RigIntrinsics::kPrior;
  const auto found = solve_rig(known.seen, options);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(says(*found, "contradict what the calibration of 'cam1'"));
  const auto& own = found->rig.cameras[1].calibration.parameters;
  EXPECT_NEAR(own[0].value, own[1].value, 1e-9);
  EXPECT_FALSE(own[2].sigma);
  options.mode = RigMode::kFloor;
  const auto floor = solve_rig(known.seen, options);
  ASSERT_FALSE(floor);
  EXPECT_NE(floor.error().message.find("stay as they are"), std::string::npos);
}

bool names_its_lens(const RigSolution& solution, const std::string& camera) {
  return std::ranges::any_of(solution.remarks, [&](const std::string& remark) {
    return remark.find("The views of '" + camera + "' contradict its intrinsics") == 0;
  });
}

// A rig with the calibrations of its cameras exchanged fits its views nearly as well, and one with
// a lens that was turned: nothing else says that it is far off.
TEST(LensesThatAreOthers, AreTold) {
  const int trials = scenes::full_count() ? 200 : 20;
  int false_alarms = 0;
  int cameras = 0;
  int told = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Random random(500 + static_cast<unsigned>(trial));
    const Known known = make_known(15, random);
    for (const RigIntrinsics way : {RigIntrinsics::kHeld, RigIntrinsics::kPrior}) {
      RigOptions options;
      options.intrinsics = way;
      const auto right = solve_rig(known.seen, options);
      ASSERT_TRUE(right.has_value()) << right.error().message;
      for (const RigCameraViews& one : known.seen) {
        ++cameras;
        false_alarms += names_its_lens(*right, one.calibration.camera) ? 1 : 0;
      }
      // By 3 % of its focal length, which was known to .4 %.
      auto turned = known.seen;
      for (std::size_t i : {0U, 1U}) {
        Parameter& focal = turned[1].calibration.parameters[i];
        focal.value = 1.03 * known.rig.cameras[1].parameters()[i];
      }
      const auto wrong = solve_rig(turned, options);
      ASSERT_TRUE(wrong.has_value()) << wrong.error().message;
      told += names_its_lens(*wrong, turned[1].calibration.camera) ? 1 : 0;
    }
  }
  std::cout << false_alarms << " of " << cameras << " lenses doubted, " << told << " of "
            << 2 * trials << " told\n";
  EXPECT_LE(false_alarms, 0.02 * cameras);
  EXPECT_GE(told, 0.9 * 2 * trials);
}

}  // namespace
}  // namespace calvin
