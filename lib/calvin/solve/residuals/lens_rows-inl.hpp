// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The rows of one view for any lens, several corners at a time. Included once per kind of vector.
// Internal.
#include "calvin/solve/residuals/view_rows.hpp"

#if defined(CALVIN_SOLVE_LENS_ROWS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef CALVIN_SOLVE_LENS_ROWS_INL_HPP
#undef CALVIN_SOLVE_LENS_ROWS_INL_HPP
#else
#define CALVIN_SOLVE_LENS_ROWS_INL_HPP
#endif

#include <algorithm>

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "calvin/camera/double_vec-inl.hpp"
#include "calvin/camera/models.hpp"

HWY_BEFORE_NAMESPACE();
namespace calvin::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using lens::HWY_NAMESPACE::DoubleVec;

template <typename Lens>
class LensRows {
 public:
  LensRows(const ViewPoints& view, const RowPoint& point, const SE3& camera_from_board,
           const Loss& loss, ViewRows& rows)
      : view_(view), point_(point), rows_(rows), loss_(loss) {
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) turn_[3 * i + k] = camera_from_board.rotation(i, k);
      shift_[i] = camera_from_board.translation[i];
    }
  }

  // The derivatives that are computed: all, none, or all but those by the intrinsics.
  enum class Derivatives { kAll, kNone, kOfKnownCamera };

  template <Derivatives kDerivatives>
  RowSums fill() {
    DoubleVec cost = 0;
    bool valid = true;
    for (std::size_t at = 0; at < view_.padded(); at += DoubleVec::kSize) {
      valid = corners<kDerivatives>(at, cost) && valid;
    }
    return {hn::GetLane(hn::SumOfLanes(DoubleVec::Tag(), cost.raw)), valid};
  }

 private:
  static constexpr int kCount = Lens::kCount;
  // The columns of the camera, with the skew, which may be missing.
  static constexpr CameraUnknowns kCamera = {kCount, true};
  static constexpr int kFirst = RowLayout::kFirstShared;

  // The row of one coordinate (u or v) of a projection.
  struct Row {
    double* column;      // the first one
    std::size_t stride;  // to the next
    void put(int index, DoubleVec value) const {
      value.store(column + stride * static_cast<std::size_t>(index));
    }
  };

  template <Derivatives kDerivatives>
  bool corners(std::size_t at, DoubleVec& cost) {
    DoubleVec p[3];
    place(at, p);
    DoubleVec xy[2];
    DoubleVec jp[6];
    DoubleVec jd[2 * std::max(kCount, 1)];
    constexpr bool kIntrinsics = kDerivatives == Derivatives::kAll;
    const double* coefficients = point_.parameters + kCamera.distortion().first;
    const auto valid = Lens::distort(coefficients, p, xy, jp, kIntrinsics ? jd : nullptr);
    const double fx = point_.parameters[kCamera.focal()[0]];
    const double fy = point_.parameters[kCamera.focal()[1]];
    const double cx = point_.parameters[kCamera.center()[0]];
    const double cy = point_.parameters[kCamera.center()[1]];
    DoubleVec du = xy[0] * fx + xy[1] * point_.skew + cx - DoubleVec::load(view_.u() + at);
    DoubleVec dv = xy[1] * fy + cy - DoubleVec::load(view_.v() + at);
    const DoubleVec later = delay(at, du, dv);
    const DoubleVec scale = weigh(DoubleVec::load(view_.weight() + at), du, dv, cost);

    const std::size_t stride = 2 * rows_.padded();
    const Row u = {rows_.u(0) + at, stride};
    const Row v = {rows_.v(0) + at, stride};
    u.put(RowLayout::kResidual, scale * du);
    v.put(RowLayout::kResidual, scale * dv);
    if constexpr (kDerivatives == Derivatives::kNone) return all_true(valid);
    const DoubleVec su = scale * fx;
    const DoubleVec sv = scale * fy;
    const DoubleVec sk = scale * point_.skew;
    DoubleVec gu[3];
    DoubleVec gv[3];
    for (int k = 0; k < 3; ++k) {
      gu[k] = su * jp[k] + sk * jp[3 + k];
      gv[k] = sv * jp[3 + k];
    }
    pose(u, p, gu);
    pose(v, p, gv);
    if constexpr (kIntrinsics) camera(u, v, xy, jd, scale);
    readout(u, v, at, scale * later * later);
    modes(u, at, gu);
    modes(v, at, gv);
    return all_true(valid);
  }

  // The corners in the camera frame.
  void place(std::size_t at, DoubleVec* p) const {
    DoubleVec b[3];
    for (std::size_t k = 0; k < 3; ++k) {
      b[k] = DoubleVec::load(view_.board(k) + at);
      for (std::size_t m = 0; m < view_.modes(); ++m) {
        b[k] += DoubleVec::load(view_.mode(m, k) + at) * point_.shape[m];
      }
    }
    for (int i = 0; i < 3; ++i) {
      p[i] = b[0] * turn_[3 * i] + b[1] * turn_[3 * i + 1] + b[2] * turn_[3 * i + 2] + shift_[i];
    }
  }

  // Moves the projections from where the middle row shows them to where their own rows do. Between
  // two frames a corner that moves with the readout is read later: returns a frame's time over
  // that.
  DoubleVec delay(std::size_t at, DoubleVec& du, DoubleVec& dv) const {
    if (view_.motion(0) == nullptr || point_.readout == 0) return 1;
    const DoubleVec later =
        DoubleVec(1) / (DoubleVec::load(view_.motion(2) + at) * point_.readout + 1);
    du += DoubleVec::load(view_.motion(0) + at) * point_.readout * later;
    dv += DoubleVec::load(view_.motion(1) + at) * point_.readout * later;
    return later;
  }

  // The factor of the rows: the weight times the square root of the derivative of the loss.
  DoubleVec weigh(DoubleVec weight, DoubleVec du, DoubleVec dv, DoubleVec& cost) const {
    const DoubleVec squared = weight * weight * (du * du + dv * dv);
    const double c = loss_.scale;
    switch (loss_.kind) {
      case Loss::Kind::kHuber: {
        const DoubleVec distance = sqrt(squared);
        const auto beyond = distance > DoubleVec(c);
        cost += select(beyond, distance * (2 * c) - c * c, squared);
        return weight * sqrt(select(beyond, DoubleVec(c) / distance, DoubleVec(1)));
      }
      case Loss::Kind::kCauchy: {
        const DoubleVec excess = squared * (1 / (c * c));
        cost += DoubleVec(hn::Log1p(DoubleVec::Tag(), excess.raw)) * (c * c);
        return weight * sqrt(DoubleVec(1) / (excess + 1));
      }
      case Loss::Kind::kSquare:
        break;
    }
    cost += squared;
    return weight;
  }

  // A turn d moves the point by d x p.
  static void pose(const Row& row, const DoubleVec* p, const DoubleVec* g) {
    row.put(0, p[1] * g[2] - p[2] * g[1]);
    row.put(1, p[2] * g[0] - p[0] * g[2]);
    row.put(2, p[0] * g[1] - p[1] * g[0]);
    for (int k = 0; k < 3; ++k) row.put(3 + k, g[k]);
  }

  // The derivatives by the intrinsics. Columns that are always zero for one coordinate are not
  // written.
  void camera(const Row& u, const Row& v, const DoubleVec* xy, const DoubleVec* jd,
              DoubleVec scale) const {
    const double fx = point_.parameters[kCamera.focal()[0]];
    const double fy = point_.parameters[kCamera.focal()[1]];
    constexpr ParameterRange kFocal = kCamera.focal().after(kFirst);
    constexpr ParameterRange kCenter = kCamera.center().after(kFirst);
    constexpr ParameterRange kDistortion = kCamera.distortion().after(kFirst);
    u.put(kFocal[0], scale * xy[0]);
    v.put(kFocal[1], scale * xy[1]);
    u.put(kCenter[0], scale);
    v.put(kCenter[1], scale);
    for (int i = 0; i < kCount; ++i) {
      u.put(kDistortion[i], scale * (jd[i] * fx + jd[kCount + i] * point_.skew));
      v.put(kDistortion[i], scale * (jd[kCount + i] * fy));
    }
    if (rows_.layout().camera.has_skew) {
      u.put(kCamera.skew().after(kFirst)[0], scale * xy[1]);
    }
  }

  // The derivatives by the readout; the column may hold those of another view.
  void readout(const Row& u, const Row& v, std::size_t at, DoubleVec scale) const {
    if (!rows_.layout().has_readout) return;
    const bool moves = view_.motion(0) != nullptr;
    const int column = rows_.layout().readout();
    u.put(column, moves ? DoubleVec::load(view_.motion(0) + at) * scale : DoubleVec(0));
    v.put(column, moves ? DoubleVec::load(view_.motion(1) + at) * scale : DoubleVec(0));
  }

  void modes(const Row& row, std::size_t at, const DoubleVec* g) const {
    const int first = rows_.layout().first_mode();
    if (rows_.layout().modes == 0) return;
    DoubleVec b[3];  // the derivatives by the point in the board frame
    for (int k = 0; k < 3; ++k) {
      b[k] = g[0] * turn_[k] + g[1] * turn_[3 + k] + g[2] * turn_[6 + k];
    }
    for (int m = 0; m < rows_.layout().modes; ++m) {
      const auto mode = static_cast<std::size_t>(m);
      DoubleVec sum = b[0] * DoubleVec::load(view_.mode(mode, 0) + at);
      sum += b[1] * DoubleVec::load(view_.mode(mode, 1) + at);
      row.put(first + m, sum + b[2] * DoubleVec::load(view_.mode(mode, 2) + at));
    }
  }

  const ViewPoints& view_;
  const RowPoint& point_;
  ViewRows& rows_;
  Loss loss_;
  double turn_[9];
  double shift_[3];
};

}  // namespace calvin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
