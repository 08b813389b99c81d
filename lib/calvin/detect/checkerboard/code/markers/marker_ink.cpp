// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Draws each marker as blurred as the edges are, and adds to the pixels what it takes from them.

#include "calvin/detect/checkerboard/code/markers/marker_ink.hpp"

#include <algorithm>
#include <cmath>

#include "calvin/detect/checkerboard/code/lattice_square.hpp"
#include "calvin/detect/checkerboard/code/marker_reader.hpp"
#include "calvin/detect/surface.hpp"

namespace calvin::detect {

namespace {

// The middle of the square whose upper left corner is the node of a cell.
LatticePlace middle_of(const Lattice& lattice, Cell at) {
  const LatticePlace a = lattice.place(at);
  const LatticePlace b = lattice.place(at + Cell{1, 1});
  return {0.5 * (a.col + b.col), 0.5 * (a.row + b.row)};
}

// Whether any corner of a square is there: markers farther away are not beside one.
bool has_corner(const Lattice& lattice, Cell at) {
  return lattice.has(at) || lattice.has(at + Cell{1, 0}) || lattice.has(at + Cell{0, 1}) ||
         lattice.has(at + Cell{1, 1});
}

// The mean grey level about the middle of a square.
std::optional<float> middle_grey(const ImageView& image, const Lattice& lattice, Cell at) {
  constexpr int kSteps = 5;
  constexpr float kReach = 0.12F;  // of the square's side
  const auto square = LatticeSquare::at(lattice, at);
  if (!square) return std::nullopt;
  float sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int k = 0; k < kSteps; ++k) {
      const auto place = [](int step) {
        return 0.5F + kReach * (2 * static_cast<float>(step) / (kSteps - 1) - 1);
      };
      const auto grey = square->grey(image, place(k), place(i));
      if (!grey) return std::nullopt;
      sum += *grey;
    }
  }
  return sum / (kSteps * kSteps);
}

// The mean of those of the squares beside a square.
std::optional<float> grey_beside(const ImageView& image, const Lattice& lattice, Cell at) {
  float sum = 0;
  float count = 0;
  for (const Cell step : kAround) {
    if (!is_whole_square(lattice, at + step)) continue;
    const auto grey = middle_grey(image, lattice, at + step);
    if (!grey) continue;
    sum += *grey;
    count += 1;
  }
  return count > 0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

// The outermost squares of a board have no corners on their outer sides.
void MarkerInk::take_lattice(const Lattice& lattice, const GridAlignment& alignment) {
  all_ = lattice;
  const Cell first = alignment.origin - Cell{1, 1};
  const Cell last = alignment.origin + Cell{alignment.cols, alignment.rows};
  Surface<3> x(lattice.place(first), lattice.place(last));
  Surface<3> y = x;
  lattice.for_each([&](Cell c, const Node& node) {
    x.add({lattice.place(c), static_cast<double>(node.x)});
    y.add({lattice.place(c), static_cast<double>(node.y)});
  });
  constexpr double kVariance = 1e-4;  // px^2, at least
  x.solve(kVariance);
  y.solve(kVariance);
  for (int row = first.row; row <= last.row; ++row) {
    for (int col = first.col; col <= last.col; ++col) {
      const Cell c = {col, row};
      if (!all_.in_reach(c) || all_.has(c)) continue;
      Node node;
      node.x = static_cast<float>(x.at(lattice.place(c)));
      node.y = static_cast<float>(y.at(lattice.place(c)));
      all_.put(c, node);
    }
  }
}

bool MarkerInk::take_cells(const Code& code, const GridAlignment& alignment, Cell at) {
  const MarkerShape& shape = *code.markers();
  const Cell shift = alignment.point({0, 0});
  cells_.side = shape.side + 2;
  cells_.cell = shape.cell;
  // A rim, of one cell, has another colour than the ground around it.
  cells_.is_ground.assign(static_cast<std::size_t>(cells_.side * cells_.side), false);
  for (int bit = 0; bit < shape.side * shape.side; ++bit) {
    const CodePlace place = code.turned({at, bit}, alignment.quarter);
    const int light = code.at({place.cell + shift, place.index});
    if (light == 0) return false;
    const int cell = (bit / shape.side + 1) * cells_.side + bit % shape.side + 1;
    cells_.is_ground[static_cast<std::size_t>(cell)] = (light > 0) != shape.inverted;
  }
  return true;
}

void MarkerInk::draw(const Code& code, const GridAlignment& alignment, const Lattice& lattice,
                     ImageSize size, float width) {
  count_ = 0;
  const CellRange e = all_.extent();
  for (int row = e.first.row; row < e.last.row; ++row) {
    for (int col = e.first.col; col < e.last.col; ++col) {
      const Cell c = {col, row};
      if (!code.may_hold_marker(all_, c) || !has_corner(lattice, c)) continue;
      const auto square = LatticeSquare::at(all_, c);
      if (!square || !take_cells(code, alignment, c)) continue;
      if (count_ == markers_.size()) markers_.emplace_back();
      Marker& marker = markers_[count_++];
      marker.cell = c;
      marker.is_whole = is_whole_square(lattice, c);
      marker.drawing.draw(size, *square, cells_, width);
    }
  }
}

bool MarkerInk::take_samples(const ImageView& image, const Lattice& lattice, const Marker& marker,
                             float width) {
  constexpr float kFirst = 0.2F;  // of the square's side
  const auto square = LatticeSquare::at(lattice, marker.cell);
  const auto beside = grey_beside(image, lattice, marker.cell);
  if (!beside || !square) return false;
  // What blur leaves of the square itself.
  const float size = std::sqrt(square->area(0.5F, 0.5F, 1) / 2) / width;
  const auto kept = [&](float s) { return 0.5F * (std::erf(size * s) + std::erf(size * (1 - s))); };
  const auto place = [](int i) {
    return kFirst + (1 - 2 * kFirst) * (static_cast<float>(i) + 0.5F) / kSteps;
  };
  const MarkerDrawing& drawing = marker.drawing;
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const float s = place(i % kSteps);
    const float t = place(i / kSteps);
    const Direction p = square->place(s, t);
    const int x = static_cast<int>(std::lround(p.x));
    const int y = static_cast<int>(std::lround(p.y));
    const int col = x - drawing.left();
    const int row = y - drawing.top();
    if (x < 0 || y < 0 || x >= image.width || y >= image.height || col < 0 || row < 0 ||
        col >= drawing.width() || row >= drawing.height()) {
      return false;
    }
    samples_[static_cast<std::size_t>(i)] = {static_cast<float>(image.at(x, y)) - *beside,
                                             kept(s) * kept(t) - drawing.row(row)[col]};
  }
  return true;
}

// The contrast of each marker by least squares: the squares beside it have its other colour.
void MarkerInk::take_contrasts(const ImageView& image, const Lattice& lattice, float width) {
  constexpr double kVariance = 1;  // grey levels^2
  const CellRange e = all_.extent();
  contrasts_.emplace(all_.place(e.first), all_.place(e.last));
  for (const Marker& marker : markers()) {
    if (!marker.is_whole || !take_samples(image, lattice, marker, width)) continue;
    float products = 0;
    float grounds = 0;
    for (const Sample& s : samples_) {
      products += s.grey * s.ground;
      grounds += s.ground * s.ground;
    }
    if (!(grounds > 0)) continue;
    contrasts_->add({middle_of(all_, marker.cell), static_cast<double>(products / grounds)});
  }
  contrasts_->solve(kVariance);
}

void MarkerInk::take_off(const MarkerDrawing& drawing, float contrast, const ImageView& image) {
  const int left = drawing.left();
  const int top = drawing.top();
  for (int row = std::max(0, -top); row < std::min(drawing.height(), image.height - top); ++row) {
    std::uint8_t* to = pixels_.data() + (row + top) * image.width + left;
    const float* share = drawing.row(row);
    for (int col = std::max(0, -left); col < std::min(drawing.width(), image.width - left); ++col) {
      const float grey = static_cast<float>(to[col]) + contrast * share[col];
      to[col] = static_cast<std::uint8_t>(std::clamp(grey + 0.5F, 0.0F, 255.0F));
    }
  }
}

ImageView MarkerInk::taken_off(const ImageView& image, const Code& code,
                               const GridAlignment& alignment, const Lattice& lattice,
                               float width) {
  pixels_.resize(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int y = 0; y < image.height; ++y) {
    std::copy_n(image.data + y * image.stride, image.width, pixels_.data() + y * image.width);
  }
  take_lattice(lattice, alignment);
  draw(code, alignment, lattice, image.size(), width);
  take_contrasts(image, lattice, width);
  for (const Marker& marker : markers()) {
    const double contrast = contrasts_->at(middle_of(all_, marker.cell));
    take_off(marker.drawing, static_cast<float>(contrast), image);
  }
  return {pixels_.data(), image.width, image.height, image.width, 1};
}

}  // namespace calvin::detect
