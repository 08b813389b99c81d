// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The tags of one sheet: which of those that were read lie as the board has them, and the others
// where these let them be expected.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/core/observation.hpp"
#include "calvin/detect/maps/lens_map.hpp"
#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/tag_fit.hpp"
#include "calvin/detect/tags/tag_reader.hpp"
#include "calvin/target/tag_grid.hpp"

namespace calvin::detect {

// A tag that was read. Corners from its upper left one on.
struct ReadTag {
  int id = 0;
  int wrong = 0;  // bits
  TagFit fit;
  bool taken = false;  // by a sheet
};

// A tag of a sheet.
struct SheetTag {
  GridPlace place;
  std::optional<std::size_t> read;  // among those that were read; absent: it was looked for here
  bool is_certain = false;          // by its bits; of others too few are in view
  TagFit fit;
  std::optional<TagBends> bends;  // by the map of the sheet, once there is one
};

// Where a tag of a sheet is expected.
struct PlacedQuad {
  GridPlace place;
  Quad corners;
  std::optional<TagBends> bends;
};

class TagSheet {
 public:
  explicit TagSheet(const TagGrid& board) : board_(&board) {}

  // Takes a tag of the board, then all that lie beside those that the sheet has as the board says.
  void grow(std::span<const ReadTag> tags, std::size_t seed);

  // Takes tags that are where they are expected, as those of the frame before, whose bends they
  // have. False where one is not.
  [[nodiscard]] bool follow(const ImageView& image, const TagReader& reader,
                            std::span<const PlacedQuad> expected);

  // Looks for tags that were not read where those around let them be expected, or the map does.
  void complete(const ImageView& image, const TagReader& reader, const LensMap* map = nullptr);

  // Fits all corners again, with bends of the sides by the corners of the whole sheet, and compares
  // them with each other.
  void refine(const ImageView& image, const TagReader& reader);

  [[nodiscard]] const std::vector<SheetTag>& tags() const { return tags_; }
  [[nodiscard]] const TagGrid& board() const { return *board_; }
  [[nodiscard]] Point centre() const;
  // Tags whose bits tell them from others.
  [[nodiscard]] int certain_tags() const;
  // Where its tags let others be expected, how many tags there are that are not those of the board.
  [[nodiscard]] std::size_t others() const { return others_; }
  // nats: how unlikely it is that these tags lie so by chance, where so many quads were read.
  [[nodiscard]] double evidence(std::span<const ReadTag> read, const TagReader& reader,
                                std::size_t quads) const;
  // Whether any tag of the board may be in the image that the sheet does not have.
  [[nodiscard]] bool is_complete(ImageSize size) const;

  [[nodiscard]] Observation observe() const;

 private:
  [[nodiscard]] bool has(GridPlace place) const;
  [[nodiscard]] bool is_beside(GridPlace place) const;
  [[nodiscard]] bool fits(GridPlace place, const Quad& corners) const;
  [[nodiscard]] std::optional<Quad> expect(GridPlace place) const;
  [[nodiscard]] Quad on_board(GridPlace place) const;
  [[nodiscard]] double mean_side() const;  // px, of its tags
  [[nodiscard]] double width() const;      // px, 1 sigma of the blur
  [[nodiscard]] TagPattern pattern(const TagReader& reader, GridPlace place) const;
  [[nodiscard]] std::optional<LensMap> map(ImageSize size) const;
  [[nodiscard]] std::optional<Quad> image_of(const LensMap& map, GridPlace place) const;
  [[nodiscard]] TagBends bends_of(const LensMap& map, GridPlace place, bool is_outside) const;
  [[nodiscard]] bool look_at(const ImageView& image, const TagReader& reader, GridPlace place,
                             const LensMap* map);
  void fit_again(const ImageView& image, const TagReader& reader, const LensMap* map,
                 std::size_t from);
  [[nodiscard]] bool take_if_seen(const ImageView& image, const TagReader& reader, GridPlace place,
                                  const TagGuess& guess);
  void drop_vague_corners();
  void compare_corners(const LensMap& map);

  const TagGrid* board_;
  std::vector<SheetTag> tags_;
  std::size_t others_ = 0;
  double scatter_ = 1;  // the errors of corners beside their sigmas
};

}  // namespace calvin::detect
