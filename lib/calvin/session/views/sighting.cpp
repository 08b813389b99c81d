// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A sheet from frame to frame.

#include "calvin/session/views/sighting.hpp"

#include <algorithm>
#include <cmath>

namespace calvin {

std::optional<CornerVelocities> velocities_of(Sighting& now, const Sighting& before) {
  // A hand that trembles may move evenly for a moment by chance.
  constexpr double kRemembered = 0.9;  // of what was uneven a frame before
  now.before = before.seen;
  now.motion = before.motion;
  if (now.motion) now.motion->uneven *= kRemembered;
  if (!before.before || seconds_between(*before.before, before.seen) > kFarApart ||
      seconds_between(before.seen, now.seen) > kFarApart) {
    return std::nullopt;
  }
  auto velocities = corner_velocities(*before.before, before.seen, now.seen);
  if (!velocities) return std::nullopt;
  const double uneven =
      std::max(uneven_motion(*velocities, before.motion), now.motion ? now.motion->uneven : 0);
  now.motion = SteadyMotion{velocities->change, uneven};
  velocities->sigma = std::hypot(velocities->sigma, uneven);
  return velocities;
}

double left_of_motion(const Observation& seen, double sigma, double readout) {
  double squares = 0;
  for (const Pixel& at : seen.uv) {
    const double left = left_of_motion(sigma, readout, at.v, seen.image_size.height);
    squares += left * left / static_cast<double>(seen.uv.size());
  }
  return std::sqrt(squares);
}

View moving(View view, const CornerVelocities& velocities, double readout) {
  Observation& seen = view.observation;
  seen.velocity = velocities.of;
  for (std::size_t i = 0; i < seen.sigma.size() && i < seen.uv.size(); ++i) {
    if (!is_known_sigma(seen.sigma[i])) continue;
    seen.sigma[i] = std::hypot(seen.sigma[i], left_of_motion(velocities.sigma, readout,
                                                             seen.uv[i].v, seen.image_size.height));
  }
  return view;
}

}  // namespace calvin
