// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// DiscSearch: the discs in the levels of an image, each once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calvin/detect/circles/blob_points.hpp"
#include "calvin/detect/circles/blob_shape.hpp"
#include "calvin/detect/circles/ellipse.hpp"
#include "calvin/detect/pyramid.hpp"

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

// Keeps its memory.
class DiscSearch {
 public:
  // Of each level the `most` places that differ most from the ring around them are looked at.
  explicit DiscSearch(std::size_t most) : most_(most) {}

  // Adds the discs of a level that are none of `discs` yet, in px of the image.
  void add(Pyramid& pyramid, int level, bool light, std::vector<Ellipse>& discs);

 private:
  std::size_t most_;
  BlobSearch blob_search_;
  BlobShapes shapes_;
  KnownDiscs known_;
};

}  // namespace calvin::detect
