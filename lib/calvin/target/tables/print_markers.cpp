// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Writes the source of the tables of markers: the dictionaries of OpenCV and the families of
// libapriltag, of those two that this program is linked with.

#include <algorithm>
#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "printed_dictionary.hpp"

namespace printed {
namespace {

bool has(const std::vector<Family>& families, const std::string& name) {
  return std::ranges::any_of(families, [&](const Family& family) {
    return std::ranges::find(family, name, &Dictionary::name) != family.end();
  });
}

// What both libraries have is OpenCV's.
std::vector<Family> all_families() {
  std::vector<Family> all;
#ifdef CALVIN_PRINT_OPENCV
  all = opencv_families();
#endif
#ifdef CALVIN_PRINT_APRILTAG
  for (Family& family : april_families()) {
    if (!has(all, family.front().name)) all.push_back(std::move(family));
  }
#endif
  return all;
}

void write_codes(std::FILE* file, const Dictionary& dictionary) {
  std::fprintf(file, "constexpr std::uint64_t k%s[] = {", dictionary.name.c_str());
  for (std::size_t i = 0; i < dictionary.codes.size(); ++i) {
    std::fprintf(file, "%s0x%" PRIx64 ",", i % 6 == 0 ? "\n    " : " ", dictionary.codes[i]);
  }
  std::fprintf(file, "\n};\n\n");
}

void write_places(std::FILE* file, const Dictionary& dictionary) {
  std::fprintf(file, "constexpr GridPlace kPlaces_%s[] = {", dictionary.name.c_str());
  for (std::size_t i = 0; i < dictionary.places.size(); ++i) {
    const auto& [col, row] = dictionary.places[i];
    std::fprintf(file, "%s{%d, %d},", i % 10 == 0 ? "\n    " : " ", col, row);
  }
  std::fprintf(file, "\n};\n\n");
}

bool begins_with(const std::vector<std::uint64_t>& all, const std::vector<std::uint64_t>& first) {
  return first.size() <= all.size() && std::equal(first.begin(), first.end(), all.begin());
}

// The line of a dictionary whose codes are the first ones of a table.
std::string entry_of(const Dictionary& dictionary, const std::string& table) {
  const std::string places =
      dictionary.places.empty() ? "{}" : "std::span(kPlaces_" + dictionary.name + ")";
  return "    {\"" + dictionary.name + "\", " + std::to_string(dictionary.side) + ", std::span(k" +
         table + ").first(" + std::to_string(dictionary.codes.size()) + "), " +
         std::to_string(dictionary.distance) + ", " + std::to_string(dictionary.outside) + ", " +
         places + "},\n";
}

void write(std::FILE* file) {
  std::fprintf(file,
               "// Written by print_markers.\n\n"
               "#include \"calvin/target/marker_dictionary.hpp\"\n\nnamespace calvin {\n\n"
               "namespace {\n\n");
  std::string list;
  for (const Family& family : all_families()) {
    const Dictionary& whole = family.front();
    write_codes(file, whole);
    for (const Dictionary& dictionary : family) {
      // A part that is none would have a table of its own.
      const bool is_part = begins_with(whole.codes, dictionary.codes);
      if (!is_part) write_codes(file, dictionary);
      if (!dictionary.places.empty()) write_places(file, dictionary);
      list += entry_of(dictionary, is_part ? whole.name : dictionary.name);
    }
  }
  std::fprintf(file,
               "constexpr MarkerDictionary kDictionaries[] = {\n%s};\n\n}  // namespace\n\n"
               "std::span<const MarkerDictionary> marker_dictionaries() noexcept {\n"
               "  return kDictionaries;\n}\n\n}  // namespace calvin\n",
               list.c_str());
}

}  // namespace
}  // namespace printed

int main(int argc, char** argv) {
  std::FILE* file = argc == 2 ? std::fopen(argv[1], "w") : nullptr;
  if (file == nullptr) {
    std::fprintf(stderr, "usage: print_markers FILE, where FILE can be written\n");
    return 2;
  }
  printed::write(file);
  return std::fclose(file) == 0 ? 0 : 1;
}
