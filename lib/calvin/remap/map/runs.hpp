// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Runs and bands: the pieces of an output plane that the kernels work on. A run is eight samples of
// a row (or four or two, where the map is strongly bent) whose source coordinates are a parabola
// through the middles of the run and its neighbours; a band is the rows that are prepared together.
#pragma once

#include <cmath>
#include <cstdint>

namespace calvin::remap {

// Source coordinates are integers in 1/2^14 of a sample of the source plane. This unit is the one
// of the 2.14 slopes, and 32 bits hold 131,000 samples to either side of the origin.
inline constexpr int kCoordBits = 14;

// Runs whose middles are known before the first run of a row, and behind its last one: a parabola
// needs the middles of two runs on either side.
inline constexpr int kMargin = 2;
// Further runs behind that margin: they fill up the last vector of 128 bits, which has four runs.
inline constexpr int kSpare = 3;

// Rows of the output that make a band, at most and at least. 64 is the height of the cells of the
// coarsest map (RemapMap::kCoarsest); all rows of a band lie between the same rows of nodes.
inline constexpr int kBandRows = 64;
inline constexpr int kFewestBandRows = 8;

// Down a band, the distance between the two neighbours of a run is taken as linear. This is the
// bound of its deviation from linear in the middle of the band, times 2, in 1/2^14 of a sample.
// The line is laid half way towards the middle, and the ends of a run are 3.5 of 16 samples from
// its own middle, so that they are wrong by at most 64 / 2 / 2 * 3.5 / 16 / 2^14 = 1/4700 sample.
inline constexpr std::int32_t kMaxDeviation = 64;

// A parabola cannot follow a third derivative, but its slope can make the best of one. This part,
// in 1/256, of the third difference of the middles is taken from the distance between the run's
// neighbours: 1/6 would be the exact slope in the middle, 1/7 is best for the whole run
// (Chebyshev).
inline constexpr int kThirdPart = 37;

// The source coordinate along one axis as a function of the output sample, in samples of the
// source: middle + slope t + bend t^2. The vector kernels have the same parabola in fixed point.
struct RunParabola {
  // `middles` has five values, in 1/2^14 of a sample: of two runs before, the run, and two behind.
  // `pixels` is the number of samples of a run.
  RunParabola(const std::int32_t* middles, int pixels) noexcept {
    constexpr double kScale = 1.0 / (1 << kCoordBits);
    const double before = kScale * middles[1];
    const double after = kScale * middles[3];
    const double third = kScale * middles[4] - kScale * middles[0] - 2 * (after - before);
    middle = kScale * middles[2];
    const double part = 1.0 / pixels;
    slope = (after - before - third * (kThirdPart / 256.0)) * (0.5 * part);
    bend = (after + before - 2 * middle) * (0.5 * part * part);
  }
  // `t` is counted in samples of the output from the middle of the run.
  [[nodiscard]] double at(double t) const noexcept { return middle + t * (slope + t * bend); }

  // Whether the whole run lies outside of 0..last by more than a sample.
  [[nodiscard]] bool misses(int reach, double last) const noexcept {
    const double far = reach * (std::abs(slope) + reach * std::abs(bend)) + 1;
    return middle + far < 0 || middle - far > last;
  }

  double middle;
  double slope;
  double bend;
};

}  // namespace calvin::remap
