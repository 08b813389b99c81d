// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The search for tags of one style from level to level of a pyramid, and the sheets that they make.
#pragma once

#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "calvin/detect/pyramid.hpp"
#include "calvin/detect/tags/quads.hpp"
#include "calvin/detect/tags/sheet/sheet_conflicts.hpp"
#include "calvin/detect/tags/sheet/tag_sheet.hpp"
#include "calvin/detect/tags/tag_reader.hpp"

namespace calvin::detect {

// A grid of tags that is looked for.
struct WantedTags {
  TagGrid board;
  std::size_t kind = 0;  // which of all grids that are looked for
  // How many others are as good: any tag of a list may be one that only seems to be a tag.
  std::size_t rivals = 0;
};

struct FoundTags {
  std::size_t kind = 0;
  TagSheet sheet;
};

class TagSearch {
 public:
  // Boards of one style, at least one.
  explicit TagSearch(std::vector<WantedTags> boards);

  [[nodiscard]] const TagStyle& style() const { return reader_.style(); }
  [[nodiscard]] const TagReader& reader() const { return reader_; }

  // From here on another picture.
  void begin();
  // Reads the quads of a level that no tag is known in yet.
  void read(Pyramid& pyramid, int level, std::span<const Quad> quads, const std::stop_token& stop);
  // Makes sheets of the tags that were read. The image is the pyramid's level 0.
  void make_sheets(Pyramid& pyramid, const std::stop_token& stop);

  // Adds a sheet whose tags are expected at these places; false where one of them is not there.
  [[nodiscard]] bool follow(const ImageView& image, std::size_t kind,
                            std::span<const PlacedQuad> expected);

  [[nodiscard]] std::vector<FoundTags>& sheets() { return sheets_; }

 private:
  [[nodiscard]] bool is_of_a_board(int id) const;
  [[nodiscard]] bool is_known(const Quad& quad) const;
  void read_quad(Pyramid& pyramid, int level, const Quad& quad);
  [[nodiscard]] std::vector<std::size_t> tags_of(const TagGrid& board) const;
  [[nodiscard]] std::vector<NamedQuad> read_quads() const;
  [[nodiscard]] bool add_largest(const ImageView& image);
  [[nodiscard]] bool is_sheet(const TagSheet& sheet) const;
  void drop_rows_of_others();

  std::vector<WantedTags> boards_;
  TagReader reader_;
  std::vector<ReadTag> tags_;
  std::size_t quads_ = 0;  // that may have been tags
  std::vector<FoundTags> sheets_;
  std::vector<FoundTags> refused_;
};

}  // namespace calvin::detect
