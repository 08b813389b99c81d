// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the cells of a marker.

#include "calvin/detect/checkerboard/code/marker_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "calvin/detect/checkerboard/code/lattice_square.hpp"

namespace calvin::detect {

namespace {

// The mean grey level along the sides of a smaller square in the middle of a square.
std::optional<float> mean_around(const ImageView& image, const LatticeSquare& square, float side) {
  constexpr int kSteps = 6;  // of each side
  const float low = 0.5F - 0.5F * side;
  float sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float along = low + side * static_cast<float>(i) / kSteps;
    const auto top = square.grey(image, along, low);
    const auto right = square.grey(image, 1 - low, along);
    const auto bottom = square.grey(image, 1 - along, 1 - low);
    const auto left = square.grey(image, low, 1 - along);
    if (!top || !right || !bottom || !left) return std::nullopt;
    sum += *top + *right + *bottom + *left;
  }
  return sum / (4 * kSteps);
}

// The mean grey level about the middle (s, t) of a marker's cell.
std::optional<float> mean_in(const ImageView& image, const LatticeSquare& square, float s, float t,
                             float cell) {
  constexpr float kOff = 0.2F;  // of the cell
  float sum = 0;
  for (const float ds : {-kOff, kOff}) {
    for (const float dt : {-kOff, kOff}) {
      const auto grey = square.grey(image, s + ds * cell, t + dt * cell);
      if (!grey) return std::nullopt;
      sum += 0.25F * *grey;
    }
  }
  return sum;
}

// The mean grey level of the squares beside a square, near the middles of its sides; of those that
// are in the image.
std::optional<float> mean_beside(const ImageView& image, const LatticeSquare& square) {
  constexpr float kBeyond = 0.16F;  // of the square's side
  float sum = 0;
  int count = 0;
  for (const float far : {-kBeyond, 1 + kBeyond}) {
    for (const auto& grey : {square.grey(image, far, 0.5F), square.grey(image, 0.5F, far)}) {
      if (!grey) continue;
      sum += *grey;
      ++count;
    }
  }
  if (count < 2) return std::nullopt;
  return sum / static_cast<float>(count);
}

// The grey levels of a marker's rim, and of the square around it.
struct Levels {
  float rim = 0;
  float around = 0;
};

// Absent where the square cannot hold a marker: they differ too little, or the wrong way.
std::optional<Levels> levels_of(const ImageView& image, const LatticeSquare& square,
                                const MarkerShape& shape) {
  constexpr float kLeast = 0.2F;  // of the contrast of the corners
  const auto rim = mean_around(image, square, shape.rim);
  const auto around = mean_around(image, square, shape.around);
  if (!rim || !around) return std::nullopt;
  const float contrast = shape.inverted ? *rim - *around : *around - *rim;
  if (!(contrast > kLeast * square.contrast())) return std::nullopt;
  return Levels{*rim, *around};
}

// That of a bit of a marker, in rows.
std::optional<float> grey_of_bit(const ImageView& image, const LatticeSquare& square,
                                 const MarkerShape& shape, int bit) {
  const float first = 0.5F * (1 - static_cast<float>(shape.side - 1) * shape.cell);
  return mean_in(image, square, first + shape.cell * static_cast<float>(bit % shape.side),
                 first + shape.cell * static_cast<float>(bit / shape.side), shape.cell);
}

}  // namespace

MarkerShape marker_shape(float share, int side, bool inverted) {
  MarkerShape shape;
  shape.side = side;
  shape.cell = share / static_cast<float>(side + 2);
  shape.rim = share - shape.cell;
  shape.around = 0.5F * (1 + share);
  shape.inverted = inverted;
  return shape;
}

std::optional<float> measure_marker(const ImageView& image, const Lattice& lattice, Cell at,
                                    const MarkerShape& shape) {
  constexpr float kStep = 0.02F;  // of the square's side
  constexpr float kLast = 0.98F;
  constexpr float kEdge = 0.5F;  // of the way from the grey level of the rim to that around it
  const auto square = LatticeSquare::at(lattice, at);
  const auto levels = square ? levels_of(image, *square, shape) : std::nullopt;
  if (!levels) return std::nullopt;
  // Outwards from the rim.
  float before = 0;
  for (float side = shape.rim + kStep; side < kLast; side += kStep) {
    const auto grey = mean_around(image, *square, side);
    if (!grey) return std::nullopt;
    const float now = (*grey - levels->rim) / (levels->around - levels->rim);
    if (now >= kEdge) return side - kStep * (now - kEdge) / (now - before);
    before = now;
  }
  return std::nullopt;
}

bool is_whole_square(const Lattice& lattice, Cell at) {
  return lattice.has(at) && lattice.has(at + Cell{1, 0}) && lattice.has(at + Cell{0, 1}) &&
         lattice.has(at + Cell{1, 1});
}

void read_marker(const ImageView& image, const Lattice& lattice, Cell at, const MarkerShape& shape,
                 std::vector<CodeBit>& bits) {
  constexpr float kClearly = 0.15F;
  const auto square = LatticeSquare::at(lattice, at);
  const auto levels = square ? levels_of(image, *square, shape) : std::nullopt;
  if (!levels) return;
  for (int i = 0; i < shape.side * shape.side; ++i) {
    const auto grey = grey_of_bit(image, *square, shape, i);
    if (!grey) continue;
    const float light =
        (2 * *grey - levels->rim - levels->around) / std::abs(levels->around - levels->rim);
    if (std::abs(light) >= kClearly) bits.push_back({{at, i}, light > 0});
  }
}

bool read_greys(const ImageView& image, const Lattice& lattice, Cell at, const MarkerShape& shape,
                std::vector<float>& greys) {
  const auto square = LatticeSquare::at(lattice, at);
  if (!square || !(square->contrast() > 0)) return false;
  const std::size_t before = greys.size();
  for (int i = 0; i < shape.side * shape.side; ++i) {
    const auto grey = grey_of_bit(image, *square, shape, i);
    if (!grey) {
      greys.resize(before);
      return false;
    }
    greys.push_back(*grey / square->contrast());
  }
  return true;
}

void read_circle(const ImageView& image, const Lattice& lattice, Cell at,
                 std::vector<CodeBit>& bits) {
  constexpr float kMiddle = 0.2F;    // of the square's side: well within a circle
  constexpr float kOutside = 0.72F;  // of the square's side: outside of any circle
  constexpr float kLeast = 0.3F;     // of the contrast of the corners
  constexpr float kClearly = 0.25F;  // of the way from one colour to the other, both ways
  const auto square = LatticeSquare::at(lattice, at);
  if (!square) return;
  const auto middle = mean_in(image, *square, 0.5F, 0.5F, kMiddle);
  const auto own = mean_around(image, *square, kOutside);
  const auto other = mean_beside(image, *square);
  if (!middle || !own || !other) return;
  const float contrast = *other - *own;
  if (std::abs(contrast) < kLeast * square->contrast()) return;
  const float circle = (2 * *middle - *own - *other) / contrast;
  if (std::abs(circle) >= kClearly) bits.push_back({{at, 0}, circle > 0});
}

CodePlace turned_in_marker(const CodePlace& at, int side, int quarter) {
  // In half cells, so that the middle of a square is a whole number.
  Cell middle = 2 * at.cell + Cell{1, 1};
  Cell bit = {at.index % side, at.index / side};
  for (int i = 0; i < quarter; ++i) {
    middle = {middle.row, -middle.col};
    bit = {bit.row, side - 1 - bit.col};
  }
  const Cell from = middle - Cell{1, 1};
  return {{from.col / 2, from.row / 2}, bit.row * side + bit.col};
}

}  // namespace calvin::detect
