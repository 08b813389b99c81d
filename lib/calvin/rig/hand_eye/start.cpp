// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Proposes turns of the camera by single motions of the hand (their axes are one axis in two
// frames: F. C. Park, B. J. Martin, IEEE Trans. Robotics and Automation 10(5), 1994), asks all
// sightings how well each fits, and refines the best ones.

#include "calvin/rig/hand_eye/start.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Core>

#include "calvin/geometry/dense.hpp"
#include "calvin/geometry/median.hpp"

namespace calvin::rig {

namespace {

constexpr double kLeastTurn = 0.01;  // rad, of the hand: less has no axis
constexpr double kMostTurn = 3.0;    // rad: near half a turn the sense of the axis is lost
constexpr double kSameTurn = 0.1;    // rad, between the turn of the hand and that of the camera
constexpr std::size_t kMotions = 6;  // from which turns are proposed
constexpr int kSpins = 24;           // proposals about the axis of a motion
constexpr std::size_t kMostSeeds = 96;
constexpr std::size_t kMostFits = 6;
constexpr double kSoft = 0.1;  // rad, and of the distance: from where on an error counts less
// How much better than another one a place has to be, in errors of one view that disagrees.
constexpr double kLead = 1.5;

SE3 mount_from_carrier(const Sighting& sighting, EyeSetup setup) {
  return setup == EyeSetup::kInHand ? sighting.base_from_hand.inverse() : sighting.base_from_hand;
}

struct Seed {
  Eigen::Matrix3d mount;  // turns
  Eigen::Matrix3d carrier;
  double cost = 0;
};

struct Candidate {
  HandEyePlaces places;
  std::vector<std::size_t> poses;
  double cost = 0;
};

// What errors of places are compared with, m. The robot's metres may be others than the board's.
double reach(const HandMotion& motion, bool free_scale) {
  return free_scale ? std::max(motion.distance, motion.way) : motion.distance;
}

class Search {
 public:
  Search(const std::vector<Sighting>& sightings, EyeSetup setup, bool free_scale)
      : sightings_(sightings),
        setup_(setup),
        free_scale_(free_scale),
        distance_(reach(motion_of(sightings), free_scale)) {
    for (const Sighting& s : sightings) mounts_.push_back(mount_from_carrier(s, setup));
    // The view with the fewest labellings has the labels of the board.
    const auto fewest = std::ranges::min_element(
        sightings, {}, [](const Sighting& s) { return s.poses.size() / s.tilts; });
    anchor_ = static_cast<std::size_t>(fewest - sightings.begin());
  }

  [[nodiscard]] std::optional<HandEyeStart> run() {
    std::vector<Candidate> all;
    for (const Seed& seed : seeds()) {
      constexpr int kFew = 4;
      Candidate candidate = first_places(seed);
      refine(candidate, kFew);
      all.push_back(std::move(candidate));
    }
    if (all.empty()) return std::nullopt;
    all = best_of(std::move(all));
    for (Candidate& candidate : all) {
      constexpr int kMany = 25;
      refine(candidate, kMany);
    }
    const Candidate& best = *std::ranges::min_element(all, {}, &Candidate::cost);
    HandEyeStart start{best.places, best.poses, 0, 0, true};
    set_errors(start);
    // Other places are judged by what is left at the best ones.
    soft_ = std::max(start.turn, start.place / distance_) * 2 + 1e-6;
    const double least = cost(best);
    start.is_decided = std::ranges::none_of(all, [&](const Candidate& other) {
      return is_elsewhere(other.places, best.places) && cost(other) < least + kLead;
    });
    return start;
  }

 private:
  // The sightings whose hands have turned most from that of the anchor.
  [[nodiscard]] std::vector<std::size_t> motions() const {
    std::vector<std::pair<double, std::size_t>> turns;
    for (std::size_t i = 0; i < mounts_.size(); ++i) {
      const double turn = log_so3(turn_to(i)).norm();
      if (turn > kLeastTurn && turn < kMostTurn) turns.emplace_back(-turn, i);
    }
    std::ranges::sort(turns);
    std::vector<std::size_t> some;
    for (std::size_t n = 0; n < std::min(turns.size(), kMotions); ++n) {
      some.push_back(turns[n].second);
    }
    return some;
  }

  [[nodiscard]] Eigen::Matrix3d turn_to(std::size_t i) const {
    return mounts_[i].rotation * mounts_[anchor_].rotation.transpose();
  }

  [[nodiscard]] std::vector<Seed> seeds() const {
    std::vector<Seed> all;
    for (const std::size_t i : motions()) {
      const Eigen::Vector3d of_hand = log_so3(turn_to(i));
      for (std::size_t tilt = 0; tilt < sightings_[anchor_].tilts; ++tilt) {
        const BoardPose& first = sightings_[anchor_].poses[tilt];
        for (const BoardPose& second : sightings_[i].poses) {
          const Eigen::Vector3d of_camera = log_so3(second.camera_from_board.rotation *
                                                    first.camera_from_board.rotation.transpose());
          if (std::abs(of_hand.norm() - of_camera.norm()) > kSameTurn) continue;
          if (of_camera.norm() < kLeastTurn) continue;
          add_spins(of_hand, of_camera, first.camera_from_board.rotation, all);
        }
      }
    }
    std::ranges::stable_sort(all, {}, &Seed::cost);
    if (all.size() > kMostSeeds) all.resize(kMostSeeds);
    return all;
  }

  void add_spins(const Eigen::Vector3d& of_hand, const Eigen::Vector3d& of_camera,
                 const Eigen::Matrix3d& anchor, std::vector<Seed>& all) const {
    const Eigen::Matrix3d aligned = rotation_between(of_camera, of_hand);
    for (int spin = 0; spin < kSpins; ++spin) {
      const double angle = 2 * std::numbers::pi * spin / kSpins;
      Seed seed;
      seed.mount = exp_so3(of_hand.normalized() * angle) * aligned;
      seed.carrier = mounts_[anchor_].rotation.transpose() * seed.mount * anchor;
      for (std::size_t v = 0; v < mounts_.size(); ++v)
        seed.cost += std::min(turn_cost(v, seed), 0.5);
      all.push_back(seed);
    }
  }

  // The least squared chord between what the hand and the camera say, over the poses of a view.
  [[nodiscard]] double turn_cost(std::size_t v, const Seed& seed) const {
    const Eigen::Matrix3d expected = seed.mount.transpose() * mounts_[v].rotation * seed.carrier;
    double least = 8;
    for (const BoardPose& pose : sightings_[v].poses) {
      least = std::min(least, (pose.camera_from_board.rotation - expected).squaredNorm());
    }
    return least;
  }

  // Those of the least cost that are at different places.
  [[nodiscard]] std::vector<Candidate> best_of(std::vector<Candidate> all) const {
    std::ranges::stable_sort(all, {}, &Candidate::cost);
    std::vector<Candidate> best;
    for (Candidate& candidate : all) {
      if (best.size() == kMostFits) break;
      const bool is_new = std::ranges::all_of(best, [&](const Candidate& other) {
        return is_elsewhere(candidate.places, other.places);
      });
      if (is_new) best.push_back(std::move(candidate));
    }
    return best;
  }

  // Turns as they are, and the places that suit them: R_m s t_c + t_m - R_p t_b = t_p is linear.
  [[nodiscard]] Candidate first_places(const Seed& seed) const {
    Candidate candidate;
    candidate.places.mount_from_camera.rotation = seed.mount;
    candidate.places.carrier_from_board.rotation = seed.carrier;
    Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
    for (std::size_t v = 0; v < mounts_.size(); ++v) {
      const Eigen::Matrix3d expected = seed.mount.transpose() * mounts_[v].rotation * seed.carrier;
      const auto& poses = sightings_[v].poses;
      const auto best = std::ranges::min_element(poses, {}, [&](const BoardPose& pose) {
        return (pose.camera_from_board.rotation - expected).squaredNorm();
      });
      candidate.poses.push_back(static_cast<std::size_t>(best - poses.begin()));
      Eigen::Matrix<double, 3, 7> rows;
      rows << Eigen::Matrix3d::Identity(), -mounts_[v].rotation,
          seed.mount * best->camera_from_board.translation;
      Eigen::Vector3d known = mounts_[v].translation;
      if (!free_scale_) {
        known -= rows.col(6);
        rows.col(6).setZero();
      }
      normal += rows.transpose() * rows;
      right += rows.transpose() * known;
    }
    // A place that nothing determines stays near 0.
    normal.diagonal().array() += 1e-6;
    const Eigen::Matrix<double, 7, 1> places = solve_symmetric(normal, right);
    candidate.places.mount_from_camera.translation = places.head<3>();
    candidate.places.carrier_from_board.translation = places.segment<3>(3);
    if (free_scale_ && places(6) > 0) candidate.places.scale = places(6);
    return candidate;
  }

  // The squared error of one sighting in its pose, in units of kSoft.
  [[nodiscard]] double square(const Vector6d& error) const {
    return (error.head<3>().squaredNorm() + error.tail<3>().squaredNorm() / distance_ / distance_) /
           (soft_ * soft_);
  }
  [[nodiscard]] Vector6d error_of(const HandEyePlaces& places, std::size_t v,
                                  std::size_t pose) const {
    return hand_error(expected_hand(places, setup_, sightings_[v].poses[pose].camera_from_board),
                      sightings_[v].base_from_hand);
  }
  [[nodiscard]] double cost(const Candidate& candidate) const {
    double sum = 0;
    for (std::size_t v = 0; v < mounts_.size(); ++v) {
      sum += std::log1p(square(error_of(candidate.places, v, candidate.poses[v])));
    }
    return sum;
  }

  void choose_poses(Candidate& candidate) const {
    for (std::size_t v = 0; v < mounts_.size(); ++v) {
      double least = square(error_of(candidate.places, v, candidate.poses[v]));
      for (std::size_t p = 0; p < sightings_[v].poses.size(); ++p) {
        const double now = square(error_of(candidate.places, v, p));
        if (now < least) {
          least = now;
          candidate.poses[v] = p;
        }
      }
    }
  }

  // Gauss-Newton with weights by Cauchy's loss; each step chooses the poses of the views anew.
  void refine(Candidate& candidate, int steps) const {
    using Normal = Eigen::Matrix<double, kPlaceColumns, kPlaceColumns>;
    using Step = Eigen::Matrix<double, kPlaceColumns, 1>;
    Vector6d scale = Vector6d::Ones();
    scale.tail<3>() /= distance_;
    for (int step = 0; step < steps; ++step) {
      choose_poses(candidate);
      Normal normal = Normal::Zero();
      Step gradient = Step::Zero();
      for (std::size_t v = 0; v < mounts_.size(); ++v) {
        const LoopRows rows = loop_rows(candidate.places, setup_,
                                        sightings_[v].poses[candidate.poses[v]].camera_from_board,
                                        sightings_[v].base_from_hand);
        const double weight = 1 / (1 + square(rows.error));
        Eigen::Matrix<double, 6, kPlaceColumns> j = scale.asDiagonal() * rows.by_places;
        if (!free_scale_) j.col(kScaleColumn).setZero();
        normal += weight * j.transpose() * j;
        gradient += weight * j.transpose() * scale.asDiagonal() * rows.error;
      }
      normal.diagonal().array() += 1e-7 * normal.diagonal().maxCoeff();
      const Step move = -solve_symmetric(normal, gradient);
      if (!move.allFinite()) break;
      candidate.places = moved(candidate.places, move.data());
      if (!(candidate.places.scale > 0)) candidate.places.scale = 1;
      if (move.norm() < 1e-10) break;
    }
    candidate.cost = cost(candidate);
  }

  // Whether places are others, and not the same but for noise.
  [[nodiscard]] bool is_elsewhere(const HandEyePlaces& one, const HandEyePlaces& other) const {
    constexpr double kTurn = 0.15;      // rad
    constexpr double kDistance = 0.15;  // of the distance of the boards
    const SE3& a = one.mount_from_camera;
    const SE3& b = other.mount_from_camera;
    return log_so3(a.rotation * b.rotation.transpose()).norm() > kTurn ||
           (a.translation - b.translation).norm() > kDistance * distance_;
  }

  void set_errors(HandEyeStart& start) const {
    std::vector<double> turns;
    std::vector<double> ways;
    for (std::size_t v = 0; v < mounts_.size(); ++v) {
      const Vector6d error = error_of(start.places, v, start.poses[v]);
      turns.push_back(error.head<3>().norm());
      ways.push_back(error.tail<3>().norm());
    }
    start.turn = median_of(std::move(turns));
    start.place = median_of(std::move(ways));
  }

  const std::vector<Sighting>& sightings_;
  EyeSetup setup_;
  bool free_scale_;
  double distance_;  // m, of the boards, about
  double soft_ = kSoft;
  std::vector<SE3> mounts_;  // mount_from_carrier of each sighting
  std::size_t anchor_ = 0;
};

}  // namespace

Sighting sighting_of(const BoardView& view, const SE3& base_from_hand) {
  Sighting sighting;
  sighting.base_from_hand = base_from_hand;
  sighting.tilts = view.poses.size();
  for (const SE3& labelling : view.labellings) {
    for (const SE3& pose : view.poses) {
      sighting.poses.push_back({pose * labelling.inverse(), labelling});
    }
  }
  return sighting;
}

std::optional<HandEyeStart> find_start(const std::vector<Sighting>& sightings, EyeSetup setup,
                                       bool free_scale) {
  if (sightings.size() < 2) return std::nullopt;
  return Search(sightings, setup, free_scale).run();
}

HandMotion motion_of(const std::vector<Sighting>& sightings) {
  HandMotion motion;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::vector<double> distances;
  const auto count = static_cast<double>(sightings.size());
  for (const Sighting& s : sightings) {
    sum += s.base_from_hand.rotation;
    middle += s.base_from_hand.translation / count;
    distances.push_back(s.poses.front().camera_from_board.translation.norm());
  }
  const Eigen::Matrix3d mean = closest_rotation(sum);
  for (const Sighting& s : sightings) {
    motion.turn += log_so3(s.base_from_hand.rotation * mean.transpose()).squaredNorm() / count;
    motion.way += (s.base_from_hand.translation - middle).squaredNorm() / count;
  }
  motion.turn = std::sqrt(motion.turn);
  motion.way = std::sqrt(motion.way);
  motion.distance = median_of(std::move(distances));
  return motion;
}

}  // namespace calvin::rig
