// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// OpenCV's dictionaries and ChArUco boards, whichever module they are in.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#define CALVIN_CHARUCO_IN_OBJDETECT 1
#include <opencv2/objdetect/aruco_board.hpp>
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#define CALVIN_CHARUCO_IN_OBJDETECT 0
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/charuco.hpp>
#endif

namespace calvin::scenes {

// The names of the dictionaries that OpenCV numbers from 0 on, in that order.
inline std::vector<std::string> opencv_dictionaries() {
  std::vector<std::string> names;
  for (const char* family : {"4X4", "5X5", "6X6", "7X7"}) {
    for (const char* count : {"50", "100", "250", "1000"}) {
      names.push_back(std::string("DICT_") + family + "_" + count);
    }
  }
  for (const char* name : {"DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9",
                           "DICT_APRILTAG_36h10", "DICT_APRILTAG_36h11"}) {
    names.emplace_back(name);
  }
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 8
  names.emplace_back("DICT_ARUCO_MIP_36h12");
#endif
  return names;
}

// A marker of a dictionary with its rim, a pixel a cell.
inline cv::Mat marker_picture(int dictionary, int id, int cells) {
  cv::Mat picture;
#if CALVIN_CHARUCO_IN_OBJDETECT
  cv::aruco::getPredefinedDictionary(dictionary).generateImageMarker(id, cells, picture, 1);
#else
  cv::aruco::drawMarker(cv::aruco::getPredefinedDictionary(dictionary), id, cells, picture, 1);
#endif
  return picture;
}

inline int marker_count_of(int dictionary) {
#if CALVIN_CHARUCO_IN_OBJDETECT
  return cv::aruco::getPredefinedDictionary(dictionary).bytesList.rows;
#else
  return cv::aruco::getPredefinedDictionary(dictionary)->bytesList.rows;
#endif
}

// A board as OpenCV since 4.6 has it, without a border. Lengths in px.
inline cv::Mat charuco_picture(cv::Size squares, int square, int marker, int dictionary) {
  cv::Mat picture;
  const cv::Size size(squares.width * square, squares.height * square);
  const auto side = static_cast<float>(square);
  const auto marker_side = static_cast<float>(marker);
#if CALVIN_CHARUCO_IN_OBJDETECT
  const cv::aruco::CharucoBoard board(squares, side, marker_side,
                                      cv::aruco::getPredefinedDictionary(dictionary));
  board.generateImage(size, picture, 0, 1);
#else
  cv::aruco::CharucoBoard::create(squares.width, squares.height, side, marker_side,
                                  cv::aruco::getPredefinedDictionary(dictionary))
      ->draw(size, picture, 0, 1);
#endif
  return picture;
}

// A board as OpenCV had it before 4.6, where the lower left square is dark: composed of its
// markers.
inline cv::Mat legacy_charuco_picture(cv::Size squares, int square, int marker, int dictionary,
                                      int cells) {
  cv::Mat picture(squares.height * square, squares.width * square, CV_8U, cv::Scalar(255));
  int id = 0;
  for (int row = 0; row < squares.height; ++row) {
    for (int col = 0; col < squares.width; ++col) {
      cv::Mat place = picture(cv::Rect(col * square, row * square, square, square));
      if ((squares.height - 1 - row) % 2 == col % 2) {
        place.setTo(0);
        continue;
      }
      cv::Mat code;
      cv::resize(marker_picture(dictionary, id++, cells), code, {marker, marker}, 0, 0,
                 cv::INTER_NEAREST);
      const int gap = (square - marker) / 2;
      code.copyTo(place(cv::Rect(gap, gap, marker, marker)));
    }
  }
  return picture;
}

// Of a board as OpenCV since 4.6 has it: the middle of each marker by its number, in squares from
// the upper left corner.
inline std::vector<cv::Point2f> marker_middles(cv::Size squares) {
  std::vector<std::vector<cv::Point3f>> corners;
#if CALVIN_CHARUCO_IN_OBJDETECT
  corners = cv::aruco::CharucoBoard(squares, 1, 0.5F,
                                    cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250))
                .getObjPoints();
#else
  corners =
      cv::aruco::CharucoBoard::create(squares.width, squares.height, 1, 0.5F,
                                      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_250))
          ->objPoints;
#endif
  std::vector<cv::Point2f> middles;
  for (const auto& marker : corners) {
    const cv::Point3f middle = (marker[0] + marker[2]) / 2;
    middles.emplace_back(middle.x, middle.y);
  }
  return middles;
}

}  // namespace calvin::scenes
