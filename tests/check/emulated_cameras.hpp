// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Four cameras that do not exist, each with a clock of its own, before a board that is carried
// about, or a light: what they would deliver, rendered beforehand, and where they truly stand.
// Plain data, for the reason that rig_views.hpp tells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/core/calibration.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/rig.hpp"
#include "calvin/geometry/se3.hpp"

namespace calvin::emulated {

struct Settings {
  ImageSize size = {640, 480};
  bool has_light = false;              // the cameras stand around a dark room
  double rate = 30;                    // frames per second
  double seconds = 12;                 // of all
  bool is_synchronous = false;         // all look at one time; else each has a phase of its own
  double jitter = 1.5e-3;              // s, to either side
  double drift = 200e-6;               // of the clock of the last camera; the first one has none
  double lost = 0.05;                  // of the frames
  std::optional<std::size_t> stopped;  // a camera that delivers nothing meanwhile
  double stops = 0;                    // s
  double starts = 0;
  std::optional<std::size_t> bumped;  // a camera that is pushed at that time
  double bump = 0;                    // s
  double bump_place = 0.01;           // m
  double bump_turn = 0.015;           // rad
};

struct Frame {
  std::size_t camera = 0;
  std::uint64_t timestamp = 0;  // ns, when it was taken
  GrayImage picture;
};

struct Cameras {
  std::vector<Calibration> calibrations;  // of cam0, cam1 ...
  std::vector<SE3> before;                // world_from_camera, until one is bumped
  std::vector<SE3> after;
  std::vector<Frame> frames;  // in the order in which they come
};

[[nodiscard]] Cameras render(const Settings& settings);

struct Error {
  double square = 0;   // e^T C^-1 e over the number of components, of all cameras
  double largest = 0;  // sigmas, of one component
};
// Of a rig whose cameras are in that order, its frame that of the first one or of known places.
[[nodiscard]] Error error_of(const Rig& rig, const std::vector<SE3>& world_from_camera);

}  // namespace calvin::emulated
