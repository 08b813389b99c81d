// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The memory of the rows, and the choice of the function that fills them.

#include "calvin/solve/residuals/view_rows.hpp"

#include <algorithm>

#include "calvin/camera/models.hpp"
#include "calvin/solve/parameters/parameter_table.hpp"

namespace calvin {

RowLayout row_layout(const ParameterTable& table, std::size_t camera,
                     std::optional<std::size_t> board) {
  return {table.unknowns(camera), board ? table.board(*board).count : 0,
          !table.readout(camera).empty(), table.is_known(camera)};
}

RowPoint row_point(const ParameterTable& table, std::size_t camera,
                   std::optional<std::size_t> board, const std::vector<double>& shared) {
  return {table.intrinsics_at(camera, shared), table.skew_at(camera, shared),
          board ? shared.data() + table.board(*board).first : nullptr,
          table.readout_at(camera, shared)};
}

void ViewRows::resize(std::size_t padded) {
  if (padded == padded_) return;
  padded_ = padded;
  const std::size_t size = 2 * padded * static_cast<std::size_t>(layout_.columns());
  if (size > capacity_ || !data_) {
    capacity_ = std::max(size, kLanes);
    data_ = aligned_array(capacity_);
  }
  std::fill_n(data_.get(), size, 0.0);
}

FillRows fill_rows_of(std::string_view model) {
  FillRows fill = nullptr;
  visit_model(model, [&]<typename M>() { fill = fill_rows_of<typename M::Lens>(); });
  return fill;
}

}  // namespace calvin
