// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The first camera is placed on the robot, the others beside it by what both have seen, as in a
// rig; then every view gets the labels and the tilt that go with them.

#include "calvin/rig/strobl/joint_loops.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "calvin/rig/start/links.hpp"
#include "calvin/rig/start/rig_start.hpp"

namespace calvin::rig {

namespace {

using Group = std::vector<std::size_t>;  // views at one pose of the robot

// camera_from_board where the robot says that its hand is.
SE3 expected_board(const HandEyePlaces& places, EyeSetup setup, const SE3& base_from_hand) {
  const SE3 mount_from_carrier =
      setup == EyeSetup::kInHand ? base_from_hand.inverse() : base_from_hand;
  SE3 board = places.mount_from_camera.inverse() * mount_from_carrier * places.carrier_from_board;
  board.translation /= places.scale;
  return board;
}

double difference(const SE3& one, const SE3& other) {
  return (one.rotation - other.rotation).norm() +
         (one.translation - other.translation).norm() / other.translation.norm();
}

// The pose and the labels of a view that are nearest to where the board is before its camera.
SeenBoard nearest(const BoardView& view, const SE3& camera_from_board) {
  SeenBoard best;
  double least = std::numeric_limits<double>::infinity();
  for (const SE3& labelling : view.labellings) {
    for (const SE3& own : view.poses) {
      const SE3 pose = own * labelling.inverse();
      const double now = difference(pose, camera_from_board);
      if (now < least) best = {&view, labelling, pose};
      least = std::min(least, now);
    }
  }
  return best;
}

Result<MountedCameras> mounted_cameras(const std::vector<BoardView>& views,
                                       const std::map<std::size_t, Group>& groups,
                                       const std::vector<Camera>& cameras,
                                       const std::vector<std::string>& names) {
  MountedCameras mounted = {cameras, {SE3()}};
  if (cameras.size() == 1) return mounted;
  std::vector<Group> all;
  for (const auto& [pose, group] : groups) all.push_back(group);
  auto places = place_all(views, all, cameras, find_links(views, all, cameras), names);
  if (!places) return tl::unexpected<Error>(places.error());
  mounted.camera_from_first = std::move(places->camera_from_rig);
  return mounted;
}

Result<FirstLoops> loops_of_first(const std::vector<BoardView>& views,
                                  const std::vector<std::size_t>& pose_of_view,
                                  const std::vector<SE3>& base_from_hand, EyeSetup setup,
                                  bool free_scale) {
  std::vector<const BoardView*> own;
  std::vector<SE3> hands;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].of.camera != 0) continue;
    own.push_back(&views[v]);
    hands.push_back(base_from_hand[pose_of_view[v]]);
  }
  return first_loops(own, hands, setup, free_scale);
}

}  // namespace

Result<JointLoops> joint_loops(const std::vector<BoardView>& views,
                               const std::vector<std::size_t>& pose_of_view,
                               const std::vector<SE3>& base_from_hand,
                               const std::vector<Camera>& cameras,
                               const std::vector<std::string>& names, EyeSetup setup,
                               bool free_scale) {
  std::map<std::size_t, Group> groups;  // by the number of the pose
  for (std::size_t v = 0; v < views.size(); ++v) groups[pose_of_view[v]].push_back(v);
  auto first = loops_of_first(views, pose_of_view, base_from_hand, setup, free_scale);
  if (!first) return tl::unexpected<Error>(first.error());
  auto mounted = mounted_cameras(views, groups, cameras, names);
  if (!mounted) return tl::unexpected<Error>(mounted.error());
  JointLoops all = {*std::move(first), {}, {}, *std::move(mounted)};
  std::size_t next = 0;  // of the loops of the first camera, which are in the order of its views
  std::map<std::size_t, LoopView> by_first;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (views[v].of.camera == 0) by_first[pose_of_view[v]] = all.first.loops[next++];
  }
  for (const auto& [pose, group] : groups) {
    const auto known = by_first.find(pose);
    LoopView loop;
    loop.base_from_hand = base_from_hand[pose];
    loop.camera_from_board = expected_board(all.first.places, setup, loop.base_from_hand);
    if (known != by_first.end()) loop = known->second;
    for (const std::size_t v : group) {
      if (views[v].of.camera == 0) continue;
      const SE3& from_first = all.mounted.camera_from_first[views[v].of.camera];
      loop.seen.push_back(nearest(views[v], from_first * loop.camera_from_board));
      // Corners say better where the board is than the robot does.
      if (loop.seen.size() == 1) {
        loop.camera_from_board = from_first.inverse() * loop.seen.front().camera_from_board;
      }
    }
    all.loops.push_back(std::move(loop));
    all.poses.push_back(pose);
  }
  return all;
}

}  // namespace calvin::rig
