// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Which tag a quad is.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "calvin/core/image.hpp"
#include "calvin/detect/tags/code_index.hpp"
#include "calvin/detect/tags/point.hpp"
#include "calvin/detect/tags/tag_pattern.hpp"
#include "calvin/detect/tags/tag_style.hpp"

namespace calvin::detect {

// The bits of a quad, the highest one first, as in MarkerDictionary.
struct TagBits {
  std::uint64_t plain = 0;
  std::uint64_t sharpened = 0;  // where each cell is compared with those beside it, too
};

// How the cells of a quad look beside those of a tag that should be there.
struct TagMatch {
  int seen = 0;   // bits in the image
  int right = 0;  // of them
  int border_seen = 0;
  int border_right = 0;
};

class TagReader {
 public:
  // `gap`: what is free around a tag of these boards, in parts of its side; around one with bits
  // outside of its border that is known.
  TagReader(const TagStyle& style, double gap);
  // With codes that other readers have, too.
  TagReader(const TagStyle& style, double gap, std::shared_ptr<const CodeIndex> codes);

  // A quad that has the dark border of a tag, whatever its bits are, and light around it; absent
  // for any other one, and for one that is dark all over where no code is.
  [[nodiscard]] std::optional<TagBits> bits_of(const ImageView& image, const Quad& quad) const;

  // The tag with such bits; absent where they are nearer to none than errors that the dictionary
  // can bear.
  [[nodiscard]] std::optional<TagCode> find(const TagBits& bits) const;

  // What is printed in a tag of this style; there is a gap, but no neighbour around it.
  [[nodiscard]] TagPattern pattern_of(int id) const;

  // How far a quad looks like a tag whose upper left corner is the quad's first one.
  [[nodiscard]] TagMatch match(const ImageView& image, const Quad& quad,
                               const TagPattern& tag) const;

  // nats: how unlikely so many right bits are in a quad that is no tag.
  [[nodiscard]] double evidence(int wrong) const;

  [[nodiscard]] const TagStyle& style() const { return style_; }

 private:
  TagStyle style_;
  double gap_;     // cells, around a tag
  double around_;  // where the light around a tag is looked at, in cells from its border
  std::shared_ptr<const CodeIndex> codes_;
  bool has_light_bits_ = false;       // in each code more than those that may be wrong
  std::vector<GridPlace> looked_at_;  // bits and the cells beside them, from the first bit's column
};

}  // namespace calvin::detect
