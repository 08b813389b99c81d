// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A real robot with a camera on its wrist: the loops close no worse than by other joint fits, which
// Ceres solves with unknowns of its own, and the sigmas cover what is left of them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calvin/detect/detector.hpp"
#include "calvin/io/robot_poses.hpp"
#include "calvin/rig/hand_eye.hpp"
#include "calvin/rig/hand_eye/loop.hpp"
#include "calvin/rig/strobl/solve_strobl.hpp"
#include "calvin/solve/pose.hpp"
#include "calvin/solve/solve.hpp"
#include "ceres_hand_eye.hpp"

namespace calvin {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr const char* kDots = "dots:10x10:25.4mm:big=0.0";

std::filesystem::path folder() {
  const char* data = std::getenv("CALVIN_DATA");
  const auto path = std::filesystem::path(data == nullptr ? "" : data) / "circles-rct10x10";
  return data != nullptr && std::filesystem::is_directory(path) ? path : std::filesystem::path();
}

// The numbers of a file of lines "name: number", in their order.
std::string numbers_in(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string name;
  std::string number;
  std::string line;
  while (in >> name >> number) line += number + ' ';
  return line;
}

struct Robot {
  RigCameraViews camera;
  std::vector<Pose> base_from_hand;
};

Robot read_robot(const std::filesystem::path& from) {
  Robot robot;
  const Board board = parse_board(kDots).value();
  const auto detector = make_detector(board).value();
  std::string poses;
  for (int i = 0; i < 8; ++i) {
    const std::string number = std::to_string(i);
    const cv::Mat image = cv::imread((from / (number + ".png")).string(), cv::IMREAD_GRAYSCALE);
    auto seen = detector->detect(
        {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step[0]), 1});
    seen.observation.timestamp = static_cast<std::uint64_t>(i);
    robot.camera.views.push_back({std::move(seen.observation), board});
    poses += numbers_in(from / "poses" / (number + ".yaml")) + '\n';
  }
  const auto parsed = parse_robot_poses(poses).value();
  for (const RobotPose& pose : parsed) {
    robot.base_from_hand.push_back(pose.base_from_hand);
  }
  return robot;
}

// What is left of the loops, by the corners of each view alone: root mean squares.
struct Loops {
  double turn = 0;   // rad
  double place = 0;  // m
};
Loops loops_by(const rig::HandEyePlaces& places, const Robot& robot) {
  const Camera camera = Camera::make(robot.camera.calibration).value();
  Loops loops;
  const auto count = static_cast<double>(robot.camera.views.size());
  for (std::size_t v = 0; v < robot.camera.views.size(); ++v) {
    const View& view = robot.camera.views[v];
    const SE3 pose = solve_pose(camera, view.board, view.observation).value();
    const rig::Vector6d error = rig::hand_error(rig::expected_hand(places, EyeSetup::kInHand, pose),
                                                to_se3(robot.base_from_hand[v]));
    loops.turn += error.head<3>().squaredNorm() / count;
    loops.place += error.tail<3>().squaredNorm() / count;
  }
  return {std::sqrt(loops.turn), std::sqrt(loops.place)};
}

// Without the corners that are far off what the others of their view say, for solvers that do not
// look for them.
Robot without_outliers(Robot robot, const HandEye& by) {
  const Camera camera = Camera::make(robot.camera.calibration).value();
  for (View& view : robot.camera.views) {
    const SE3 pose = solve_pose(camera, view.board, view.observation).value();
    Observation kept = view.observation;
    kept.ids.clear();
    kept.uv.clear();
    kept.sigma.clear();
    kept.velocity.clear();
    for (std::size_t i = 0; i < view.observation.ids.size(); ++i) {
      const int id = view.observation.ids[i];
      const Pixel uv = view.observation.uv[i];
      const double sigma = view.observation.sigma[i];
      const Pixel at =
          camera.project(pose * view.board.points()[static_cast<std::size_t>(id)]).value();
      if (std::hypot(at.u - uv.u, at.v - uv.v) > 3 * by.corner_factor * sigma) continue;
      kept.ids.push_back(id);
      kept.uv.push_back(uv);
      kept.sigma.push_back(sigma);
    }
    view.observation = std::move(kept);
  }
  return robot;
}

// Both parts by the noise of the robot.
double in_sigmas(const Loops& loops, const HandEye& by) {
  return std::sqrt((std::pow(loops.turn / by.robot_turn_sigma, 2) +
                    std::pow(loops.place / by.robot_place_sigma, 2)) /
                   6);
}

void print(const char* name, const Loops& loops, const rig::HandEyePlaces& places,
           const HandEye& by) {
  std::cout << name << ": loops " << loops.turn / kDegree << " degrees, " << 1e3 * loops.place
            << " mm, " << in_sigmas(loops, by) << " sigma per axis; camera at "
            << 1e3 * places.mount_from_camera.translation.transpose() << " mm\n";
}

// OpenCV's closed forms, which know no noise.
rig::HandEyePlaces by_opencv(const Robot& robot, cv::HandEyeCalibrationMethod method) {
  const Camera camera = Camera::make(robot.camera.calibration).value();
  std::vector<cv::Mat> turns[2];
  std::vector<cv::Mat> places[2];
  const auto add = [&](std::size_t to, const SE3& pose) {
    cv::Mat turn(3, 3, CV_64F);
    cv::Mat place(3, 1, CV_64F);
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) turn.at<double>(r, c) = pose.rotation(r, c);
      place.at<double>(r) = pose.translation(r);
    }
    turns[to].push_back(turn);
    places[to].push_back(place);
  };
  for (std::size_t v = 0; v < robot.camera.views.size(); ++v) {
    const View& view = robot.camera.views[v];
    add(0, to_se3(robot.base_from_hand[v]));
    add(1, solve_pose(camera, view.board, view.observation).value());
  }
  cv::Mat turn;
  cv::Mat place;
  cv::calibrateHandEye(turns[0], places[0], turns[1], places[1], turn, place, method);
  rig::HandEyePlaces found;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) found.mount_from_camera.rotation(r, c) = turn.at<double>(r, c);
    found.mount_from_camera.translation(r) = place.at<double>(r);
  }
  // The board where the views have it on average.
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  const auto count = static_cast<double>(robot.camera.views.size());
  for (std::size_t v = 0; v < robot.camera.views.size(); ++v) {
    const View& view = robot.camera.views[v];
    const SE3 board = to_se3(robot.base_from_hand[v]) * found.mount_from_camera *
                      solve_pose(camera, view.board, view.observation).value();
    sum += board.rotation;
    found.carrier_from_board.translation += board.translation / count;
  }
  found.carrier_from_board.rotation = closest_rotation(sum);
  return found;
}

class RealHandEye : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto from = folder();
    if (from.empty()) GTEST_SKIP() << "without CALVIN_DATA there is no circles-rct10x10";
    robot_ = read_robot(from);
    SolveOptions options;
    options.model = "brown4";
    auto solution = solve(robot_.camera.views, {640, 480}, options);
    ASSERT_TRUE(solution.has_value()) << solution.error().message;
    robot_.camera.calibration = std::move(solution->calibration);
    robot_.camera.calibration.camera = "wrist";
  }

  Robot robot_;
};

TEST_F(RealHandEye, ClosesItsLoopsNoWorseThanOtherJointFits) {
  const auto first = solve_hand_eye(robot_.camera, robot_.base_from_hand);
  ASSERT_TRUE(first.has_value()) << first.error().message;
  const Robot robot = without_outliers(robot_, first->result);
  const auto solved = solve_hand_eye(robot.camera, robot.base_from_hand);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const HandEye& found = solved->result;
  const rig::HandEyePlaces own = {to_se3(found.mount_from_camera), to_se3(found.carrier_from_board),
                                  1};
  const Loops loops = loops_by(own, robot);
  print("calvin", loops, own, found);
  std::cout << "  noise of the robot " << found.robot_turn_sigma / kDegree << " degrees, "
            << 1e3 * found.robot_place_sigma << " mm per axis; rms " << found.rms.value_or(0)
            << " px; scale " << found.scale.value().value << " +- " << found.scale.value().sigma
            << '\n';
  EXPECT_NEAR(found.loop_turn, loops.turn, 0.01 * loops.turn);
  EXPECT_NEAR(found.loop_place, loops.place, 0.01 * loops.place);

  // The same statistics with other unknowns by another solver: the same place.
  const formulas::RobotSigmas sigmas = {found.corner_factor, found.robot_turn_sigma,
                                        found.robot_place_sigma};
  const auto by_ceres = formulas::solve_by_ceres(robot.camera, robot.base_from_hand, sigmas, own);
  print("Ceres, jointly", loops_by(by_ceres, robot), by_ceres, found);
  EXPECT_LE(in_sigmas(loops, found), 1.01 * in_sigmas(loops_by(by_ceres, robot), found));
  const Eigen::Vector3d apart =
      by_ceres.mount_from_camera.translation - own.mount_from_camera.translation;
  for (int k = 0; k < 3; ++k) {
    const double sigma = std::sqrt(found.mount_covariance[static_cast<std::size_t>(7 * (3 + k))]);
    EXPECT_LT(std::abs(apart(k)), 0.01 * sigma);
  }

  // Poses that are taken for exact, as most joint fits do.
  const auto exact = formulas::solve_by_ceres(robot.camera, robot.base_from_hand, {1, 0, 0}, own);
  print("Ceres, exact poses", loops_by(exact, robot), exact, found);
  EXPECT_LE(in_sigmas(loops, found), in_sigmas(loops_by(exact, robot), found));

  for (const auto& [name, method] :
       {std::pair("OpenCV, Tsai", cv::CALIB_HAND_EYE_TSAI),
        std::pair("OpenCV, Park", cv::CALIB_HAND_EYE_PARK),
        std::pair("OpenCV, Daniilidis", cv::CALIB_HAND_EYE_DANIILIDIS)}) {
    const auto peer = by_opencv(robot, method);
    print(name, loops_by(peer, robot), peer, found);
  }
}

// Eight poses, turned about nearly one axis: along it the camera is hardly known, and that is said.
TEST_F(RealHandEye, HasSigmasThatCoverItsLoops) {
  const auto solved = solve_hand_eye(robot_.camera, robot_.base_from_hand);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  const HandEye& found = solved->result;
  EXPECT_EQ(found.poses, 8);
  EXPECT_LE(found.rms.value(), 0.25);
  for (const LoopError& loop : solved->loops) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_LT(std::abs(loop.turn[k]), 3.5 * found.robot_turn_sigma);
      EXPECT_LT(std::abs(loop.place[k]), 3.5 * found.robot_place_sigma);
    }
  }
  EXPECT_NEAR(in_sigmas({found.loop_turn, found.loop_place}, found), 1, 0.25);
  ASSERT_TRUE(found.scale.has_value());
  EXPECT_LT(std::abs(found.scale->value - 1), 3 * found.scale->sigma);
  ASSERT_FALSE(found.remarks.empty());
  EXPECT_NE(found.remarks.front().find("nearly one axis"), std::string::npos);
}

// They say less of the board than a ruler does, and are not taken for its size.
TEST_F(RealHandEye, TellsThatTheBoardIsToBeMeasured) {
  RobotCamera camera = {robot_.camera, {}};
  for (std::size_t v = 0; v < camera.seen.views.size(); ++v) camera.pose_of_view.push_back(v);
  const auto measured = solve_strobl({camera}, robot_.base_from_hand);
  ASSERT_FALSE(measured.has_value());
  EXPECT_NE(measured.error().message.find("measure the board"), std::string::npos)
      << measured.error().message;
  StroblOptions options;
  options.pitch_known = options.aspect_known = true;
  const auto solved = solve_strobl({camera}, robot_.base_from_hand, options);
  ASSERT_TRUE(solved.has_value()) << solved.error().message;
  EXPECT_LE(solved->hand_eye.rms.value(), 0.25);
}

}  // namespace
}  // namespace calvin
