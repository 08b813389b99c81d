// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The pose of the board at any time for each kind of motion, placed so that the board lies in the
// image.

#include "calvin/synth/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

#include "calvin/synth/random.hpp"
#include "calvin/target/kinds.hpp"

namespace calvin {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr double kNearLight = 0.8;  // m, from the camera
constexpr double kFarLight = 2.4;
constexpr double kTiltOfWand = 0.8;  // rad, out of the image
constexpr double kBorder = 0.04;     // of the image, where no light goes
constexpr double kGrazing = 0.2;  // sine of the least angle between a line of sight and the board

// Turns the optical axis to the direction `ray` by the shortest way.
Eigen::Matrix3d turn_axis_to(const Eigen::Vector3d& ray) {
  return rotation_between(Eigen::Vector3d::UnitZ(), ray);
}

// What is brought into the image: all of the board, or the middle of a grid that goes on beyond.
BoardArea framed_area(const Board& board) {
  constexpr double kHalfWidth = 12.5;  // pitches
  constexpr double kHalfHeight = 8.5;
  const auto* grid = board.as<UnboundedGrid>();
  if (grid == nullptr) return board.outline();
  const double middle = (UnboundedGrid::kSide - 1) / 2.0;
  return {(middle - kHalfWidth) * grid->pitch, (middle - kHalfHeight) * grid->pitch,
          (middle + kHalfWidth) * grid->pitch, (middle + kHalfHeight) * grid->pitch};
}

// Places along the edge of what is brought into the image, in the board frame.
std::vector<Eigen::Vector3d> outline(const Board& board) {
  std::vector<Eigen::Vector3d> points(16);
  const BoardArea area = framed_area(board);
  const double width = area.width();
  const double height = area.height();
  for (std::size_t i = 0; i < 4; ++i) {
    const double s = static_cast<double>(i) / 4;
    points[i] = {s * width, 0, 0};
    points[4 + i] = {width, s * height, 0};
    points[8 + i] = {(1 - s) * width, height, 0};
    points[12 + i] = {0, (1 - s) * height, 0};
  }
  for (auto& p : points) p += Eigen::Vector3d(area.left, area.top, 0);
  return points;
}

// All corners of all squares, or all control points and those that would go on around them; all
// control points of a board without a grid; the edge of what is shown of a grid that goes on beyond
// the image. In the board frame.
std::vector<Eigen::Vector3d> lattice(const Board& board) {
  const auto grid = board.grid();
  if (!grid) return board.points();
  if (board.as<UnboundedGrid>() != nullptr) return outline(board);
  std::vector<Eigen::Vector3d> points;
  for (int row = -1; row <= grid->rows; ++row) {
    for (int col = -1; col <= grid->cols; ++col) {
      points.emplace_back(grid->distance_to(col), grid->distance_to(row), 0);
    }
  }
  return points;
}

Eigen::Vector3d board_centre(const Board& board) {
  const BoardArea area = framed_area(board);
  return {(area.left + area.right) / 2, (area.top + area.bottom) / 2, 0};
}

// Radius of the circle around what is brought into the image, m.
double board_radius(const Board& board) {
  const BoardArea area = framed_area(board);
  return std::hypot(area.width(), area.height()) / 2;
}

// A smooth path within -1..1: three slow waves of unrelated periods.
double wander(double seconds, std::uint64_t seed, std::uint64_t stream) {
  synth::Uniform random(seed, stream);
  double sum = 0;
  for (const double weight : {0.5, 0.3, 0.2}) {
    const double frequency = random(0.04, 0.1) / weight;  // 0.08 to 0.5 Hz
    const double phase = random(0, 2 * kPi);
    sum += weight * std::sin(2 * kPi * frequency * seconds + phase);
  }
  return sum;
}

}  // namespace

Motion::Motion(MotionKind kind, const Camera& camera, const Board& board, std::uint64_t seed)
    : kind_(kind),
      camera_(camera),
      board_(board),
      seed_(seed),
      outline_(outline(board)),
      lattice_(lattice(board)) {
  const ImageSize size = camera.image_size();
  centre_ = {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
  if (!camera.unproject(centre_)) centre_ = {camera.cx(), camera.cy()};
  // The distance at which the circle around the board would fill the shorter side, by the scale of
  // the image at its centre.
  const double f = std::sqrt(camera.fx() * camera.fy());
  unit_distance_ = 2 * board_radius(board) * f / std::min(size.width, size.height);
}

SE3 Motion::camera_from_board(double at) const {
  const double t = at > 0 && std::isfinite(at) ? at : 0;
  if (board_.as<PointLight>() != nullptr) return light_pose(t);
  switch (kind_) {
    case MotionKind::kRandom:
      return random_pose(static_cast<std::uint64_t>(std::min(t, 1e18)));
    case MotionKind::kOrbit:
      return orbit_pose(t);
    case MotionKind::kHand:
      return hand_pose(t);
    case MotionKind::kStatic:
      break;
  }
  return random_pose(0);
}

bool Motion::place(const Placement& p, SE3& camera_from_board) const {
  const auto ray = camera_.unproject(p.pixel);
  if (!ray) return false;
  const Eigen::Vector3d axis(std::cos(p.axis), std::sin(p.axis), 0);
  camera_from_board.rotation =
      turn_axis_to(*ray) * exp_so3(p.tilt * axis) * exp_so3(p.roll * Eigen::Vector3d::UnitZ());
  camera_from_board.translation =
      p.distance * *ray - camera_from_board.rotation * board_centre(board_);
  return true;
}

// The larger of the shares that the points take of the image's width and height; infinite where
// one of them is not in the image, or hardly to be seen.
double Motion::fill(const std::vector<Eigen::Vector3d>& points,
                    const SE3& camera_from_board) const {
  const ImageSize size = camera_.image_size();
  Pixel low = {1e9, 1e9};
  Pixel high = {-1e9, -1e9};
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3d in_camera = camera_from_board * point;
    const auto uv = camera_.project(in_camera);
    const bool in_front =
        camera_from_board.rotation.col(2).dot(in_camera) > kGrazing * in_camera.norm();
    if (!uv || !in_front || !(uv->u >= 0) || !(uv->v >= 0) || !(uv->u <= size.width - 1) ||
        !(uv->v <= size.height - 1)) {
      return std::numeric_limits<double>::infinity();
    }
    low = {std::min(low.u, uv->u), std::min(low.v, uv->v)};
    high = {std::max(high.u, uv->u), std::max(high.v, uv->v)};
  }
  return std::max((high.u - low.u) / size.width, (high.v - low.v) / size.height);
}

// Moves the placement to the distance at which the board takes the share wanted; false where it
// does not lie in the image there.
bool Motion::fit(Placement& p, double fill_wanted, SE3& camera_from_board) const {
  double near = 0;
  double far = 0;
  p.distance = unit_distance_;
  for (int i = 0; i < 24; ++i) {
    if (!place(p, camera_from_board)) return false;
    (fill(outline_, camera_from_board) > fill_wanted ? near : far) = p.distance;
    p.distance = far == 0 ? 2 * near : near == 0 ? far / 2 : (near + far) / 2;
  }
  if (far == 0) return false;
  p.distance = far;
  return place(p, camera_from_board) && fill(outline_, camera_from_board) > 0.8 * fill_wanted &&
         std::isfinite(fill(lattice_, camera_from_board));
}

SE3 Motion::random_pose(std::uint64_t number) const {
  const ImageSize size = camera_.image_size();
  synth::Uniform random(seed_, number);
  SE3 pose;
  double largest = 0.8;
  for (int attempt = 0; attempt < 60; ++attempt, largest *= 0.97) {
    Placement p;
    p.tilt = random(0, 45 * kDegree);
    p.axis = random(0, 2 * kPi);
    p.roll = random(-kPi, kPi);
    const double share = random(std::min(0.3, largest / 2), largest);
    const Pixel wanted = {random(0, size.width - 1), random(0, size.height - 1)};
    // The place wanted is often too near the border: slide to the centre until the board fits, so
    // that many boards touch the border.
    for (int step = 0; step <= 12; ++step) {
      const double s = step / 12.0;
      p.pixel = {wanted.u + s * (centre_.u - wanted.u), wanted.v + s * (centre_.v - wanted.v)};
      if (fit(p, share, pose)) return pose;
    }
  }
  return frontal_pose(4 * unit_distance_);
}

SE3 Motion::random_light(std::uint64_t number) const {
  const ImageSize size = camera_.image_size();
  synth::Uniform random(seed_, number);
  Placement p;
  p.distance = kNearLight * std::pow(kFarLight / kNearLight, random(0, 1));
  if (board_.point_count() > 1) {
    p.roll = random(-kPi, kPi);
    p.tilt = random(0, kTiltOfWand);
    p.axis = random(-kPi, kPi);
  }
  SE3 pose;
  for (int attempt = 0; attempt < 60; ++attempt) {
    p.pixel = {random(kBorder, 1 - kBorder) * size.width,
               random(kBorder, 1 - kBorder) * size.height};
    if (place(p, pose)) return pose;
  }
  return frontal_pose(p.distance);
}

// Across the image and to and fro, by where it is seen.
SE3 Motion::light_pose(double at) const {
  if (kind_ == MotionKind::kRandom || kind_ == MotionKind::kStatic) {
    const double number = kind_ == MotionKind::kStatic ? 0 : at;
    return random_light(static_cast<std::uint64_t>(std::min(number, 1e18)));
  }
  const ImageSize size = camera_.image_size();
  const bool circles = kind_ == MotionKind::kOrbit;
  const double angle = 2 * kPi * at / 10;
  // -1..1 of the way from the middle to the border, and from the middle distance to the farthest.
  const Pixel toward = circles ? Pixel{0.8 * std::cos(angle), 0.8 * std::sin(angle)}
                               : Pixel{wander(at, seed_, 1), wander(at, seed_, 2)};
  const double farther = circles ? std::sin(3 * angle) : wander(at, seed_, 0);
  const double width = circles ? std::min(size.width, size.height) : size.width;
  Placement p;
  p.pixel = {centre_.u + (0.5 - kBorder) * toward.u * width,
             centre_.v + (0.5 - kBorder) * toward.v * size.height};
  p.distance = std::sqrt(kNearLight * kFarLight) * std::pow(kFarLight / kNearLight, farther / 2);
  if (board_.point_count() > 1) {
    p.roll = kPi * wander(at, seed_, 3);
    p.tilt = kTiltOfWand * wander(at, seed_, 4);
    p.axis = kPi * wander(at, seed_, 5);
  }
  SE3 pose;
  return place(p, pose) ? pose : frontal_pose(p.distance);
}

SE3 Motion::hand_pose(double seconds) const {
  const ImageSize size = camera_.image_size();
  const auto path = [&](std::uint64_t stream) { return wander(seconds, seed_, stream); };
  const double share = 0.68 + 0.17 * path(0);
  const double reach = 1.25 * share * std::min(size.width, size.height);
  Placement p;
  p.pixel = {centre_.u + path(1) * std::max(0.0, size.width - reach) / 2,
             centre_.v + path(2) * std::max(0.0, size.height - reach) / 2};
  p.distance = unit_distance_ / share;
  // A tilt about both axes, without the jump of an axis that turns round.
  const double tilt_x = 35 * kDegree * path(3);
  const double tilt_y = 35 * kDegree * path(4);
  p.tilt = std::hypot(tilt_x, tilt_y);
  p.axis = std::atan2(tilt_y, tilt_x);
  p.roll = 25 * kDegree * path(5);
  SE3 pose;
  return place(p, pose) ? pose : frontal_pose(p.distance);
}

SE3 Motion::orbit_pose(double seconds) const {
  synth::Uniform random(seed_, 0);
  Placement p;
  p.pixel = centre_;
  p.distance = unit_distance_ / 0.75;
  p.tilt = 35 * kDegree;
  p.axis = random(0, 2 * kPi) + 2 * kPi * seconds / 10;
  SE3 pose;
  return place(p, pose) ? pose : frontal_pose(p.distance);
}

SE3 Motion::frontal_pose(double distance) const {
  return {Eigen::Matrix3d::Identity(), Eigen::Vector3d(0, 0, distance) - board_centre(board_)};
}

}  // namespace calvin
