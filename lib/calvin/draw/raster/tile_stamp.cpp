// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Converts the pixels of a tile that are not transparent, a run of them at a time.

#include "calvin/draw/raster/tile_stamp.hpp"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

#include "calvin/draw/raster/stamp_kernels.hpp"

namespace calvin {

namespace {

// Runs begin and end at multiples of so many pixels of their tile, where it has them: vectors take
// whole ones, and gaps that are shorter cost less than a run of their own.
constexpr int kStep = 16;

// A row of a tile, or a part of it, in components; and what stands for one that there is not.
struct Components {
  explicit Components(int width)
      : room(static_cast<std::size_t>(std::max(0, width) + kSpareComponents)), bytes(6 * room) {
    std::fill_n(&bytes[5 * room], room, 255);
  }
  [[nodiscard]] ComponentRows rows() {
    return {{&bytes[0], &bytes[room], &bytes[2 * room]}, &bytes[3 * room]};
  }
  [[nodiscard]] const std::uint8_t* add_nothing() const { return &bytes[4 * room]; }
  [[nodiscard]] const std::uint8_t* keep_all() const { return &bytes[5 * room]; }
  std::size_t room;
  std::vector<std::uint8_t> bytes;
};

// How a plane's bytes are made of the rows of components, where they follow each other in turn.
struct PlaneRows {
  InterleavedRows add;
  InterleavedRows keep;
  int y_shift = 0;
};

// `count` samples from `from`, of every 2^shift-th pixel, to every step-th byte.
void scatter(const std::uint8_t* from, int shift, int count, std::uint8_t* to, int step) {
  if (shift == 0 && step == 1) {
    std::copy_n(from, count, to);
    return;
  }
  for (int i = 0; i < count; ++i) {
    to[static_cast<std::ptrdiff_t>(i) * step] = from[static_cast<std::ptrdiff_t>(i) << shift];
  }
}

class StampMaker {
 public:
  StampMaker(const OverlayTile& tile, int left, int top, const PixelLayout& layout,
             TileStamp& stamp)
      : tile_(tile),
        left_(left),
        top_(top),
        layout_(layout),
        first_(std::max(0, -left)),
        end_(std::min(tile.width, layout.size.width - left)),
        components_(tile.width),
        rows_(components_.rows()),
        stamp_(stamp) {
    for (std::size_t p = 0; p < planes_.size(); ++p) planes_[p] = rows_of(static_cast<int>(p));
    joins_spans_ = joins_spans();
  }

  // How many bytes of `add` and `keep` there are; the vectors may be longer.
  std::size_t make() {
    const int last = std::min(tile_.height, layout_.size.height - top_);
    for (int y = std::max(0, -top_); y < last; ++y) {
      add_row(y);
      share_bytes();
    }
    return used_;
  }

  // A row at a time, which stays in the cache.
  void blend(const FramePlanes& frame) {
    const int last = std::min(tile_.height, layout_.size.height - top_);
    for (int y = std::max(0, -top_); y < last; ++y) {
      stamp_.runs.clear();
      used_ = 0;
      add_row(y);
      if (used_ > 0) blend_stamp(stamp_, frame);
    }
  }

 private:
  [[nodiscard]] const std::uint8_t* pixel(int x, int y) const {
    return tile_.pixels.data() + 4 * (static_cast<std::ptrdiff_t>(y) * tile_.width + x);
  }

  [[nodiscard]] bool transparent(int from, int to, int y) const {
    // What is premultiplied is 0 where alpha is.
    const std::uint8_t* bytes = pixel(from, y);
    std::uint32_t all = 0;
    for (int i = 0; i < to - from; ++i) {
      std::uint32_t one = 0;
      std::memcpy(&one, bytes + static_cast<std::ptrdiff_t>(4) * i, sizeof(one));
      all |= one;
    }
    return all == 0;
  }

  // Rows come from the top on.
  void add_row(int y) {
    if (tile_.spans.empty()) return add_unknown_row(y);
    const std::vector<TileSpan>& spans = tile_.spans;
    while (span_ < spans.size() && spans[span_].row < y) ++span_;
    std::size_t end = span_;
    while (end < spans.size() && spans[end].row == y) ++end;
    if (joins_spans_) {
      add_spans(std::span(spans).subspan(span_, end - span_), y);
      span_ = end;
    }
    for (; span_ < end; ++span_) {
      const int from = std::max(spans[span_].first, first_);
      const int to = std::min(spans[span_].first + spans[span_].count, end_);
      const auto skipped = static_cast<std::size_t>(std::max(0, from - spans[span_].first));
      if (from < to) add_run(&tile_.pixels[4 * (spans[span_].at + skipped)], from, to, y);
    }
  }

  // All spans of a row at once: the tile holds them one after another, and none ends within a
  // sample.
  void add_spans(std::span<const TileSpan> spans, int y) {
    if (spans.empty()) return;
    const auto count = static_cast<int>(spans.back().at - spans.front().at) + spans.back().count;
    y += top_;
    split_pixels(&tile_.pixels[4 * spans.front().at], count, split_of(y), rows_);
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      if (!planes_[p] || (y & ((1 << planes_[p]->y_shift) - 1)) != 0) continue;
      const PlaneRows& rows = *planes_[p];
      const int shift = rows.add.shift;
      const int step = rows.add.count;
      const int samples = (count + (1 << shift) - 1) >> shift;
      std::size_t at = take(samples * step);
      interleave(rows.add, samples, &stamp_.add[at]);
      interleave(rows.keep, samples, &stamp_.keep[at]);
      for (const TileSpan& span : spans) {
        const int bytes = ((span.count + (1 << shift) - 1) >> shift) * step;
        const int byte = ((left_ + span.first) >> shift) * step;
        stamp_.runs.push_back({static_cast<int>(p), y >> rows.y_shift, byte, bytes, at});
        at += static_cast<std::size_t>(bytes);
      }
    }
  }

  // Whether add_spans() can.
  [[nodiscard]] bool joins_spans() const {
    bool aligned = first_ == 0 && end_ == tile_.width;
    for (int c = 0; c < layout_.count; ++c) {
      const SampleLayout& s = layout_.components.at(static_cast<std::size_t>(c));
      aligned = aligned && planes_[static_cast<std::size_t>(s.plane)] &&
                (left_ & ((1 << s.x_shift) - 1)) == 0;
    }
    return aligned;
  }

  void add_unknown_row(int y) {
    int x = first_;
    while (x < end_) {
      x += blank_pixels(pixel(x, y), end_ - x);
      const int from = x;
      while (x < end_ && !transparent(x, std::min(x + kStep, end_), y)) {
        x = std::min(x + kStep, end_);
      }
      if (from < x) add_run(pixel(from, y), from, x, y);
    }
  }

  // Rows of boxes are like the ones above them: the bytes of a run that are those of the one before
  // in its plane are kept once, or they would fill the cache on each frame.
  void share_bytes() {
    std::size_t used = row_bytes_;
    for (std::size_t i = row_run_; i < stamp_.runs.size(); ++i) {
      TileStamp::Run& run = stamp_.runs[i];
      const auto count = static_cast<std::size_t>(run.count);
      TileStamp::Run& before = before_[static_cast<std::size_t>(run.plane)];
      const auto same = [&](const std::vector<std::uint8_t>& bytes) {
        return std::memcmp(&bytes[run.first], &bytes[before.first], count) == 0;
      };
      if (before.count == run.count && same(stamp_.add) && same(stamp_.keep)) {
        run.first = before.first;
        continue;
      }
      for (auto* bytes : {&stamp_.add, &stamp_.keep}) {
        std::memmove(&(*bytes)[used], &(*bytes)[run.first], count);
      }
      run.first = std::exchange(used, used + count);
      before = run;
    }
    row_bytes_ = used_ = used;
    row_run_ = stamp_.runs.size();
  }

  // Where the next bytes of the stamp begin.
  std::size_t take(int count) {
    const std::size_t at = used_;
    used_ += static_cast<std::size_t>(count);
    if (used_ > stamp_.add.size()) {
      stamp_.add.resize(2 * used_);
      stamp_.keep.resize(2 * used_);
    }
    return at;
  }

  // What a row of the frame has samples of.
  [[nodiscard]] Split split_of(int y) const {
    if (layout_.is_rgb) return Split::kRgb;
    const bool has_chroma = (y & ((1 << layout_.components[1].y_shift) - 1)) == 0;
    return layout_.count > 1 && has_chroma ? Split::kYuv : Split::kLuma;
  }

  void add_run(const std::uint8_t* argb, int from, int to, int y) {
    split_pixels(argb, to - from, split_of(top_ + y), rows_);
    std::array<bool, 3> done{};
    for (int c = 0; c < layout_.count; ++c) {
      const auto plane = static_cast<std::size_t>(layout_.components.at(c).plane);
      if (std::exchange(done[plane], true)) continue;
      if (planes_[plane]) {
        add_interleaved(static_cast<int>(plane), left_ + from, left_ + to, top_ + y);
      } else {
        add_plane(static_cast<int>(plane), left_ + from, left_ + to, top_ + y);
      }
    }
  }

  // Absent where the plane's components do not follow each other in turn.
  [[nodiscard]] std::optional<PlaneRows> rows_of(int plane) const {
    PlaneRows rows;
    std::size_t count = 0;
    bool in_turn = true;
    for_plane(plane, [&](std::size_t c, const SampleLayout& s) {
      constexpr int kMost = 4;
      in_turn = in_turn && s.step <= kMost && s.offset < s.step && s.x_shift <= 1 &&
                (count == 0 || (s.step == rows.add.count && s.x_shift == rows.add.shift &&
                                s.y_shift == rows.y_shift));
      if (!in_turn) return;
      rows.add.count = rows.keep.count = s.step;
      rows.add.shift = rows.keep.shift = s.x_shift;
      rows.y_shift = s.y_shift;
      rows.add.from.at(static_cast<std::size_t>(s.offset)) = rows_.add[c];
      rows.keep.from.at(static_cast<std::size_t>(s.offset)) = rows_.keep;
      ++count;
    });
    if (count == 0 || !in_turn) return {};
    for (std::size_t i = 0; i < static_cast<std::size_t>(rows.add.count); ++i) {
      if (rows.add.from[i] != nullptr) continue;
      rows.add.from[i] = components_.add_nothing();
      rows.keep.from[i] = components_.keep_all();
    }
    return rows;
  }

  // As add_plane().
  void add_interleaved(int plane, int from, int to, int y) {
    const PlaneRows& rows = *planes_.at(static_cast<std::size_t>(plane));
    const int step = rows.add.count;
    const Samples samples =
        samples_of({.x_shift = rows.add.shift, .y_shift = rows.y_shift}, from, to, y);
    const int count = samples.end - samples.first;
    if (count <= 0) return;
    const std::size_t at = take(count * step);
    stamp_.runs.push_back({plane, y >> rows.y_shift, samples.first * step, count * step, at});
    InterleavedRows add = rows.add;
    InterleavedRows keep = rows.keep;
    const int in_row = (samples.first << rows.add.shift) - from;
    for (std::size_t i = 0; i < static_cast<std::size_t>(step); ++i) {
      add.from[i] += in_row;
      keep.from[i] += in_row;
    }
    interleave(add, count, &stamp_.add[at]);
    interleave(keep, count, &stamp_.keep[at]);
  }

  // A component's samples for the pixels from..to of a row of the frame; empty where others hold
  // them.
  struct Samples {
    int first = 0;  // sample, pixel first << x_shift of the frame
    int end = 0;
  };
  [[nodiscard]] static Samples samples_of(const SampleLayout& s, int from, int to, int y) {
    if ((y & ((1 << s.y_shift) - 1)) != 0) return {};
    const int up = (1 << s.x_shift) - 1;
    return {(from + up) >> s.x_shift, (to + up) >> s.x_shift};
  }

  // All components of the plane in one run of bytes.
  void add_plane(int plane, int from, int to, int y) {
    int first = 0;
    int end = 0;
    int row = 0;
    for_plane(plane, [&](std::size_t /*c*/, const SampleLayout& s) {
      const Samples samples = samples_of(s, from, to, y);
      if (samples.first >= samples.end) return;
      // Pixels that share nothing are taken whole, or a vector would end within the last one.
      const bool whole = s.x_shift == 0;
      const int begin = samples.first * s.step + (whole ? 0 : s.offset);
      first = end == 0 ? begin : std::min(first, begin);
      end = std::max(end, whole ? samples.end * s.step : (samples.end - 1) * s.step + s.offset + 1);
      row = y >> s.y_shift;
    });
    if (first >= end) return;
    const std::size_t at = take(end - first);
    stamp_.runs.push_back({plane, row, first, end - first, at});
    std::fill_n(&stamp_.add[at], end - first, 0);
    std::fill_n(&stamp_.keep[at], end - first, 255);
    for_plane(plane, [&](std::size_t c, const SampleLayout& s) {
      const Samples samples = samples_of(s, from, to, y);
      const int count = samples.end - samples.first;
      if (count <= 0) return;
      const auto in_row = static_cast<std::ptrdiff_t>((samples.first << s.x_shift) - from);
      const std::size_t byte =
          at + static_cast<std::size_t>(samples.first * s.step + s.offset - first);
      scatter(rows_.add[c] + in_row, s.x_shift, count, &stamp_.add[byte], s.step);
      scatter(rows_.keep + in_row, s.x_shift, count, &stamp_.keep[byte], s.step);
    });
  }

  template <typename Visit>
  void for_plane(int plane, Visit visit) const {
    for (std::size_t c = 0; c < static_cast<std::size_t>(layout_.count); ++c) {
      if (layout_.components[c].plane == plane) visit(c, layout_.components[c]);
    }
  }

  const OverlayTile& tile_;
  int left_;
  int top_;
  const PixelLayout& layout_;
  int first_;  // column of the tile that is in the frame
  int end_;
  Components components_;
  ComponentRows rows_;
  std::array<std::optional<PlaneRows>, 3> planes_;
  TileStamp& stamp_;
  bool joins_spans_ = false;
  std::size_t used_ = 0;  // of its bytes
  std::size_t span_ = 0;  // the next one of the tile
  // share_bytes(): where the present row begins, and the last run of each plane.
  std::size_t row_bytes_ = 0;
  std::size_t row_run_ = 0;
  std::array<TileStamp::Run, 3> before_;
};

}  // namespace

TileStamp stamp_of(const OverlayTile& tile, int left, int top, const PixelLayout& layout) {
  TileStamp stamp;
  // As much as there can be of 3 or 4 bytes a pixel where half of the tile is transparent.
  stamp.add.resize(tile.pixels.size() / 2);
  stamp.keep.resize(tile.pixels.size() / 2);
  const std::size_t used = StampMaker(tile, left, top, layout, stamp).make();
  for (auto* bytes : {&stamp.add, &stamp.keep}) {
    bytes->resize(used);
    bytes->shrink_to_fit();
  }
  return stamp;
}

void TileStamps::begin_frame(const PixelLayout& layout) {
  if (!(layout == layout_)) entries_.clear();
  layout_ = layout;
  std::erase_if(entries_, [](const auto& entry) { return !entry.second.shown; });
  for (auto& [serial, entry] : entries_) entry.shown = false;
}

void TileStamps::blend(const OverlayTile& tile, int left, int top, const FramePlanes& frame) {
  const auto blend_once = [&] { StampMaker(tile, left, top, layout_, row_).blend(frame); };
  if (tile.serial == 0) return blend_once();
  const auto [known, is_new] = entries_.try_emplace(tile.serial);
  Entry& entry = known->second;
  entry.shown = true;
  if (is_new || entry.left != left || entry.top != top) {
    entry = {left, top, true, {}};
    return blend_once();
  }
  if (!entry.stamp) entry.stamp = stamp_of(tile, left, top, layout_);
  blend_stamp(*entry.stamp, frame);
}

}  // namespace calvin
