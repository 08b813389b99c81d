// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// KnownDiscs: the discs of an image by their places.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

// Which discs lie where, so that none is taken twice. Keeps its memory.
class KnownDiscs {
 public:
  void begin(const std::vector<Ellipse>& discs) {
    for (auto& bucket : buckets_) bucket.clear();
    for (const Ellipse& e : discs) buckets_[bucket_of(e.x, e.y)].push_back(e);
  }
  // False for a disc whose centre lies within another one of about its size.
  [[nodiscard]] bool add(const Ellipse& e) {
    for (const double dx : {-kSide, 0.0, kSide}) {
      for (const double dy : {-kSide, 0.0, kSide}) {
        for (const Ellipse& other : buckets_[bucket_of(e.x + dx, e.y + dy)]) {
          constexpr double kWithin = 0.25;  // of the radius, squared
          if (other.square_distance_of(e) < kWithin) return false;
        }
      }
    }
    buckets_[bucket_of(e.x, e.y)].push_back(e);
    return true;
  }

 private:
  static constexpr double kSide = 32;  // px
  static constexpr std::size_t kBuckets = 1024;
  static std::size_t bucket_of(double x, double y) {
    const auto cell = [](double v) { return static_cast<std::size_t>(std::floor(v / kSide) + 64); };
    return (cell(x) * 31 + cell(y)) % kBuckets;
  }
  std::array<std::vector<Ellipse>, kBuckets> buckets_;
};

}  // namespace calvin::detect
