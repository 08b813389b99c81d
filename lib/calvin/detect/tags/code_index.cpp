// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Codes sorted by what each part of their bits is.

#include "calvin/detect/tags/code_index.hpp"

#include <algorithm>
#include <cstddef>

namespace calvin::detect {

namespace {

constexpr int kMostBits = 12;  // of a part

// std::popcount() is a call of a function where the processor is any x86-64.
int bits_in(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555U;
  v = (v & 0x3333333333333333U) + (v >> 2 & 0x3333333333333333U);
  v = (v + (v >> 4)) & 0x0f0f0f0f0f0f0f0fU;
  return static_cast<int>(v * 0x0101010101010101U >> 56);
}

// Whether one is better than another.
bool is_before(const TagCode& a, const TagCode& b) {
  if (a.wrong != b.wrong) return a.wrong < b.wrong;
  return a.turns != b.turns ? a.turns < b.turns : a.id < b.id;
}

}  // namespace

std::uint64_t turned(std::uint64_t bits, int side) {
  std::uint64_t all = 0;
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      // The new bit at (col, row) was at (row, side - 1 - col).
      const int from = side * side - 1 - ((side - 1 - col) * side + row);
      all = all << 1 | (bits >> from & 1);
    }
  }
  return all;
}

CodeIndex::CodeIndex(const MarkerDictionary& dictionary, int most_wrong)
    : dictionary_(&dictionary), most_wrong_(most_wrong) {
  const int bits = dictionary.side * dictionary.side;
  const int parts = std::min(most_wrong + 1, bits);
  parts_.resize(static_cast<std::size_t>(parts));
  for (int k = 0; k < parts; ++k) {
    Part& part = parts_[static_cast<std::size_t>(k)];
    part.shift = k * bits / parts;
    const int width = std::min((k + 1) * bits / parts - part.shift, kMostBits);
    part.mask = (std::uint64_t{1} << width) - 1;
    part.first.assign(static_cast<std::size_t>(part.mask) + 2, 0);
    for (const std::uint64_t code : dictionary.codes) ++part.first[part.value(code) + 1];
    for (std::size_t i = 1; i < part.first.size(); ++i) part.first[i] += part.first[i - 1];
    part.ids.resize(dictionary.codes.size());
    std::vector<std::uint32_t> next = part.first;
    for (std::size_t id = 0; id < dictionary.codes.size(); ++id) {
      part.ids[next[part.value(dictionary.codes[id])]++] = static_cast<std::uint32_t>(id);
    }
  }
}

std::optional<TagCode> CodeIndex::nearest(std::uint64_t bits) const {
  TagCode best;
  best.wrong = most_wrong_ + 1;
  for (int turns = 0; turns < 4; ++turns) {
    for (const Part& part : parts_) {
      const std::size_t value = part.value(bits);
      for (std::uint32_t i = part.first[value]; i < part.first[value + 1]; ++i) {
        const std::uint32_t id = part.ids[i];
        const TagCode code = {static_cast<int>(id), turns, bits_in(bits ^ dictionary_->codes[id])};
        if (code.wrong <= most_wrong_ && is_before(code, best)) best = code;
      }
    }
    bits = turned(bits, dictionary_->side);
  }
  if (best.wrong > most_wrong_) return std::nullopt;
  best.turns = (4 - best.turns) % 4;
  return best;
}

}  // namespace calvin::detect
