// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A board that never rests, as a camera shows it that reads row after row.
#pragma once

#include <cstdint>
#include <random>

#include "calvin/session/session.hpp"
#include "calvin/synth/motion.hpp"
#include "calvin/synth/render.hpp"
#include "scenes.hpp"

namespace calvin::scenes {

inline constexpr double kFrames = 30;  // per second

struct Film {
  MotionKind motion = MotionKind::kHand;
  double readout = 0;  // s
  double seconds = 10;
  double noise = 0.05;  // px
  CaptureMode mode = CaptureMode::kAuto;
  double rate = kFrames;
};

// What is seen of kBoard at `now`, s.
inline Observation frame(const Film& film, const Camera& camera, const Motion& motion, double now,
                         Random& random) {
  const double rows = camera.image_size().height - 1;
  Observation seen = true_observation(camera, kBoard, [&](double v) {
    return motion.camera_from_board(now + film.readout * v / rows);
  });
  std::normal_distribution<double> noise(0, film.noise);
  for (Pixel& at : seen.uv) at = {at.u + noise(random), at.v + noise(random)};
  seen.sigma.assign(seen.uv.size(), film.noise);
  seen.timestamp = static_cast<std::uint64_t>(1e9 * now);
  seen.board = kBoard.text();
  return seen;
}

}  // namespace calvin::scenes
