// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The dictionaries of markers, and their order on a ChArUco board, against OpenCV.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "calvin/target/kinds.hpp"
#include "opencv_charuco.hpp"

namespace calvin {
namespace {

TEST(Dictionaries, AreThoseOfOpenCvByEveryName) {
  const auto names = scenes::opencv_dictionaries();
  const auto is_of_opencv = [](const MarkerDictionary& d) { return d.name.starts_with("DICT_"); };
  EXPECT_EQ(std::ranges::count_if(marker_dictionaries(), is_of_opencv), std::ssize(names));
  for (std::size_t number = 0; number < names.size(); ++number) {
    const MarkerDictionary* dictionary = find_dictionary(names[number]);
    ASSERT_NE(dictionary, nullptr) << names[number];
    const int count = scenes::marker_count_of(static_cast<int>(number));
    ASSERT_EQ(static_cast<int>(dictionary->codes.size()), count) << names[number];
    const int cells = dictionary->side + 2;
    for (int id = 0; id < count; ++id) {
      const cv::Mat marker = scenes::marker_picture(static_cast<int>(number), id, cells);
      ASSERT_EQ(marker.cols, cells) << names[number];
      for (int row = 0; row < dictionary->side; ++row) {
        for (int col = 0; col < dictionary->side; ++col) {
          ASSERT_EQ(dictionary->is_light(id, col, row), marker.at<uchar>(row + 1, col + 1) != 0)
              << names[number] << " " << id << " " << col << " " << row;
        }
      }
    }
  }
}

TEST(Dictionaries, OfAnotherNameThereIsNone) {
  for (const char* name : {"", "DICT_6X6", "dict_6x6_250", "DICT_6X6_250 ", "6X6_250"}) {
    EXPECT_EQ(find_dictionary(name), nullptr) << name;
  }
}

// In a legacy board the lower left square is dark, else the upper left one; that is one order where
// the number of rows is odd.
TEST(CharucoBoard, NumbersMarkersAsOpenCvDoes) {
  const MarkerDictionary* dictionary = find_dictionary("DICT_4X4_250");
  for (const auto& [cols, rows] : {std::pair{5, 7}, {7, 5}, {6, 9}, {5, 4}, {6, 8}, {3, 3}}) {
    for (const bool legacy : {true, false}) {
      if (legacy && rows % 2 == 0) continue;
      const CharucoBoard board{cols, rows, 0.04, 0.02, dictionary, legacy};
      const auto middles = scenes::marker_middles({cols, rows});
      ASSERT_EQ(static_cast<int>(middles.size()), board.marker_count()) << board.text();
      for (std::size_t id = 0; id < middles.size(); ++id) {
        const int col = static_cast<int>(std::floor(middles[id].x));
        const int row = static_cast<int>(std::floor(middles[id].y));
        ASSERT_TRUE(board.has_marker(col, row)) << board.text() << " " << id;
        EXPECT_EQ(board.marker_in(col, row), static_cast<int>(id)) << board.text();
        EXPECT_EQ(board.square_of(static_cast<int>(id)), (GridPlace{col, row})) << board.text();
      }
    }
  }
}

// Its markers follow each other in rows from the top, as in the lower rows of a board of a row
// more.
TEST(CharucoBoard, ALegacyBoardIsTheLowerPartOfALongerOne) {
  const MarkerDictionary* dictionary = find_dictionary("DICT_4X4_250");
  for (const auto& [cols, rows] : {std::pair{5, 4}, {6, 8}, {7, 6}}) {
    const CharucoBoard board{cols, rows, 0.04, 0.02, dictionary, true};
    int count = 0;
    for (const cv::Point2f& middle : scenes::marker_middles({cols, rows + 1})) {
      const int col = static_cast<int>(std::floor(middle.x));
      const int row = static_cast<int>(std::floor(middle.y)) - 1;
      if (row < 0) continue;
      ASSERT_TRUE(board.has_marker(col, row)) << board.text();
      EXPECT_EQ(board.square_of(count), (GridPlace{col, row})) << board.text();
      EXPECT_EQ(board.marker_in(col, row), count++) << board.text();
    }
    EXPECT_EQ(count, board.marker_count()) << board.text();
  }
}

}  // namespace
}  // namespace calvin
