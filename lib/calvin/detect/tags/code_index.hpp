// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// CodeIndex: the codes of a dictionary by parts of their bits, to find the nearest one quickly.
#pragma once

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

// The bits of a tag that is turned by a quarter: the first row becomes the last column.
[[nodiscard]] std::uint64_t turned(std::uint64_t bits, int side);

// Where at most k bits are wrong, one of k + 1 parts of a code is right: only codes that share a
// part are compared.
class CodeIndex {
 public:
  CodeIndex(const MarkerDictionary& dictionary, int most_wrong);

  // The code of which the fewest bits differ, turned in any way; absent where more differ than
  // allowed. Of equal ones the one that is turned least, then the first one.
  [[nodiscard]] std::optional<TagCode> nearest(std::uint64_t bits) const;

 private:
  // Bits of a code, and the codes by what they have there, each in all turns.
  struct Part {
    int shift = 0;
    std::uint64_t mask = 0;
    std::vector<std::uint32_t>
        first;  // of `codes`, for each value of the bits, and behind the last
    std::vector<std::uint32_t> codes;

    [[nodiscard]] std::size_t value(std::uint64_t bits) const noexcept {
      return static_cast<std::size_t>(bits >> shift & mask);
    }
  };

  int most_wrong_;
  // Those that are not turned first; by ids, and turned until they are upright by as many quarters.
  std::vector<std::uint64_t> codes_;
  std::size_t count_ = 0;  // of each turn
  std::vector<Part> parts_;
};

}  // namespace calvin::detect
