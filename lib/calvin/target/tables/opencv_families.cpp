// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Asks OpenCV for what it calls its predefined dictionaries.

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/version.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco/dictionary.hpp>
#endif

#include "printed_dictionary.hpp"

namespace printed {

namespace {

struct Name {
  const char* name;
  int number;
};

#define CALVIN_NAME(name) \
  { #name, cv::aruco::name }
const std::vector<std::vector<Name>> kFamilies = {
    {CALVIN_NAME(DICT_4X4_1000), CALVIN_NAME(DICT_4X4_250), CALVIN_NAME(DICT_4X4_100),
     CALVIN_NAME(DICT_4X4_50)},
    {CALVIN_NAME(DICT_5X5_1000), CALVIN_NAME(DICT_5X5_250), CALVIN_NAME(DICT_5X5_100),
     CALVIN_NAME(DICT_5X5_50)},
    {CALVIN_NAME(DICT_6X6_1000), CALVIN_NAME(DICT_6X6_250), CALVIN_NAME(DICT_6X6_100),
     CALVIN_NAME(DICT_6X6_50)},
    {CALVIN_NAME(DICT_7X7_1000), CALVIN_NAME(DICT_7X7_250), CALVIN_NAME(DICT_7X7_100),
     CALVIN_NAME(DICT_7X7_50)},
    {CALVIN_NAME(DICT_ARUCO_ORIGINAL)},
    {CALVIN_NAME(DICT_APRILTAG_16h5)},
    {CALVIN_NAME(DICT_APRILTAG_25h9)},
    {CALVIN_NAME(DICT_APRILTAG_36h10)},
    {CALVIN_NAME(DICT_APRILTAG_36h11)},
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 8
    {CALVIN_NAME(DICT_ARUCO_MIP_36h12)},
#endif
};
#undef CALVIN_NAME

Dictionary dictionary_of(const Name& name) {
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  const cv::aruco::Dictionary known = cv::aruco::getPredefinedDictionary(name.number);
#else
  const cv::aruco::Dictionary known = *cv::aruco::getPredefinedDictionary(name.number);
#endif
  Dictionary dictionary;
  dictionary.name = name.name;
  dictionary.side = known.markerSize;
  for (int id = 0; id < known.bytesList.rows; ++id) {
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
        known.bytesList.rowRange(id, id + 1), known.markerSize);
    std::uint64_t code = 0;
    for (int row = 0; row < bits.rows; ++row) {
      for (int col = 0; col < bits.cols; ++col) code = code << 1 | bits.at<std::uint8_t>(row, col);
    }
    dictionary.codes.push_back(code);
  }
  return dictionary;
}

}  // namespace

std::vector<Family> opencv_families() {
  std::vector<Family> all;
  for (const auto& names : kFamilies) {
    Family& family = all.emplace_back();
    for (const Name& name : names) family.push_back(dictionary_of(name));
  }
  return all;
}

}  // namespace printed
