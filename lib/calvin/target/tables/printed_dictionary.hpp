// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A dictionary as a library has it, for the program that writes the tables.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace printed {

// What the members mean is said of MarkerDictionary, in target/marker_dictionary.hpp.
struct Dictionary {
  std::string name;
  int side = 0;
  std::vector<std::uint64_t> codes;
  int distance = 0;
  int outside = 0;
  std::vector<std::pair<int, int>> places;  // columns and rows
};

// Each of them once, its largest dictionary first: the smaller ones are the beginning of it.
using Family = std::vector<Dictionary>;

// Those of OpenCV, and those of libapriltag. Of the two libraries one may not be there.
std::vector<Family> opencv_families();
std::vector<Family> april_families();

}  // namespace printed
