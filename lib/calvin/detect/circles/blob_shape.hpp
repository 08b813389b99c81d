// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The ellipse around a place of an image, to a fraction of a pixel: what discs are told by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/circles/ellipse.hpp"

namespace calvin::detect {

// The shapes of blobs of an image (of step 1), which has to stay.
class BlobShapes {
 public:
  static constexpr std::size_t kRays = 16;
  static constexpr std::size_t kReach = 10;  // px
  // Grey levels a px apart along all rays, brighter outwards; those of one distance follow each
  // other.
  struct Profiles {
    std::array<std::array<float, kRays>, kReach + 1> grey;
  };

  void begin(const ImageView& image, bool light);

  // Looks for the rim along rays from a pixel inside of a disc, at most 10 px away. Absent where
  // the rim is no ellipse, has less than `contrast` grey levels, or may be outside of the image.
  [[nodiscard]] std::optional<Ellipse> measure(int x, int y, float contrast) const;

 private:
  void take_rays(const std::uint8_t* centre, std::size_t first, Profiles& profiles) const;

  ImageView image_;
  bool light_ = false;
  std::vector<std::ptrdiff_t> offsets_;  // of the pixels along the rays, from the first one
};

// An ellipse of which the rim is known to a part of the radius, such as one that a smaller picture
// has shown, by where the grey level half way is passed around it: to a small part of the blur.
// Absent where it is not passed all around.
[[nodiscard]] std::optional<Ellipse> closer_ellipse(const ImageView& image, const Ellipse& near);

// How far the rim leaves its ellipse four times around, in radii, of an ellipse that is near it:
// .14 where a square is sharp. Absent where there is no rim.
[[nodiscard]] std::optional<double> rim_squareness(const ImageView& image, const Ellipse& near);

}  // namespace calvin::detect
