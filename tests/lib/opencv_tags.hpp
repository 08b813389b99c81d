// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// What OpenCV's detector of ArUco markers finds of a grid of tags, whichever module it is in.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/aruco_detector.hpp>
#else
#include <opencv2/aruco.hpp>
#endif

#include "calvin/core/observation.hpp"
#include "calvin/target/kinds.hpp"

#include "opencv_charuco.hpp"

namespace calvin::scenes {

inline Observation opencv_tags(const cv::Mat& image, const Board& board, bool refine) {
  const TagGrid& tags = *board.as<TagGrid>();
  const auto names = opencv_dictionaries();
  const auto number =
      static_cast<int>(std::ranges::find(names, tags.dictionary->name) - names.begin());
  const cv::Mat dark = tags.inverted ? cv::Mat(255 - image) : image;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  cv::aruco::DetectorParameters parameters;
  if (refine) parameters.cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::ArucoDetector(cv::aruco::getPredefinedDictionary(number), parameters)
      .detectMarkers(dark, corners, ids);
#else
  const auto parameters = cv::aruco::DetectorParameters::create();
  if (refine) parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  cv::aruco::detectMarkers(dark, cv::aruco::getPredefinedDictionary(number), corners, ids,
                           parameters);
#endif
  std::vector<std::pair<int, Pixel>> all;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto place = tags.place_of(ids[i]);
    if (!place) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const GridPlace at{2 * place->col + (k == 1 || k == 2 ? 1 : 0),
                         2 * place->row + (k >= 2 ? 1 : 0)};
      const cv::Point2f& p = corners[i][k];
      all.push_back({tags.grid().id(at), {static_cast<double>(p.x), static_cast<double>(p.y)}});
    }
  }
  std::ranges::sort(all, {}, [](const auto& corner) { return corner.first; });
  Observation seen;
  seen.image_size = {image.cols, image.rows};
  for (const auto& [id, at] : all) {
    seen.ids.push_back(id);
    seen.uv.push_back(at);
  }
  return seen;
}

}  // namespace calvin::scenes
