// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sorts the shapes of the overlay into tiles and paints those that have changed.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calvin/draw/overlay_raster.hpp"

namespace calvin {

// Whole pixels, right and bottom excluded.
struct CellBox {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  [[nodiscard]] bool empty() const noexcept { return left >= right || top >= bottom; }
};

namespace {

// The pixels of an extent.
CellBox box_around(const Extent& extent) {
  static constexpr double kFarthest = 1e6;  // beyond any frame
  const auto whole = [](double value) {
    return static_cast<int>(std::clamp(value, -kFarthest, kFarthest));
  };
  return {whole(std::floor(extent.left)), whole(std::floor(extent.top)),
          whole(std::ceil(extent.right)) + 1, whole(std::ceil(extent.bottom)) + 1};
}

CellBox clipped(const CellBox& box, const CellBox& bounds) {
  return {std::clamp(box.left, bounds.left, bounds.right),
          std::clamp(box.top, bounds.top, bounds.bottom),
          std::clamp(box.right, bounds.left, bounds.right),
          std::clamp(box.bottom, bounds.top, bounds.bottom)};
}

CellBox united(const CellBox& a, const CellBox& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

}  // namespace

// The frame in square cells; each knows the shapes that touch it.
class OverlayCells {
 public:
  explicit OverlayCells(ImageSize frame)
      : frame_{0, 0, frame.width, frame.height},
        cell_(std::clamp(std::min(frame.width, frame.height) / 24 / 8 * 8, 16, 64)),
        columns_((frame.width + cell_ - 1) / cell_),
        rows_((frame.height + cell_ - 1) / cell_),
        touched_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
        moves_(touched_.size()) {}

  [[nodiscard]] bool are_of(ImageSize frame) const noexcept {
    return frame_.right == frame.width && frame_.bottom == frame.height;
  }
  // No shape touches any.
  void clear() {
    for (auto& shapes : touched_) shapes.clear();
    moves_.assign(moves_.size(), false);
    boxes_.clear();
  }

  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] const std::vector<std::size_t>& touching(int column, int row) const {
    return touched_[index(column, row)];
  }
  [[nodiscard]] CellBox cells(int first_column, int last_column, int row) const noexcept {
    return {first_column * cell_, row * cell_, std::min((last_column + 1) * cell_, frame_.right),
            std::min((row + 1) * cell_, frame_.bottom)};
  }

  // Cells of one tile: what moves draws nothing again beside it.
  [[nodiscard]] bool join(int column, int next, int row) const {
    return !touching(next, row).empty() && moves_[index(column, row)] == moves_[index(next, row)];
  }

  // Around the shape of that number, in the order in which they were added.
  [[nodiscard]] const CellBox& box(std::size_t number) const { return boxes_[number]; }

  // A line is cut into pieces of a cell's length, so that a diagonal does not touch its whole
  // bounding box.
  void add(const Shape& shape) {
    const std::size_t number = boxes_.size();
    boxes_.push_back(box_around(extent_of(shape)));
    const double length =
        std::max(std::abs(shape.to.u - shape.from.u), std::abs(shape.to.v - shape.from.v));
    const int pieces =
        shape.kind == Shape::Kind::kLine ? static_cast<int>(std::ceil(length / cell_)) : 1;
    for (int i = 0; i < pieces || i == 0; ++i) {
      Shape piece = shape;
      if (pieces > 1) {
        piece.from = between(shape, static_cast<double>(i) / pieces);
        piece.to = between(shape, static_cast<double>(i + 1) / pieces);
      }
      touch(clipped(box_around(extent_of(piece)), frame_), number, shape.moves);
    }
  }

 private:
  [[nodiscard]] std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  [[nodiscard]] static Pixel between(const Shape& shape, double t) noexcept {
    return {std::lerp(shape.from.u, shape.to.u, t), std::lerp(shape.from.v, shape.to.v, t)};
  }

  void touch(const CellBox& box, std::size_t number, bool moves) {
    if (box.empty()) return;
    for (int row = box.top / cell_; row <= (box.bottom - 1) / cell_; ++row) {
      for (int column = box.left / cell_; column <= (box.right - 1) / cell_; ++column) {
        auto& shapes = touched_[index(column, row)];
        if (shapes.empty() || shapes.back() != number) shapes.push_back(number);
        if (moves) moves_[index(column, row)] = true;
      }
    }
  }

  CellBox frame_;
  int cell_;  // px, a multiple of 8
  int columns_;
  int rows_;
  std::vector<std::vector<std::size_t>> touched_;
  std::vector<bool> moves_;  // whether one of them does
  std::vector<CellBox> boxes_;
};

namespace {

// In a tile whose first pixel is at (left, top).
void paint(const Shape& shape, int left, int top, TilePlanes& planes) {
  const auto level = [](double part) { return static_cast<std::uint8_t>(std::lround(255 * part)); };
  const auto x = [left](const Pixel& at) { return static_cast<float>(at.u - left); };
  const auto y = [top](const Pixel& at) { return static_cast<float>(at.v - top); };
  const Colour& colour = shape.colour;
  const Ink ink{{level(colour.blue), level(colour.green), level(colour.red), level(colour.alpha)}};
  if (shape.kind == Shape::Kind::kBox) {
    paint_box({x(shape.from), y(shape.from), x(shape.to), y(shape.to)}, ink, planes);
    return;
  }
  Stroke stroke{.x = x(shape.from), .y = y(shape.from)};
  stroke.half = static_cast<float>(shape.width / 2);
  stroke.halo = static_cast<float>(shape.halo);
  if (shape.kind == Shape::Kind::kLine) {
    const Pixel way{shape.to.u - shape.from.u, shape.to.v - shape.from.v};
    const double length = std::hypot(way.u, way.v);
    stroke.length = static_cast<float>(length);
    stroke.along_x = length > 0 ? static_cast<float>(way.u / length) : 0;
    stroke.along_y = length > 0 ? static_cast<float>(way.v / length) : 0;
  } else if (shape.kind == Shape::Kind::kCircle) {
    stroke.radius = static_cast<float>(shape.radius);
  } else {
    stroke.half = static_cast<float>(shape.radius);
  }
  paint_stroke(stroke, ink, planes);
}

// Grown to multiples of four: then no chroma sample of any format lies in two tiles.
CellBox aligned(const CellBox& box, const CellBox& bounds) {
  return {box.left / 4 * 4, box.top / 4 * 4, std::min((box.right + 3) / 4 * 4, bounds.right),
          std::min((box.bottom + 3) / 4 * 4, bounds.bottom)};
}

// What the tile of a run of touched cells covers, and the numbers of the shapes in it; `last` is
// the run's last column.
CellBox box_of(const OverlayCells& cells, int first, int last, int row,
               std::vector<std::size_t>& numbers) {
  CellBox box;
  numbers.clear();
  for (int column = first; column <= last; ++column) {
    for (const std::size_t number : cells.touching(column, row)) {
      numbers.push_back(number);
      box = united(box, clipped(cells.box(number), cells.cells(column, column, row)));
    }
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return aligned(box, cells.cells(first, last, row));
}

}  // namespace

Extent extent_of(const Shape& shape) noexcept {
  const Pixel to = shape.radius > 0 ? shape.from : shape.to;
  const double reach = shape.radius + shape.width / 2 + shape.halo + 0.5;
  return {std::min(shape.from.u, to.u) - reach, std::min(shape.from.v, to.v) - reach,
          std::max(shape.from.u, to.u) + reach, std::max(shape.from.v, to.v) + reach};
}

OverlayRaster::OverlayRaster() = default;
OverlayRaster::~OverlayRaster() = default;

void OverlayRaster::paint_tile(const OverlayBox& box) {
  Painted next;
  if (!spare_.empty()) {
    next = std::move(spare_.back());
    spare_.pop_back();
  }
  OverlayTile& tile = next.tile;
  tile.x = box.x;
  tile.y = box.y;
  tile.width = box.width;
  tile.height = box.height;
  tile.serial = next_tile_serial();
  planes_.begin(tile.width, tile.height);
  for (const Shape& shape : within_) paint(shape, tile.x, tile.y, planes_);
  planes_.take_painted(tile.spans);
  if (tile.spans.empty()) return spare_.push_back(std::move(next));
  const TileSpan& last = tile.spans.back();
  const std::size_t bytes = 4 * (last.at + static_cast<std::size_t>(last.count));
  if (tile.pixels.size() < bytes) tile.pixels.resize(bytes);
  merge_planes(planes_, tile.spans, tile.pixels.data());
  next.shapes = within_;
  tiles_.push_back(std::move(tile));
  shapes_.push_back(std::move(next.shapes));
}

void OverlayRaster::add_tile(const OverlayBox& box) {
  const auto is_there = [&](const OverlayTile& tile) {
    return OverlayBox{tile.x, tile.y, tile.width, tile.height} == box &&
           shapes_before_[static_cast<std::size_t>(&tile - before_.data())] == within_;
  };
  const auto known = std::ranges::find_if(before_, is_there);
  if (known == before_.end()) return paint_tile(box);
  tiles_.push_back(std::exchange(*known, {}));
  shapes_.push_back(std::move(shapes_before_[static_cast<std::size_t>(known - before_.begin())]));
}

void OverlayRaster::keep_spare() {
  spare_.clear();
  for (std::size_t i = 0; i < before_.size(); ++i) {
    if (before_[i].serial != 0) {
      spare_.push_back({std::move(before_[i]), std::move(shapes_before_[i])});
    }
  }
}

void OverlayRaster::draw(ImageSize frame, const std::vector<Shape>& shapes) {
  if (!cells_ || !cells_->are_of(frame)) cells_ = std::make_unique<OverlayCells>(frame);
  OverlayCells& cells = *cells_;
  cells.clear();
  for (const Shape& shape : shapes) cells.add(shape);
  tiles_.swap(before_);
  shapes_.swap(shapes_before_);
  tiles_.clear();
  shapes_.clear();
  for (int row = 0; row < cells.rows(); ++row) {
    for (int column = 0; column < cells.columns(); ++column) {
      if (cells.touching(column, row).empty()) continue;
      const int first = column;
      while (column + 1 < cells.columns() && cells.join(column, column + 1, row)) ++column;
      const CellBox box = box_of(cells, first, column, row, numbers_);
      within_.clear();
      for (const std::size_t number : numbers_) within_.push_back(shapes[number]);
      add_tile({box.left, box.top, box.right - box.left, box.bottom - box.top});
    }
  }
  keep_spare();
}

}  // namespace calvin
