// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Codes sorted by what each part of their bits is.

#include "calvin/detect/tags/code_index.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace calvin::detect {

namespace {

// std::popcount() is a call of a function where the processor is any x86-64.
int bits_in(std::uint64_t v) {
  v -= v >> 1 & 0x5555555555555555U;
  v = (v & 0x3333333333333333U) + (v >> 2 & 0x3333333333333333U);
  v = (v + (v >> 4)) & 0x0f0f0f0f0f0f0f0fU;
  return static_cast<int>(v * 0x0101010101010101U >> 56);
}

// How codes are cut into parts.
struct Cut {
  int parts = 1;
  bool is_near = false;  // a bit of a part may be wrong
  int width = 0;         // bits, of the narrowest part
  double cost = 0;       // values that are looked up, and codes that are compared
};

// `count` codes in all turns. A part has no more values than a few times as many.
Cut cut_of(int bits, std::size_t count, int most_wrong, bool is_near) {
  constexpr int kFewestBits = 6;
  constexpr int kMostBits = 18;
  Cut cut{std::min(is_near ? most_wrong / 2 + 1 : most_wrong + 1, bits), is_near, 0, 0};
  const int most = std::clamp(static_cast<int>(std::bit_width(count)), kFewestBits, kMostBits);
  cut.width = std::min(bits / cut.parts, most);
  const double values = cut.parts * (is_near ? cut.width + 1.0 : 1.0);
  cut.cost = values * (1 + static_cast<double>(count >> cut.width));
  return cut;
}

}  // namespace

QuarterTurn::QuarterTurn(const MarkerDictionary& dictionary) : turned_{} {
  const int count = dictionary.bit_count();
  for (int bit = 0; bit < count; ++bit) {
    // The new bit at (col, row) was at (row, side - 1 - col).
    const GridPlace to = dictionary.place_of(bit);
    const int from = dictionary.bit_at(to.row, dictionary.side - 1 - to.col);
    if (from < 0) continue;
    const auto at = static_cast<std::size_t>(count - 1 - from);
    const std::uint64_t one = std::uint64_t{1} << (count - 1 - bit);
    for (std::size_t value = 0; value < 256; ++value) {
      if ((value >> at % 8 & 1) != 0) turned_[at / 8][value] |= one;
    }
  }
}

std::uint64_t half_turned(std::uint64_t bits, int count) {
  std::uint64_t all = 0;
  for (int i = 0; i < count; ++i) all |= (bits >> i & 1) << (count - 1 - i);
  return all;
}

CodeIndex::CodeIndex(const MarkerDictionary& dictionary, int most_wrong)
    : most_wrong_(most_wrong), count_(dictionary.codes.size()) {
  const int bits = dictionary.bit_count();
  const QuarterTurn turned(dictionary);
  codes_.resize(4 * count_);
  std::ranges::copy(dictionary.codes, codes_.begin());
  const auto code_in = [this](std::size_t turns) { return codes_.data() + turns % 4 * count_; };
  for (const std::size_t turns : {3U, 2U, 1U}) {
    std::transform(code_in(turns + 1), code_in(turns + 1) + count_, code_in(turns), turned);
  }
  const Cut exact = cut_of(bits, codes_.size(), most_wrong, false);
  const Cut near = cut_of(bits, codes_.size(), most_wrong, true);
  const Cut& cut = near.cost < exact.cost ? near : exact;
  is_near_ = cut.is_near;
  parts_.resize(static_cast<std::size_t>(cut.parts));
  for (int k = 0; k < cut.parts; ++k) {
    Part& part = parts_[static_cast<std::size_t>(k)];
    part.shift = k * bits / cut.parts;
    part.width = cut.width;
    make_part(part);
  }
}

void CodeIndex::make_part(Part& part) const {
  part.first.assign((std::size_t{1} << part.width) + 1, 0);
  for (const std::uint64_t code : codes_) ++part.first[part.value(code) + 1];
  for (std::size_t i = 1; i < part.first.size(); ++i) part.first[i] += part.first[i - 1];
  part.codes.resize(codes_.size());
  std::vector<std::uint32_t> next = part.first;
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    part.codes[next[part.value(codes_[i])]++] = static_cast<std::uint32_t>(i);
  }
}

void CodeIndex::compare(std::uint64_t bits, const Part& part, std::size_t value,
                        Nearest& best) const {
  for (std::uint32_t k = part.first[value]; k < part.first[value + 1]; ++k) {
    const std::size_t i = part.codes[k];
    const int wrong = bits_in(bits ^ codes_[i]);
    if (wrong > best.wrong || (wrong == best.wrong && i >= best.code)) continue;
    best = {wrong, i};
  }
}

std::optional<TagCode> CodeIndex::nearest(std::uint64_t bits) const {
  Nearest best{most_wrong_ + 1, codes_.size()};
  for (const Part& part : parts_) {
    const std::size_t value = part.value(bits);
    compare(bits, part, value, best);
    for (int k = 0; is_near_ && k < part.width; ++k) {
      compare(bits, part, value ^ std::size_t{1} << k, best);
    }
  }
  if (best.wrong > most_wrong_) return std::nullopt;
  const auto turns = static_cast<int>(best.code / count_);
  return TagCode{static_cast<int>(best.code % count_), (4 - turns) % 4, best.wrong};
}

}  // namespace calvin::detect
