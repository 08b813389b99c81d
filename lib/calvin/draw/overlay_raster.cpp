// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Paints the shapes of the overlay into tiles with Cairo.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "calvin/draw/overlay_raster.hpp"

namespace calvin {

namespace {

constexpr Colour kDark{0, 0, 0, 0.5};

// Whole pixels, right and bottom excluded.
struct Box {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  [[nodiscard]] bool empty() const noexcept { return left >= right || top >= bottom; }
};

Box clipped(const Extent& extent, const Box& bounds) {
  const auto clamp = [](double value, int low, int high) {
    return static_cast<int>(std::clamp(value, double{0} + low, double{0} + high));
  };
  return {clamp(std::floor(extent.left), bounds.left, bounds.right),
          clamp(std::floor(extent.top), bounds.top, bounds.bottom),
          clamp(std::ceil(extent.right) + 1, bounds.left, bounds.right),
          clamp(std::ceil(extent.bottom) + 1, bounds.top, bounds.bottom)};
}

Box united(const Box& a, const Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

// The frame in square cells; each knows the shapes that touch it.
class Grid {
 public:
  explicit Grid(ImageSize frame)
      : frame_{0, 0, frame.width, frame.height},
        cell_(std::clamp(std::min(frame.width, frame.height) / 24 / 8 * 8, 16, 64)),
        columns_((frame.width + cell_ - 1) / cell_),
        rows_((frame.height + cell_ - 1) / cell_),
        touched_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
        moves_(touched_.size()) {}

  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return rows_; }
  [[nodiscard]] const std::vector<std::size_t>& touching(int column, int row) const {
    return touched_[index(column, row)];
  }
  [[nodiscard]] Box cells(int first_column, int last_column, int row) const noexcept {
    return {first_column * cell_, row * cell_, std::min((last_column + 1) * cell_, frame_.right),
            std::min((row + 1) * cell_, frame_.bottom)};
  }

  // Cells of one tile: what moves draws nothing again beside it.
  [[nodiscard]] bool join(int column, int next, int row) const {
    return !touching(next, row).empty() && moves_[index(column, row)] == moves_[index(next, row)];
  }

  // A line is cut into pieces of a cell's length, so that a diagonal does not touch its whole
  // bounding box.
  void add(const Shape& shape, std::size_t number) {
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
      touch(clipped(extent_of(piece), frame_), number, shape.moves);
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

  void touch(const Box& box, std::size_t number, bool moves) {
    if (box.empty()) return;
    for (int row = box.top / cell_; row <= (box.bottom - 1) / cell_; ++row) {
      for (int column = box.left / cell_; column <= (box.right - 1) / cell_; ++column) {
        auto& shapes = touched_[index(column, row)];
        if (shapes.empty() || shapes.back() != number) shapes.push_back(number);
        if (moves) moves_[index(column, row)] = true;
      }
    }
  }

  Box frame_;
  int cell_;  // px, a multiple of 8
  int columns_;
  int rows_;
  std::vector<std::vector<std::size_t>> touched_;
  std::vector<bool> moves_;  // whether one of them does
};

// Lines of one width and colour are one path.
void paint_lines(cairo_t* cr, std::span<const Shape* const> lines, const Colour& colour,
                 double width) {
  if (lines.empty()) return;
  for (const Shape* line : lines) {
    cairo_move_to(cr, line->from.u, line->from.v);
    cairo_line_to(cr, line->to.u, line->to.v);
  }
  cairo_set_source_rgba(cr, colour.red, colour.green, colour.blue, colour.alpha);
  cairo_set_line_width(cr, width);
  cairo_stroke(cr);
}

void paint_box(cairo_t* cr, const Shape& box, const Colour& colour, double grow) {
  cairo_set_source_rgba(cr, colour.red, colour.green, colour.blue, colour.alpha);
  cairo_rectangle(cr, box.from.u - grow, box.from.v - grow, box.to.u - box.from.u + 2 * grow,
                  box.to.v - box.from.v + 2 * grow);
  cairo_fill(cr);
}

// What is to be seen of the shapes: the dark around them, or they themselves.
enum class Layer { kHalo, kShape };

void paint(cairo_t* cr, MarkMasks& masks, const std::vector<Shape>& shapes, Layer layer) {
  const auto colour_of = [layer](const Shape& shape) {
    return layer == Layer::kHalo ? kDark : shape.colour;
  };
  std::vector<const Shape*> lines;
  const auto end_lines = [&] {
    if (lines.empty()) return;
    const Shape& first = *lines.front();
    const double grow = layer == Layer::kHalo ? first.halo : 0;
    paint_lines(cr, lines, colour_of(first), first.width + 2 * grow);
    lines.clear();
  };
  const auto goes_on = [&](const Shape& shape) {
    if (lines.empty()) return true;
    const Shape& first = *lines.front();
    return first.width == shape.width && first.halo == shape.halo &&
           colour_of(first) == colour_of(shape);
  };
  for (const Shape& shape : shapes) {
    if (layer == Layer::kHalo && !(shape.halo > 0)) continue;
    const double grow = layer == Layer::kHalo ? shape.halo : 0;
    if (shape.kind == Shape::Kind::kLine) {
      if (!goes_on(shape)) end_lines();
      lines.push_back(&shape);
      continue;
    }
    // The dark may be laid down in any order.
    if (layer == Layer::kShape) end_lines();
    if (shape.kind == Shape::Kind::kBox) {
      paint_box(cr, shape, colour_of(shape), grow);
    } else {
      masks.paint(cr, shape, colour_of(shape), grow);
    }
  }
  end_lines();
}

// Grown to multiples of four: then no chroma sample of any format lies in two tiles.
Box aligned(const Box& box, const Box& bounds) {
  return {box.left / 4 * 4, box.top / 4 * 4, std::min((box.right + 3) / 4 * 4, bounds.right),
          std::min((box.bottom + 3) / 4 * 4, bounds.bottom)};
}

// What the tile of a run of touched cells covers, and the numbers of the shapes in it; `last` is
// the run's last column.
Box box_of(const Grid& grid, int first, int last, int row, const std::vector<Shape>& shapes,
           std::vector<std::size_t>& numbers) {
  Box box;
  for (int column = first; column <= last; ++column) {
    for (const std::size_t number : grid.touching(column, row)) {
      numbers.push_back(number);
      box = united(box, clipped(extent_of(shapes[number]), grid.cells(column, column, row)));
    }
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return aligned(box, grid.cells(first, last, row));
}

}  // namespace

Extent extent_of(const Shape& shape) noexcept {
  const Pixel to = shape.radius > 0 ? shape.from : shape.to;
  const double reach = shape.radius + shape.width / 2 + shape.halo + 0.5;
  return {std::min(shape.from.u, to.u) - reach, std::min(shape.from.v, to.v) - reach,
          std::max(shape.from.u, to.u) + reach, std::max(shape.from.v, to.v) + reach};
}

OverlayTile OverlayRaster::painted(const OverlayBox& box, const std::vector<Shape>& shapes) {
  OverlayTile tile{box.x, box.y, box.width, box.height, {}, next_tile_serial()};
  const int stride = 4 * tile.width;
  tile.pixels.resize(static_cast<std::size_t>(stride) * static_cast<std::size_t>(tile.height));
  const CairoSurface surface(cairo_image_surface_create_for_data(
      tile.pixels.data(), CAIRO_FORMAT_ARGB32, tile.width, tile.height, stride));
  const CairoContext context(cairo_create(surface.get()));
  cairo_t* cr = context.get();
  // Cairo's pixels have their centres at halves.
  cairo_translate(cr, 0.5 - tile.x, 0.5 - tile.y);
  cairo_set_line_cap(cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_antialias(cr, CAIRO_ANTIALIAS_FAST);
  paint(cr, masks_, shapes, Layer::kHalo);
  paint(cr, masks_, shapes, Layer::kShape);
  cairo_surface_finish(surface.get());
  return tile;
}

void OverlayRaster::draw(ImageSize frame, const std::vector<Shape>& shapes) {
  Grid grid(frame);
  for (std::size_t i = 0; i < shapes.size(); ++i) grid.add(shapes[i], i);
  std::vector<OverlayTile> before = std::exchange(tiles_, {});
  const std::vector<std::vector<Shape>> were_painted = std::exchange(painted_, {});
  const auto add = [&](const OverlayBox& box, std::vector<Shape> within) {
    const auto is_there = [&](const OverlayTile& tile) {
      return OverlayBox{tile.x, tile.y, tile.width, tile.height} == box &&
             were_painted[static_cast<std::size_t>(&tile - before.data())] == within;
    };
    const auto known = std::ranges::find_if(before, is_there);
    tiles_.push_back(known == before.end() ? painted(box, within) : std::move(*known));
    painted_.push_back(std::move(within));
  };
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      if (grid.touching(column, row).empty()) continue;
      const int first = column;
      while (column + 1 < grid.columns() && grid.join(column, column + 1, row)) ++column;
      std::vector<std::size_t> numbers;
      const Box box = box_of(grid, first, column, row, shapes, numbers);
      std::vector<Shape> within;
      for (const std::size_t number : numbers) within.push_back(shapes[number]);
      add({box.left, box.top, box.right - box.left, box.bottom - box.top}, std::move(within));
    }
  }
}

}  // namespace calvin
