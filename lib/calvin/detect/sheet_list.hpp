// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which sheet each board of a detector's list gets, from one picture to the next.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calvin/core/image.hpp"

namespace calvin::detect {

// A sheet that was found.
struct SheetOf {
  std::size_t kind = 0;  // which of the boards that differ it shows
  Pixel centre;          // px
};

struct ListedSheet {
  std::size_t board = 0;             // in the list
  std::optional<std::size_t> sheet;  // absent where none was found
};

class SheetList {
 public:
  // For each board of the list which of the boards that differ it is.
  explicit SheetList(std::vector<std::size_t> kinds) : kinds_(std::move(kinds)) {}

  // From here on sheets are those of other pictures.
  void forget() { last_.clear(); }

  // Whether so many sheets were found of each board as the list has it.
  [[nodiscard]] bool is_satisfied(std::span<const SheetOf> sheets) const;

  // First one result for each board of the list, which takes the sheet that is nearest to where it
  // had one last, or to the top left of the image; then one for each sheet that is left.
  [[nodiscard]] std::vector<ListedSheet> assign(std::span<const SheetOf> sheets);

 private:
  std::vector<std::size_t> kinds_;
  std::vector<Pixel> last_;  // px, the centres of the results of the last picture
};

}  // namespace calvin::detect
