// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The families of libapriltag, and what its detector finds.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"

namespace calvin::scenes {

struct AprilMaker {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
inline constexpr AprilMaker kAprilMakers[] = {
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
};

using AprilFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

inline AprilFamily april_family(std::string_view name) {
  const auto* maker = std::ranges::find(kAprilMakers, name, &AprilMaker::name);
  return {maker->create(), maker->destroy};
}

// A tag as AprilTag prints it, a pixel for a cell, and a pixel of paper around it.
inline GrayImage april_picture(const apriltag_family_t& family, int id) {
  image_u8_t* tag =
      apriltag_to_image(const_cast<apriltag_family_t*>(&family), static_cast<std::uint32_t>(id));
  GrayImage image(tag->width + 2, tag->height + 2, 255);
  for (int row = 0; row < tag->height; ++row) {
    std::copy_n(tag->buf + row * tag->stride, tag->width, image.row(row + 1) + 1);
  }
  // image_u8_destroy() is in another library, which pkg-config does not name.
  std::free(tag->buf);
  std::free(tag);
  return image;
}

struct AprilDetection {
  int id = 0;
  std::array<Pixel, 4> corners;  // from the upper left one on, clockwise
};

// Keeps the tables by which codes are looked up.
class AprilDetector {
 public:
  // `most_wrong` bits of a code.
  AprilDetector(std::string_view family, int most_wrong)
      : family_(april_family(family)),
        detector_(apriltag_detector_create(), apriltag_detector_destroy) {
    detector_->quad_decimate = 1;
    apriltag_detector_add_family_bits(detector_.get(), family_.get(), most_wrong);
  }

  [[nodiscard]] std::vector<AprilDetection> detect(const ImageView& image) const {
    image_u8_t picture = {image.width, image.height, static_cast<std::int32_t>(image.stride),
                          const_cast<std::uint8_t*>(image.data)};
    zarray_t* found = apriltag_detector_detect(detector_.get(), &picture);
    std::vector<AprilDetection> all;
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found, i, static_cast<void*>(&tag));
      AprilDetection& one = all.emplace_back();
      one.id = tag->id;
      // It counts corners from the lower left one on, the other way round, and pixels from their
      // upper left corners.
      for (std::size_t k = 0; k < 4; ++k) {
        one.corners[k] = {tag->p[3 - k][0] - 0.5, tag->p[3 - k][1] - 0.5};
      }
    }
    apriltag_detections_destroy(found);
    std::ranges::sort(all, {}, &AprilDetection::id);
    return all;
  }

 private:
  AprilFamily family_;
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_;
};

}  // namespace calvin::scenes
