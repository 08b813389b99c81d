// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Asks libapriltag for its families of tags.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
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

#include "printed_dictionary.hpp"

namespace printed {

namespace {

// A family of libapriltag, which lives as long as this.
struct Tags {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
constexpr Tags kTags[] = {
    {tag16h5_create, tag16h5_destroy},
    {tag25h9_create, tag25h9_destroy},
    {tag36h10_create, tag36h10_destroy},
    {tag36h11_create, tag36h11_destroy},
    {tagCircle21h7_create, tagCircle21h7_destroy},
    {tagCircle49h12_create, tagCircle49h12_destroy},
    {tagCustom48h12_create, tagCustom48h12_destroy},
    {tagStandard41h12_create, tagStandard41h12_destroy},
    {tagStandard52h13_create, tagStandard52h13_destroy},
};

// A bit of AprilTag's codes and its column and row within the rim, the other way up.
struct Bit {
  int col = 0;
  int row = 0;
  unsigned shift = 0;
};

std::vector<Bit> bits_of(const apriltag_family_t& tags) {
  std::vector<Bit> bits;
  const int last = tags.width_at_border - 3;  // within the rim
  for (unsigned i = 0; i < tags.nbits; ++i) {
    // AprilTag counts columns and rows from the corner of the border on; there are some before it.
    const int col = static_cast<int>(tags.bit_x[i]) - 1;
    const int row = static_cast<int>(tags.bit_y[i]) - 1;
    bits.push_back({last - col, last - row, tags.nbits - 1 - i});
  }
  std::ranges::sort(bits, {}, [](const Bit& b) { return std::pair(b.row, b.col); });
  return bits;
}

Dictionary dictionary_of(const apriltag_family_t& tags) {
  const std::string_view name = tags.name;
  Dictionary dictionary;
  dictionary.side = tags.width_at_border - 2;
  dictionary.distance = static_cast<int>(tags.h);
  const std::vector<Bit> bits = bits_of(tags);
  if (tags.reversed_border) {
    dictionary.name = name;
    dictionary.outside = (tags.total_width - tags.width_at_border) / 2;
    for (const Bit& bit : bits) dictionary.places.emplace_back(bit.col, bit.row);
  } else {
    // OpenCV's name.
    dictionary.name = "DICT_APRILTAG_" + std::string(name.substr(3));
    if (static_cast<int>(bits.size()) != dictionary.side * dictionary.side) {
      std::fprintf(stderr, "print_markers: %s has a layout that is not known\n", tags.name);
      std::exit(1);
    }
  }
  for (std::size_t id = 0; id < tags.ncodes; ++id) {
    std::uint64_t code = 0;
    for (const Bit& bit : bits) code = code << 1 | (tags.codes[id] >> bit.shift & 1);
    dictionary.codes.push_back(code);
  }
  return dictionary;
}

}  // namespace

std::vector<Family> april_families() {
  std::vector<Family> all;
  for (const Tags& one : kTags) {
    apriltag_family_t* tags = one.create();
    all.push_back({dictionary_of(*tags)});
    one.destroy(tags);
  }
  return all;
}

}  // namespace printed
