// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The markers in the squares of a ChArUco board.
#pragma once

#include "calvin/detect/checkerboard/code/code.hpp"
#include "calvin/detect/checkerboard/code/marker_reader.hpp"
#include "calvin/target/charuco_board.hpp"

namespace calvin::detect {

// The bits of a cell are those of the marker in the square to the right of its corner and below, in
// rows.
class CharucoCode final : public Code {
 public:
  explicit CharucoCode(const CharucoBoard& board);

  void read(const ImageView& image, const Lattice& lattice,
            std::vector<CodeBit>& bits) const override;
  [[nodiscard]] CodePlace turned(const CodePlace& at, int quarter) const override;
  [[nodiscard]] const MarkerShape* markers() const override { return &shape_; }
  // Every other square has none.
  [[nodiscard]] bool may_hold_marker(const Lattice& /*lattice*/, Cell at) const override {
    return Lattice::is_even(at) != shape_.inverted;
  }

 private:
  MarkerShape shape_;
};

}  // namespace calvin::detect
