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
    : most_wrong_(most_wrong), count_(dictionary.codes.size()) {
  const int bits = dictionary.side * dictionary.side;
  codes_.assign(dictionary.codes.begin(), dictionary.codes.end());
  for (int turns = 1; turns < 4; ++turns) {
    for (std::uint64_t code : dictionary.codes) {
      for (int k = turns; k < 4; ++k) code = turned(code, dictionary.side);
      codes_.push_back(code);
    }
  }
  const int parts = std::min(most_wrong + 1, bits);
  parts_.resize(static_cast<std::size_t>(parts));
  for (int k = 0; k < parts; ++k) {
    Part& part = parts_[static_cast<std::size_t>(k)];
    part.shift = k * bits / parts;
    const int width = std::min((k + 1) * bits / parts - part.shift, kMostBits);
    part.mask = (std::uint64_t{1} << width) - 1;
    part.first.assign(static_cast<std::size_t>(part.mask) + 2, 0);
    for (const std::uint64_t code : codes_) ++part.first[part.value(code) + 1];
    for (std::size_t i = 1; i < part.first.size(); ++i) part.first[i] += part.first[i - 1];
    part.codes.resize(codes_.size());
    std::vector<std::uint32_t> next = part.first;
    for (std::size_t i = 0; i < codes_.size(); ++i) {
      part.codes[next[part.value(codes_[i])]++] = static_cast<std::uint32_t>(i);
    }
  }
}

std::optional<TagCode> CodeIndex::nearest(std::uint64_t bits) const {
  int least = most_wrong_ + 1;
  std::size_t best = codes_.size();
  for (const Part& part : parts_) {
    const std::size_t value = part.value(bits);
    for (std::uint32_t k = part.first[value]; k < part.first[value + 1]; ++k) {
      const std::size_t i = part.codes[k];
      const int wrong = bits_in(bits ^ codes_[i]);
      if (wrong > least || (wrong == least && i >= best)) continue;
      least = wrong;
      best = i;
    }
  }
  if (least > most_wrong_) return std::nullopt;
  const auto turns = static_cast<int>(best / count_);
  return TagCode{static_cast<int>(best % count_), (4 - turns) % 4, least};
}

}  // namespace calvin::detect
