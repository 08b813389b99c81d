// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rows of one view: its residuals and their derivatives, a column after the other. Internal.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "calvin/solve/linear/aligned.hpp"

#include "calvin/geometry/se3.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"
#include "calvin/solve/residuals/loss.hpp"
#include "calvin/solve/residuals/view_points.hpp"

namespace calvin {

// The columns, in this order:
//   6          the pose, which moves by exp(d) from the left: rotation (rad), translation (m)
//   1          the residuals, px
//   shared()   the unknowns of the camera unless it is known, its readout where that is one, the
//              modes of the board
// Columns that depend on one view alone come first, so that a pose by itself needs seven columns.
struct RowLayout {
  static constexpr int kPose = 6;
  static constexpr int kResidual = 6;
  static constexpr int kFirstShared = 7;

  CameraUnknowns camera;
  int modes = 0;
  bool has_readout = false;
  bool is_known = false;  // the camera: it has no columns but the readout

  // The intrinsics, and the skew where it is estimated.
  [[nodiscard]] int intrinsics() const { return is_known ? 0 : camera.all().count; }
  // Those of the camera alone.
  [[nodiscard]] int of_camera() const { return intrinsics() + (has_readout ? 1 : 0); }
  [[nodiscard]] int shared() const { return of_camera() + modes; }
  [[nodiscard]] int columns() const { return kFirstShared + shared(); }
  [[nodiscard]] int readout() const { return kFirstShared + intrinsics(); }
  [[nodiscard]] int first_mode() const { return kFirstShared + of_camera(); }
};

// The values of the shared unknowns at which rows are taken.
struct RowPoint {
  const double* parameters = nullptr;  // the intrinsics, in the order of CameraUnknowns
  double skew = 0;                     // px
  const double* shape = nullptr;       // coefficients of the board's modes
  double readout = 0;                  // s
};

class ParameterTable;

// The columns of what a camera of the table sees of a board of it, or of points that are of no
// board, and their values.
[[nodiscard]] RowLayout row_layout(const ParameterTable& table, std::size_t camera,
                                   std::optional<std::size_t> board);
[[nodiscard]] RowPoint row_point(const ParameterTable& table, std::size_t camera,
                                 std::optional<std::size_t> board,
                                 const std::vector<double>& shared);

// Holds one view at a time: a column is the u of all corners, then the v, each padded() long.
class ViewRows {
 public:
  explicit ViewRows(const RowLayout& layout) : layout_(layout) {}

  // Makes room for views of this size. Entries that no lens writes are zero.
  void resize(std::size_t padded);

  [[nodiscard]] const RowLayout& layout() const { return layout_; }
  [[nodiscard]] std::size_t padded() const { return padded_; }
  [[nodiscard]] double* u(int column) {
    return &data_[2 * padded_ * static_cast<std::size_t>(column)];
  }
  [[nodiscard]] double* v(int column) { return u(column) + padded_; }
  [[nodiscard]] const double* data() const { return data_.get(); }

 private:
  RowLayout layout_;
  std::size_t padded_ = 0;
  std::size_t capacity_ = 0;
  AlignedArray data_;
};

struct RowSums {
  double cost = 0;     // px^2
  bool valid = false;  // every corner has a projection
};

// Which columns are filled: all that the layout has, or the residuals alone.
enum class RowContent { kAll, kResiduals };

// Fills the rows of a view, weighted, for the formula of one lens. The rows have its size.
using FillRows = RowSums (*)(const ViewPoints& view, const RowPoint& point,
                             const SE3& camera_from_board, const Loss& loss, ViewRows& rows,
                             RowContent content);

// The function of a lens in models.hpp, for the widest vectors of the machine.
template <typename Lens>
[[nodiscard]] FillRows fill_rows_of();

// The function of a model by its name, which must exist.
[[nodiscard]] FillRows fill_rows_of(std::string_view model);

}  // namespace calvin
