// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Looks at the cells of a marker.

#include "calvin/detect/checkerboard/code/marker_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "calvin/detect/checkerboard/corners/grey_at.hpp"

namespace calvin::detect {

namespace {

// How the places of a line bend from a node to the next, px: the second derivative by the step
// between them. The mean of the parabolas about both nodes; 0 where the line is too short.
Direction bend_between(const Lattice& lattice, Cell from, Cell step) {
  Direction sum = {0, 0};
  float count = 0;
  const float length = lattice.length(from, step);
  for (const Cell c : {from, from + step}) {
    if (!lattice.has(c - step) || !lattice.has(c + step)) continue;
    const Node& before = lattice.at(c - step);
    const Node& here = lattice.at(c);
    const Node& after = lattice.at(c + step);
    const float behind = lattice.length(c - step, step);
    const float ahead = lattice.length(c, step);
    const auto second = [&](float Node::*of) {
      const float change = (after.*of - here.*of) / ahead - (here.*of - before.*of) / behind;
      return 2 * change / (ahead + behind) * length * length;
    };
    sum.x += second(&Node::x);
    sum.y += second(&Node::y);
    count += 1;
  }
  return count > 0 ? Direction{sum.x / count, sum.y / count} : sum;
}

// A square of a lattice in the picture. Its sides are bent as the lines of nodes are that they are
// part of, by perspective and by the lens.
class Square {
 public:
  // The one whose upper left corner is the node of `cell`. Absent where fewer than two of its
  // corners are there, and the others are not expected.
  static std::optional<Square> at(const Lattice& lattice, Cell cell) {
    Square square;
    int known = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const Cell c = cell + Cell{static_cast<int>(i % 2), static_cast<int>(i / 2)};
      if (lattice.has(c)) {
        square.corners_[i] = {lattice.at(c).x, lattice.at(c).y};
        square.contrast_ = std::max(square.contrast_, lattice.at(c).contrast);
        ++known;
        continue;
      }
      const auto expected = lattice.in_reach(c) ? lattice.expect(c) : std::nullopt;
      if (!expected) return std::nullopt;
      square.corners_[i] = {expected->x, expected->y};
    }
    if (known < 2) return std::nullopt;
    // What is expected of a corner is too far off for that.
    for (std::size_t i = 0; i < 2 && known == 4; ++i) {
      const int far = static_cast<int>(i);
      square.along_bend_[i] = bend_between(lattice, cell + Cell{0, far}, {1, 0});
      square.down_bend_[i] = bend_between(lattice, cell + Cell{far, 0}, {0, 1});
    }
    return square;
  }

  // grey levels, of its corners
  [[nodiscard]] float contrast() const { return contrast_; }

  // At (s, t), 0..1 from its upper left corner along the row and down.
  [[nodiscard]] std::optional<float> grey(const ImageView& image, float s, float t) const {
    // std::lerp() is exact at its ends, for which it takes several times as long.
    const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
    const auto place = [&](float Direction::*of) {
      const float along = mix(along_bend_[0].*of, along_bend_[1].*of, t);
      const float down = mix(down_bend_[0].*of, down_bend_[1].*of, s);
      return mix(mix(corners_[0].*of, corners_[1].*of, s), mix(corners_[2].*of, corners_[3].*of, s),
                 t) -
             0.5F * (s * (1 - s) * along + t * (1 - t) * down);
    };
    return grey_at(image, place(&Direction::x), place(&Direction::y));
  }

 private:
  std::array<Direction, 4> corners_{};
  std::array<Direction, 2> along_bend_{};  // of the upper and of the lower side
  std::array<Direction, 2> down_bend_{};   // of the left and of the right side
  float contrast_ = 0;
};

// The mean grey level along the sides of a smaller square in the middle of a square.
std::optional<float> mean_around(const ImageView& image, const Square& square, float side) {
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
std::optional<float> mean_in(const ImageView& image, const Square& square, float s, float t,
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
std::optional<float> mean_beside(const ImageView& image, const Square& square) {
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
std::optional<Levels> levels_of(const ImageView& image, const Square& square,
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
std::optional<float> grey_of_bit(const ImageView& image, const Square& square,
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
  const auto square = Square::at(lattice, at);
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
  const auto square = Square::at(lattice, at);
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
  const auto square = Square::at(lattice, at);
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
  const auto square = Square::at(lattice, at);
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
