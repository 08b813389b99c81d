// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CodeIndex: the codes of a dictionary by parts of their bits, to find the nearest one quickly.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "calvin/target/marker_dictionary.hpp"

namespace calvin::detect {

// A tag as it was read.
struct TagCode {
  int id = 0;
  int turns = 0;  // the upper left corner of the tag is the quad's corner of this number
  int wrong = 0;  // bits that are not the tag's
};

// Turns the bits of tags of a dictionary by a quarter: the first row becomes the last column.
class QuarterTurn {
 public:
  explicit QuarterTurn(const MarkerDictionary& dictionary);

  [[nodiscard]] std::uint64_t operator()(std::uint64_t bits) const noexcept {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < kBytes; ++i) all |= turned_[i][bits >> 8 * i & 0xff];
    return all;
  }

 private:
  static constexpr std::size_t kBytes = 8;

  std::array<std::array<std::uint64_t, 256>, kBytes> turned_;  // by each byte
};

// By half a turn: bits lie the same either way up, so that the last one becomes the first one.
[[nodiscard]] std::uint64_t half_turned(std::uint64_t bits, int count);

// Where at most k bits are wrong, one of k + 1 parts of a code is right, and of half as many one
// has at most one wrong bit: only codes that share a part, or nearly do, are compared.
class CodeIndex {
 public:
  CodeIndex(const MarkerDictionary& dictionary, int most_wrong);

  // The code of which the fewest bits differ, turned in any way; absent where more differ than
  // allowed. Of equal ones the one that is turned least, then the first one.
  [[nodiscard]] std::optional<TagCode> nearest(std::uint64_t bits) const;

  [[nodiscard]] int most_wrong() const noexcept { return most_wrong_; }

 private:
  // Bits of a code, and the codes by what they have there, each in all turns.
  struct Part {
    int shift = 0;
    int width = 0;  // bits
    std::vector<std::uint32_t>
        first;  // of `codes`, for each value of the bits, and behind the last
    std::vector<std::uint32_t> codes;

    [[nodiscard]] std::size_t value(std::uint64_t bits) const noexcept {
      return static_cast<std::size_t>(bits >> shift & ((std::uint64_t{1} << width) - 1));
    }
  };
  struct Nearest {
    int wrong = 0;
    std::size_t code = 0;
  };

  void make_part(Part& part) const;
  // Compares the codes that have a value in a part.
  void compare(std::uint64_t bits, const Part& part, std::size_t value, Nearest& best) const;

  int most_wrong_;
  bool is_near_ = false;  // a bit of a part may be wrong
  // Those that are not turned first; by ids, and turned until they are upright by as many quarters.
  std::vector<std::uint64_t> codes_;
  std::size_t count_ = 0;  // of each turn
  std::vector<Part> parts_;
};

}  // namespace calvin::detect
