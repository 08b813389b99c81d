// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Makes a reader for each family, width of the border and colour.

#include "calvin/detect/tags/search/any_readers.hpp"

#include <algorithm>
#include <memory>

namespace calvin::detect {

namespace {

// The largest of each family of dictionaries; the others begin as it does.
std::vector<const MarkerDictionary*> families() {
  std::vector<const MarkerDictionary*> all;
  for (const MarkerDictionary& one : marker_dictionaries()) {
    const bool is_part = std::ranges::any_of(all, [&](const MarkerDictionary* known) {
      return known->side == one.side && known->codes.size() >= one.codes.size() &&
             std::ranges::equal(one.codes, known->codes.first(one.codes.size()));
    });
    if (!is_part) all.push_back(&one);
  }
  return all;
}

// Whether the same cells are looked at for tags of both styles.
bool are_read_together(const TagStyle& a, const TagStyle& b) {
  return a.dictionary->side == b.dictionary->side && a.dictionary->outside == 0 &&
         b.dictionary->outside == 0 && a.border == b.border && a.inverted == b.inverted;
}

std::vector<Readers> make_readers() {
  constexpr double kGap = 0.12;  // of a tag's side: about a cell, as much as tags need around them
  std::vector<Readers> all;
  for (const MarkerDictionary* family : families()) {
    const bool is_april = family->name.starts_with("DICT_APRILTAG") || family->outside > 0;
    const auto codes = std::make_shared<const CodeIndex>(*family, 0);
    for (const int border : {1, 2}) {
      if (border > 1 && family->outside > 0) continue;
      for (const bool inverted : {false, true}) {
        const TagStyle style(TagGrid{1, 1, 1, kGap, family, is_april, 0, border, inverted});
        const auto same = std::ranges::find_if(
            all, [&](const Readers& readers) { return are_read_together(readers.shape(), style); });
        (same == all.end() ? all.emplace_back() : *same).all.emplace_back(style, kGap, codes);
      }
    }
  }
  return all;
}

}  // namespace

// Never freed: see Board::Board().
const std::vector<Readers>& any_readers() {
  static const auto& readers = *new std::vector<Readers>(make_readers());
  return readers;
}

const MarkerDictionary* smallest_with(const MarkerDictionary& family, int last_id) {
  const MarkerDictionary* best = &family;
  for (const MarkerDictionary& one : marker_dictionaries()) {
    const bool is_part = one.side == family.side && one.codes.size() < best->codes.size() &&
                         std::ranges::equal(one.codes, family.codes.first(one.codes.size()));
    if (is_part && static_cast<int>(one.codes.size()) > last_id) best = &one;
  }
  return best;
}

}  // namespace calvin::detect
