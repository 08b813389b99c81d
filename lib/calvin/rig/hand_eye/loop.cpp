// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The error of a loop and its derivatives. With P = mount_from_carrier, both set-ups have
//   P = mount_from_camera camera_from_board carrier_from_board^-1
// where P is hand_from_base with the camera on the hand, and base_from_hand else.

#include "calvin/rig/hand_eye/loop.hpp"

#include <Eigen/Geometry>

#include "calvin/geometry/cross_matrix.hpp"

namespace calvin::rig {

namespace {

SE3 mount_from_carrier(const HandEyePlaces& places, const SE3& camera_from_board) {
  const SE3 scaled = {camera_from_board.rotation, places.scale * camera_from_board.translation};
  return places.mount_from_camera * scaled * places.carrier_from_board.inverse();
}

// How log_so3(exp(d) exp(w)) grows with d, to the fourth order of w, which is an error (J. Sola and
// others, A micro Lie theory, arXiv 1812.01537, eq. 146).
Eigen::Matrix3d inverse_left_jacobian(const Eigen::Vector3d& w) {
  const Eigen::Matrix3d m = cross_matrix(w);
  return Eigen::Matrix3d::Identity() - m / 2 + m * m / 12;
}

// The rows by the pose P = mount_from_carrier: a turn from the left, and the place.
LoopRows rows_of_mount(const HandEyePlaces& places, const SE3& camera_from_board, const SE3& p) {
  const Eigen::Matrix3d& mount = places.mount_from_camera.rotation;
  const Eigen::Vector3d board = places.scale * mount * camera_from_board.translation;
  const Eigen::Matrix3d carrier = cross_matrix(p.rotation * places.carrier_from_board.translation);
  LoopRows rows;
  rows.by_board.setZero();
  rows.by_board.topLeftCorner<3, 3>() = mount;
  rows.by_board.bottomLeftCorner<3, 3>() = (carrier - cross_matrix(board)) * mount;
  rows.by_board.bottomRightCorner<3, 3>() = places.scale * mount;
  rows.by_places.setZero();
  rows.by_places.block<3, 3>(0, kMountColumn).setIdentity();
  rows.by_places.block<3, 3>(3, kMountColumn) =
      -cross_matrix(p.translation - places.mount_from_camera.translation);
  rows.by_places.block<3, 3>(3, kMountColumn + 3).setIdentity();
  rows.by_places.block<3, 3>(0, kCarrierColumn) = -p.rotation;
  rows.by_places.block<3, 3>(3, kCarrierColumn) = -carrier * p.rotation;
  rows.by_places.block<3, 3>(3, kCarrierColumn + 3) = -p.rotation;
  rows.by_places.block<3, 1>(3, kScaleColumn) = mount * camera_from_board.translation;
  return rows;
}

}  // namespace

HandEyePlaces moved(const HandEyePlaces& places, const double* step) {
  const auto by = [](const SE3& pose, const double* d) {
    return SE3{exp_so3({d[0], d[1], d[2]}) * pose.rotation,
               pose.translation + Eigen::Vector3d(d[3], d[4], d[5])};
  };
  return {by(places.mount_from_camera, step + kMountColumn),
          by(places.carrier_from_board, step + kCarrierColumn), places.scale + step[kScaleColumn]};
}

SE3 expected_hand(const HandEyePlaces& places, EyeSetup setup, const SE3& camera_from_board) {
  const SE3 p = mount_from_carrier(places, camera_from_board);
  return setup == EyeSetup::kInHand ? p.inverse() : p;
}

Vector6d hand_error(const SE3& expected, const SE3& measured) {
  Vector6d error;
  error << log_so3(expected.rotation * measured.rotation.transpose()),
      expected.translation - measured.translation;
  return error;
}

LoopRows loop_rows(const HandEyePlaces& places, EyeSetup setup, const SE3& camera_from_board,
                   const SE3& base_from_hand) {
  const SE3 p = mount_from_carrier(places, camera_from_board);
  LoopRows rows = rows_of_mount(places, camera_from_board, p);
  const SE3 hand = setup == EyeSetup::kInHand ? p.inverse() : p;
  rows.error = hand_error(hand, base_from_hand);
  Matrix6d turn = Matrix6d::Identity();
  if (setup == EyeSetup::kInHand) {
    // The inverse of P turns the other way, and its place is -R^T t.
    turn.topLeftCorner<3, 3>() = -hand.rotation;
    turn.bottomLeftCorner<3, 3>() = cross_matrix(hand.translation) * hand.rotation;
    turn.bottomRightCorner<3, 3>() = -hand.rotation;
  }
  turn.topLeftCorner<3, 3>() =
      (inverse_left_jacobian(rows.error.head<3>()) * turn.topLeftCorner<3, 3>()).eval();
  rows.by_board = (turn * rows.by_board).eval();
  rows.by_places = (turn * rows.by_places).eval();
  return rows;
}

}  // namespace calvin::rig
