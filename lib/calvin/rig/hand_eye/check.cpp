// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What the motions of the hand determine, and the mistakes that files of poses are known for.

#include "calvin/rig/hand_eye/check.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/symmetric.hpp"

namespace calvin::rig {

namespace {

using Sightings = std::vector<Sighting>;

constexpr double kLeastRmsTurn = 0.02;  // rad, root mean square
constexpr double kOpen = 0.3;    // of the motion: loops that are left open by more do not close
constexpr double kPoor = 0.03;   // from where on another reading is looked for
constexpr double kBetter = 0.2;  // of what is left open: another reading is the right one

// What is left of the loops, as a part of the motions that they are made of.
double open_part(const HandEyeStart& start, const HandMotion& motion) {
  return std::max(start.turn / motion.turn,
                  start.place / (motion.way + motion.turn * motion.distance));
}

void for_each_pose(Sightings& all, SE3 (*change)(const SE3&)) {
  for (Sighting& s : all) s.base_from_hand = change(s.base_from_hand);
}

SE3 with_w_first(const SE3& pose) {
  const Eigen::Quaterniond q(pose.rotation);
  const Eigen::Quaterniond read(q.x(), q.y(), q.z(), q.w());  // w x y z were taken for x y z w
  return {read.toRotationMatrix(), pose.translation};
}

SE3 mirrored(const SE3& pose) {
  const Eigen::DiagonalMatrix<double, 3> mirror(1, 1, -1);
  return {mirror * pose.rotation * mirror, mirror * pose.translation};
}

// One later: every picture gets the pose of the one before.
Sightings shifted(const Sightings& all, std::ptrdiff_t by) {
  Sightings some;
  for (std::ptrdiff_t v = 0; v < std::ssize(all); ++v) {
    const std::ptrdiff_t from = v + by;
    if (from < 0 || from >= std::ssize(all)) continue;
    some.push_back(all[static_cast<std::size_t>(v)]);
    some.back().base_from_hand = all[static_cast<std::size_t>(from)].base_from_hand;
  }
  return some;
}

// Another way to read a file of poses, and what to tell whoever has given it.
struct Reading {
  Sightings (*read)(Sightings);
  bool free_scale;
  const char* advice;
};

constexpr Reading kReadings[] = {
    {[](Sightings all) {
       for_each_pose(all, [](const SE3& pose) { return pose.inverse(); });
       return all;
     },
     false,
     "They would if each pose was inverted: either the file has hand_from_base, or the set-up is "
     "the other one (eye-in-hand: the camera is on the hand; eye-to-hand: the board is)."},
    {[](Sightings all) {
       for_each_pose(all, with_w_first);
       return all;
     },
     false,
     "They would if the quaternions had w first: put a line '# x y z qw qx qy qz' before the first "
     "pose."},
    {[](Sightings all) {
       for_each_pose(all, mirrored);
       return all;
     },
     false,
     "They would if the frames of the robot were left-handed: change the sign of z, qx and qy in "
     "every pose."},
    {[](Sightings all) {
       for_each_pose(all, [](const SE3& pose) {
         return SE3{pose.rotation.transpose(), pose.translation};
       });
       return all;
     },
     false,
     "They would if the rotations were inverted and the places as they are: change the sign of qw "
     "in every pose, or transpose the matrices."},
    {[](Sightings all) {
       const Sightings given = all;
       for (std::size_t v = 0; v < all.size(); ++v) {
         all[v].base_from_hand = given[all.size() - 1 - v].base_from_hand;
       }
       return all;
     },
     false, "They would in the reverse order: sort poses and pictures alike."},
    {[](Sightings all) { return shifted(all, 1); }, false,
     "They would if each picture had the pose of the next line: one line is too many at the "
     "beginning, or one picture is missing there."},
    {[](Sightings all) { return shifted(all, -1); }, false,
     "They would if each picture had the pose of the line before: one picture is too many at the "
     "beginning, or one line is missing there."},
    {[](Sightings all) { return all; }, true,
     "They would if the robot's lengths were {:.4g} times those of the board: give the poses in "
     "metres, and the size of the board as it was measured."},
};

// The advice of the reading that leaves less than `open` of the loops open; empty where none does.
std::string advice(const Sightings& sightings, EyeSetup setup, double open) {
  std::string best;
  for (const Reading& reading : kReadings) {
    const Sightings other = reading.read(sightings);
    const auto start = find_start(other, setup, reading.free_scale);
    // Two loops close whatever they are.
    if (!start || other.size() < 4) continue;
    const double now = open_part(*start, motion_of(other));
    if (now >= open) continue;
    open = now;
    best = reading.free_scale ? fmt::format(fmt::runtime(reading.advice), start->places.scale)
                              : reading.advice;
  }
  return best;
}

}  // namespace

Status check_poses(const std::vector<Pose>& base_from_hand) {
  const auto is_far = [](double x) { return !(std::abs(x) <= 1e6); };
  for (std::size_t i = 0; i < base_from_hand.size(); ++i) {
    if (std::ranges::any_of(base_from_hand[i].rotation, is_far) ||
        std::ranges::any_of(base_from_hand[i].translation, is_far)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("Pose {} of the robot is not finite, or out of range (1e6 m, "
                                    "1e6 rad).",
                                    i + 1));
    }
  }
  return {};
}

Status check_noise(const HandEyeTask& task) {
  const auto is_wrong = [](const std::optional<double>& sigma) {
    return sigma && !(*sigma > 0 && *sigma < 1e3);
  };
  if (!is_wrong(task.turn_sigma) && !is_wrong(task.place_sigma)) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    "The noise of a robot is more than 0 and less than 1000 (rad, m).");
}

Status check_one_board(const std::vector<BoardView>& views) {
  const bool several = std::ranges::any_of(
      views, [&](const BoardView& v) { return v.board != views.front().board; });
  if (!several) return {};
  return make_error(ErrorCode::kInvalidArgument,
                    "The views show several boards: give those of one.");
}

Status check_enough(const std::vector<BoardView>& views) {
  constexpr std::size_t kFewest = 3;
  if (views.size() >= kFewest) return {};
  return make_error(ErrorCode::kDegenerate,
                    fmt::format("{} views show the board with a pose of the robot, and {} are the "
                                "least: take ten or more, the hand turned about several axes.",
                                views.size(), kFewest));
}

Status check_turns(const Sightings& sightings, EyeSetup setup, double turn_sigma) {
  if (motion_of(sightings).turn < kLeastRmsTurn) {
    return make_error(ErrorCode::kDegenerate,
                      "The hand of the robot was never turned, so that the place of the camera "
                      "could be any: turn the hand between the pictures, by 20 degrees and more, "
                      "about two axes or more.");
  }
  // The place of the camera shows by what the turns of the hand do to it. A direction that all
  // turns leave as it is, but for their noise, is one in which the place could be any.
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  std::vector<Eigen::Matrix3d> turns;
  for (const Sighting& s : sightings) {
    const Eigen::Matrix3d& hand = s.base_from_hand.rotation;
    turns.emplace_back(setup == EyeSetup::kInHand ? hand.transpose() : hand);
    mean += turns.back() / static_cast<double>(sightings.size());
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& turn : turns) {
    sum += (turn - mean).transpose() * (turn - mean);
  }
  // Of noise alone the sum over its variance is chi^2 with two degrees for each turn but the mean.
  constexpr double kSignificant = 3;  // sigmas
  const double turned = static_cast<double>(sightings.size() - 1);
  const double by_noise =
      turn_sigma * turn_sigma * (2 * turned + kSignificant * 2 * std::sqrt(turned));
  const auto eigen = symmetric_eigen(sum);
  if (eigen && eigen->values(0) > by_noise + 1e-12) return {};
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("The hand of the robot was turned about one axis only, but for {:.2g} degrees of "
                  "noise in its poses, so that the place of the camera along that axis could be "
                  "any: take some more pictures with the hand turned about another axis, by 20 "
                  "degrees and more.",
                  turn_sigma * 180 / std::numbers::pi));
}

// With P = mount_from_carrier, t_P = R_m s t_c + t_m - R_P t_b has the size s of the board only
// where t_P is more than what some t_m and t_b explain.
Status check_lengths(const Sightings& sightings, EyeSetup setup) {
  constexpr double kLeast = 0.01;  // of the way that a turn moves the board before the camera
  const auto rows = 3 * static_cast<Eigen::Index>(sightings.size());
  Eigen::MatrixXd by_places(rows, 6);
  Eigen::MatrixXd ways(rows, 1);
  for (Eigen::Index at = 0; at < rows; at += 3) {
    const SE3& hand = sightings[static_cast<std::size_t>(at / 3)].base_from_hand;
    const SE3 p = setup == EyeSetup::kInHand ? hand.inverse() : hand;
    by_places.middleRows<3>(at) << Eigen::Matrix3d::Identity(), -p.rotation;
    ways.middleRows<3>(at) = p.translation;
  }
  const Eigen::MatrixXd left = ways - product(by_places, least_squares(by_places, ways).x);
  const double way = left.norm() / std::sqrt(static_cast<double>(sightings.size()));
  const HandMotion motion = motion_of(sightings);
  if (way > kLeast * motion.turn * motion.distance) return {};
  return make_error(
      ErrorCode::kDegenerate,
      "The hand of the robot was turned about one point only, so that its motions say "
      "nothing of the size of the board: move it between the pictures too, by a "
      "tenth of its distance from the board and more, or measure the board and hold "
      "its pitch.");
}

Status check_loops(const std::optional<HandEyeStart>& start, const Sightings& sightings,
                   EyeSetup setup) {
  const double open = start ? open_part(*start, motion_of(sightings)) : 1;
  if (open < kPoor) return {};
  const std::string other = advice(sightings, setup, kBetter * open);
  if (other.empty() && open < kOpen) return {};
  return make_error(
      ErrorCode::kDegenerate,
      fmt::format("The poses of the robot do not go with the pictures: {:.0f} % of the motion is "
                  "left over. {}",
                  100 * std::min(open, 1.0),
                  other.empty()
                      ? "See whether each line is the pose of base_from_hand (x y z qx qy "
                        "qz qw, m) when its picture was taken, and the board is the one "
                        "that was given."
                      : other));
}

}  // namespace calvin::rig
