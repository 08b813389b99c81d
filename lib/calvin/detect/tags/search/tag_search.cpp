// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads quads, fits the tags among them, and lets sheets grow from one tag each.

#include "calvin/detect/tags/search/tag_search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace calvin::detect {

namespace {

constexpr double kLeastSheetEvidence = 6;  // nats, of a sheet

double least_gap(const std::vector<WantedTags>& boards) {
  const auto gap = [](const WantedTags& b) { return b.board.gap / b.board.tag; };
  return gap(std::ranges::min(boards, {}, gap));
}

}  // namespace

TagSearch::TagSearch(std::vector<WantedTags> boards)
    : boards_(std::move(boards)), reader_(TagStyle(boards_.front().board), least_gap(boards_)) {}

void TagSearch::begin() {
  tags_.clear();
  sheets_.clear();
  quads_ = 0;
}

bool TagSearch::is_of_a_board(int id) const {
  return std::ranges::any_of(
      boards_, [id](const WantedTags& b) { return b.board.place_of(id).has_value(); });
}

bool TagSearch::is_known(const Quad& quad) const {
  constexpr double kNear = 0.3;  // of the shortest side
  const double near = kNear * shortest_side(quad);
  return std::ranges::any_of(tags_, [&](const ReadTag& t) {
    return (centre_of(t.fit.corners) - centre_of(quad)).norm() < near;
  });
}

void TagSearch::read(Pyramid& pyramid, int level, std::span<const Quad> quads,
                     const std::stop_token& stop) {
  for (const Quad& quad : quads) {
    if (stop.stop_requested()) return;
    Quad in_image = quad;
    for (Point& p : in_image) {
      for (double& x : p) x = static_cast<double>(Pyramid::to_image(static_cast<float>(x), level));
    }
    if (!is_known(in_image)) read_quad(pyramid, level, in_image);
  }
}

// `quad` in px of the image, found in a level.
void TagSearch::read_quad(Pyramid& pyramid, int level, const Quad& quad) {
  // A level whose pixels are not much smaller than the bits of the tag.
  constexpr double kPixels = 3;  // of a bit
  // Pixels as large as bits show none of them.
  constexpr double kLeastBit = 1.2;  // px
  const double bit = shortest_side(quad) / style().cells();
  if (bit < kLeastBit) return;
  const int fine = std::clamp(static_cast<int>(std::log2(std::max(bit / kPixels, 1.0))), 0,
                              pyramid.levels() - 1);
  Quad in_level = quad;
  for (Point& p : in_level) {
    for (double& x : p) x = Pyramid::to_level(x, fine);
  }
  const auto bits = reader_.bits_of(pyramid.level(fine), in_level);
  if (!bits) return;
  ++quads_;
  const auto code = reader_.find(*bits);
  if (!code || !is_of_a_board(code->id)) return;
  Quad upright;
  for (std::size_t i = 0; i < 4; ++i) {
    upright[i] = quad[(i + static_cast<std::size_t>(code->turns)) % 4];
  }
  const double reach = 1.5 * (1 << level);
  const TagPattern pattern = reader_.pattern_of(code->id);
  // The blur of one tag is likely to be that of the next.
  const double width = tags_.empty() ? kUsualWidth : tags_.back().fit.width;
  const TagGuess guess{upright, reach, unknown_bends(upright), width, SideCare::kRough};
  ReadTag tag{code->id, code->wrong, fit_tag(pyramid.level(0), guess, pattern), false};
  if (tag.fit.seen() > 0) tags_.push_back(tag);
}

// The tags of a board that no sheet has yet, the ones with the fewest wrong bits first.
std::vector<std::size_t> TagSearch::tags_of(const TagGrid& board) const {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < tags_.size(); ++i) {
    if (!tags_[i].taken && board.place_of(tags_[i].id)) all.push_back(i);
  }
  std::ranges::stable_sort(all, {}, [&](std::size_t i) { return tags_[i].wrong; });
  return all;
}

std::vector<NamedQuad> TagSearch::read_quads() const {
  std::vector<NamedQuad> read;
  for (const ReadTag& tag : tags_) read.push_back({tag.id, tag.fit.corners});
  return read;
}

// Adds the sheet of the most tags that are left. False where there is none.
bool TagSearch::add_largest(const ImageView& image) {
  const std::vector<NamedQuad> read = read_quads();
  std::optional<FoundTags> best;
  std::size_t rivals = 0;
  for (const WantedTags& wanted : boards_) {
    const auto seeds = tags_of(wanted.board);
    std::vector<bool> tried(tags_.size(), false);
    for (const std::size_t seed : seeds) {
      if (tried[seed]) continue;
      TagSheet sheet(wanted.board);
      sheet.grow(tags_, seed);
      for (const SheetTag& t : sheet.tags()) tried[*t.read] = true;
      if (is_of_another_board(sheet, read)) continue;
      const std::size_t count = sheet.tags().size();
      if (!best || count > best->sheet.tags().size()) {
        best = FoundTags{wanted.kind, sheet};
        rivals = wanted.rivals;
      }
      if (2 * count > seeds.size()) break;
    }
  }
  if (!best) return false;
  for (const SheetTag& t : best->sheet.tags()) tags_[*t.read].taken = true;
  // Of what is no board, nothing more is looked for.
  const double chances = std::log(static_cast<double>(rivals + 1));
  if (best->sheet.evidence(tags_, reader_, quads_) < kLeastSheetEvidence + chances) return true;
  best->sheet.complete(image, reader_);
  // Read as a tag of the sheet too far away from where the others let it be expected.
  for (ReadTag& tag : tags_) tag.taken = tag.taken || lies_on(best->sheet, tag.fit.corners);
  (is_sheet(best->sheet) ? sheets_ : refused_).push_back(std::move(*best));
  return true;
}

// Whether the tags of a sheet are enough, and no other sheet has them.
bool TagSearch::is_sheet(const TagSheet& sheet) const {
  const TagGrid& board = sheet.board();
  if (sheet.certain_tags() < std::min(2, board.cols * board.rows)) return false;
  if (is_among_others(sheet)) return false;
  return std::ranges::none_of(sheets_,
                              [&](const FoundTags& other) { return overlap(other.sheet, sheet); });
}

void TagSearch::make_sheets(Pyramid& pyramid, const std::stop_token& stop) {
  sheets_.clear();
  refused_.clear();
  for (ReadTag& tag : tags_) tag.taken = false;
  while (!stop.stop_requested() && add_largest(pyramid.level(0))) {
  }
  drop_rows_of_others();
}

// Of another board that was hardly read each row may have become a sheet of its own.
void TagSearch::drop_rows_of_others() {
  std::vector<NamedQuad> seen = read_quads();
  for (const auto* sheets : {&sheets_, &refused_}) {
    for (const FoundTags& found : *sheets) {
      const TagGrid& board = found.sheet.board();
      for (const SheetTag& tag : found.sheet.tags()) {
        seen.push_back({board.tag_in(tag.place.col, tag.place.row), tag.fit.corners});
      }
    }
  }
  std::erase_if(sheets_, [&](const FoundTags& f) { return is_of_another_board(f.sheet, seen); });
}

bool TagSearch::follow(const ImageView& image, std::size_t kind,
                       std::span<const PlacedQuad> expected) {
  const auto wanted = std::ranges::find(boards_, kind, &WantedTags::kind);
  if (wanted == boards_.end()) return false;
  TagSheet sheet(wanted->board);
  if (!sheet.follow(image, reader_, expected)) return false;
  sheets_.push_back({kind, std::move(sheet)});
  return true;
}

}  // namespace calvin::detect
