// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which place each sheet has among the results, from one picture to the next.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/checkerboard/sheets/sheet.hpp"
#include "calvin/detect/checkerboard/sheets/tracker.hpp"

namespace calvin::detect {

// A place among the results: that of a board in the list, or of a further sheet.
struct SheetPlace {
  std::size_t board = 0;             // in the list
  std::size_t wanted = 0;            // which of the boards that differ
  std::optional<std::size_t> sheet;  // of this picture, absent where none was found
  std::optional<Pixel> last;         // px, the centre of the sheet that was here last
  std::shared_ptr<Tracker> tracker;  // of the sheet that was here last; absent before there was one
};

// A sheet keeps its place as long as the ones before it stay in view: equal sheets are told apart
// by where they were.
class SheetPlaces {
 public:
  // For each board of the list which of the boards that differ it is.
  explicit SheetPlaces(std::span<const std::size_t> wanted);

  [[nodiscard]] std::vector<SheetPlace>& all() { return all_; }

  // From here on another picture: no place has a sheet.
  void begin();

  // Gives each sheet that has no place yet one: where a sheet was nearest, then in the order of the
  // distance from the top left of the image. A place of the list stays, found or not; a further one
  // goes when nothing was found for it.
  void assign(std::span<const Sheet> sheets);

 private:
  [[nodiscard]] std::vector<std::size_t> without_place(std::span<const Sheet> sheets) const;
  void assign_nearest(std::span<const Sheet> sheets);
  void assign_others(std::span<const Sheet> sheets);
  void close_gaps();

  std::size_t listed_;
  std::vector<SheetPlace> all_;
};

}  // namespace calvin::detect
