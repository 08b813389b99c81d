// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A small board of each kind, for tests that all kinds pass.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "calvin/target/kinds.hpp"

namespace calvin::scenes {

struct NamedBoard {
  std::string name;
  Board board;

  friend std::ostream& operator<<(std::ostream& out, const NamedBoard& b) { return out << b.name; }
};

// Four dots around one in the middle, 50 mm apart along x and 30 mm along y; ids with gaps.
inline std::vector<PointBoard::Dot> five_dots() {
  return {{20, 0.05, 0.03, 0.01},
          {3, 0, 0.03, 0.01},
          {7, 0.1, 0.03, 0.02},
          {40, 0.05, 0, 0.01},
          {41, 0.05, 0.06, 0.01}};
}

// Those that are printed and whose text this build understands, and one without a text.
inline std::vector<NamedBoard> board_of_each_kind() {
  std::vector<NamedBoard> all;
  for (const auto& [name, text] : {
           std::pair{"Checkerboard", "checkerboard:4x3:100mm"},
           {"MarkedCheckerboard", "checkerboard:6x5:50mm:circles"},
           {"PuzzleBoard", "puzzle:6x5:20mm"},
           {"PuzzleBoardWithin", "puzzle:4x5:20mm:317,90"},
           {"CharucoBoard", "charuco:5x4:40mm:30mm:DICT_4X4_50"},
           {"LegacyCharucoBoard", "charuco:5x4:40mm:20mm:DICT_6X6_250:legacy"},
           {"InvertedCharucoBoard", "charuco:4x5:40mm:31mm:DICT_5X5_100:inverted"},
           {"CircleGrid", "circles:5x4:30mm"},
           {"InvertedCircleGrid", "circles:5x4:30mm:inverted"},
           {"MarkedCircleGrid", "dots:6x5:7mm:rings=1.1+4.1:big=1.3"},
           {"AsymmetricCircleGrid", "acircles:3x5:20mm"},
           {"AprilGrid", "aprilgrid:3x2:40mm:0.3"},
           {"TagGrid", "aruco:3x2:40mm:10mm:DICT_4X4_50"},
           {"InvertedTagGrid", "aruco:2x3:40mm:30mm:DICT_6X6_250:first=7:inverted"},
           {"AprilTags", "apriltag:tag25h9:2x2:40mm:20mm:first=3:border=2"},
           {"AprilTags3", "apriltag:tagStandard41h12:3x2:50mm:45mm:first=2109"},
           {"RoundTags", "apriltag:tagCircle21h7:2x2:50mm:40mm"},
           {"InvertedAprilTags3", "apriltag:tagCustom48h12:2x2:60mm:40mm:first=7:inverted"},
           {"AprilGridWithThinBorders", "aprilgrid:2x3:40mm:0.25:tag25h9:border=1:first=4"},
       }) {
    const auto board = parse_board(text);
    if (board) all.push_back({name, *board});
  }
  all.push_back({"PointBoard", PointBoard::make("plate.json", five_dots()).value()});
  return all;
}

inline std::string name_of(const testing::TestParamInfo<NamedBoard>& test) {
  return test.param.name;
}

}  // namespace calvin::scenes
