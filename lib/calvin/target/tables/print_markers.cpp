// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Writes the source of the tables of markers: what OpenCV calls its predefined dictionaries.

#include <algorithm>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include <opencv2/core/version.hpp>
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
#include <opencv2/objdetect/aruco_dictionary.hpp>
#else
#include <opencv2/aruco/dictionary.hpp>
#endif

namespace {

struct Name {
  const char* name;
  int number;
};

// Each family once, its largest dictionary first: the smaller ones are the beginning of it.
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

struct Table {
  int side = 0;
  std::vector<std::uint64_t> codes;
};

Table table_of(int number) {
#if CV_VERSION_MAJOR > 4 || CV_VERSION_MINOR >= 7
  const cv::aruco::Dictionary dictionary = cv::aruco::getPredefinedDictionary(number);
#else
  const cv::aruco::Dictionary dictionary = *cv::aruco::getPredefinedDictionary(number);
#endif
  Table table;
  table.side = dictionary.markerSize;
  for (int id = 0; id < dictionary.bytesList.rows; ++id) {
    const cv::Mat bits = cv::aruco::Dictionary::getBitsFromByteList(
        dictionary.bytesList.rowRange(id, id + 1), dictionary.markerSize);
    std::uint64_t code = 0;
    for (int row = 0; row < bits.rows; ++row) {
      for (int col = 0; col < bits.cols; ++col) code = code << 1 | bits.at<std::uint8_t>(row, col);
    }
    table.codes.push_back(code);
  }
  return table;
}

void write_codes(std::FILE* file, const char* name, const Table& table) {
  std::fprintf(file, "constexpr std::uint64_t k%s[] = {", name);
  for (std::size_t i = 0; i < table.codes.size(); ++i) {
    std::fprintf(file, "%s0x%" PRIx64 ",", i % 6 == 0 ? "\n    " : " ", table.codes[i]);
  }
  std::fprintf(file, "\n};\n\n");
}

bool begins_with(const std::vector<std::uint64_t>& all, const std::vector<std::uint64_t>& first) {
  return first.size() <= all.size() && std::equal(first.begin(), first.end(), all.begin());
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* file = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (file == nullptr) {
    std::fprintf(stderr, "usage: print_markers FILE, where FILE can be written\n");
    return 2;
  }
  std::fprintf(file,
               "// Written by print_markers.\n\n"
               "#include \"calvin/target/marker_dictionary.hpp\"\n\nnamespace calvin {\n\n"
               "namespace {\n\n");
  std::string list;
  for (const auto& family : kFamilies) {
    const Table whole = table_of(family.front().number);
    write_codes(file, family.front().name, whole);
    for (const Name& name : family) {
      const Table table = table_of(name.number);
      // A part that is none would have a table of its own.
      const bool is_part = begins_with(whole.codes, table.codes);
      if (!is_part) write_codes(file, name.name, table);
      list += "    {\"" + std::string(name.name) + "\", " + std::to_string(table.side) +
              ", std::span(k" + (is_part ? family.front().name : name.name) + ").first(" +
              std::to_string(table.codes.size()) + ")},\n";
    }
  }
  std::fprintf(file,
               "constexpr MarkerDictionary kDictionaries[] = {\n%s};\n\n}  // namespace\n\n"
               "std::span<const MarkerDictionary> marker_dictionaries() noexcept {\n"
               "  return kDictionaries;\n}\n\n}  // namespace calvin\n",
               list.c_str());
  return std::fclose(file) == 0 ? 0 : 1;
}
