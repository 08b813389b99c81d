// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A hand that holds a board before a camera: of who does what the picture asks for, about, and of
// who does as he likes.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include "calvin/session/guidance/board_placement.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

class SimulatedHand {
 public:
  static constexpr double kFrame = 1.0 / 15;  // s

  SimulatedHand(const Camera& truth, Random& random)
      : truth_(truth), placement_(kBoard, truth_), random_(random) {
    const BoardArea area = kBoard.outline();
    middle_ = {(area.left + area.right) / 2, (area.top + area.bottom) / 2, 0};
  }
  SimulatedHand(const SimulatedHand&) = delete;
  SimulatedHand& operator=(const SimulatedHand&) = delete;

  // Goes where the board is wanted, not exactly and with a hand that trembles, holds it there for
  // 1.5 s at most, looks up half a second after a view was taken. `wanted()`: an optional pose;
  // `show(pose, now)`: whether a view of it was taken; `is_enough()`: ends it, as 180 s do.
  template <typename Wanted, typename Show, typename IsEnough>
  void follow(Wanted wanted, Show show, IsEnough is_enough) {
    Grip from = grip_at(*placement_.pose_at(placement_.middle(), 0.3, {0.05, 0.1, 0.05}));
    Grip to = from;
    double begun = 0;
    double there = 0;
    double wait = 1.5;
    for (double now = kFrame; now < 180 && !is_enough(); now += kFrame) {
      if (now > wait) {
        const std::optional<SE3> pose = wanted();
        from = std::exchange(to, about(pose ? *pose : middle_pose()));
        begun = now;
        there = now + 0.8 + 1.2 * (to.place - from.place).norm() / from.place.norm();
        wait = there + 1.5;
      }
      const double shake = now < there ? 1e-3 : 2e-5;
      if (show(pose_of(between(from, to, (now - begun) / (there - begun)), shake), now)) {
        wait = now + 0.5;
      }
    }
  }

  // Anywhere in the picture, tilted 0 to 45 degrees.
  SE3 anywhere() {
    for (;;) {
      const double tilt = draw(0, std::numbers::pi / 4);
      const double side = draw(0, 2 * std::numbers::pi);
      const ImageSize size = truth_.image_size();
      const auto pose =
          placement_.pose_at({draw(0, size.width), draw(0, size.height)}, draw(0.3, 0.9),
                             {tilt * std::cos(side), tilt * std::sin(side), draw(-0.3, 0.3)});
      if (pose && placement_.is_inside(*pose)) return *pose;
    }
  }

 private:
  // Where the middle of the board is, and how it is turned.
  struct Grip {
    Eigen::Vector3d place;
    Eigen::Quaterniond turn;
  };

  double draw(double low, double high) { return uniform(random_, low, high); }
  Eigen::Vector3d tremble(double size) {
    std::normal_distribution<double> normal(0, size);
    const double x = normal(random_);
    const double y = normal(random_);
    return {x, y, normal(random_)};
  }
  SE3 middle_pose() { return placement_.pose_at(placement_.middle(), 0.4, tremble(0.3)).value(); }
  [[nodiscard]] Grip grip_at(const SE3& pose) const {
    return {pose * middle_, Eigen::Quaterniond(pose.rotation)};
  }
  Grip about(const SE3& pose) {
    Grip grip = grip_at(pose);
    const double distance = grip.place.norm();
    grip.place += distance * tremble(0.025) + distance * Eigen::Vector3d(0, 0, draw(-0.1, 0.1));
    grip.turn = Eigen::Quaterniond(exp_so3(tremble(0.1))) * grip.turn;
    return grip;
  }
  // The smoothest way from rest to rest (T. Flash, N. Hogan, The Coordination of Arm Movements,
  // J. Neuroscience 5(7), 1985).
  static Grip between(const Grip& from, const Grip& to, double part) {
    const double t = std::clamp(part, 0.0, 1.0);
    const double way = t * t * t * (10 - 15 * t + 6 * t * t);
    return {from.place + way * (to.place - from.place), from.turn.slerp(way, to.turn)};
  }
  SE3 pose_of(const Grip& grip, double shake) {
    const Eigen::Matrix3d turn = grip.turn.toRotationMatrix();
    return {turn, grip.place + grip.place.norm() * tremble(shake) - turn * middle_};
  }

  const Camera& truth_;
  BoardPlacement placement_;
  Random& random_;
  Eigen::Vector3d middle_;
};

}  // namespace calvin::scenes
