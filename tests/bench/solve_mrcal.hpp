// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// mrcal's optimisation through its C interface: the corners alone, without its regularisation, its
// search for outliers and its board warp.
#pragma once

#include <dlfcn.h>

#include <filesystem>
#include <string>

extern "C" {
#include <mrcal/mrcal.h>
}

#include "calvin/geometry/se3.hpp"
#include "solve_problem.hpp"

namespace bench {

class Mrcal {
 public:
  explicit Mrcal(const Problem& problem) : start_(near_truth(problem)) {
    for (std::size_t v = 0; v < problem.views.size(); ++v) {
      mrcal_observation_board_t seen{};
      seen.icam.intrinsics = 0;
      seen.icam.extrinsics = -1;
      seen.iframe = static_cast<int>(v);
      boards_.push_back(seen);
      for (const calvin::Pixel p : problem.views[v].observation.uv) {
        mrcal_point3_t at{};
        at.x = p.u;
        at.y = p.v;
        at.z = 1;  // weight
        pool_.push_back(at);
      }
    }
    selections_.do_optimize_intrinsics_core = true;
    selections_.do_optimize_intrinsics_distortions = true;
    selections_.do_optimize_frames = true;
    residuals_.resize(2 * pool_.size());
  }

  // "libmrcal.so.2.2": its headers do not tell the version.
  static std::string library() {
    Dl_info info{};
    if (dladdr(reinterpret_cast<void*>(&mrcal_optimize), &info) == 0) return "libmrcal";
    std::error_code ignored;
    return std::filesystem::canonical(info.dli_fname, ignored).filename();
  }

  // brown5 is mrcal's OPENCV5, of the same order.
  Fitted run() {
    Fitted fitted{start_.intrinsics, {}};
    std::vector<mrcal_pose_t> frames;
    for (const SE3& pose : start_.camera_from_board) {
      const Eigen::Vector3d w = calvin::log_so3(pose.rotation);
      mrcal_pose_t frame{};
      std::copy(w.data(), w.data() + 3, frame.r.xyz);
      std::copy(pose.translation.data(), pose.translation.data() + 3, frame.t.xyz);
      frames.push_back(frame);
    }
    mrcal_lensmodel_t model{};
    model.type = MRCAL_LENSMODEL_OPENCV5;
    const int size[2] = {kSize.width, kSize.height};
    const mrcal_problem_constants_t constants{};
    std::vector<double> state(fitted.intrinsics.size() + 6 * frames.size());
    mrcal_optimize(state.data(), static_cast<int>(state.size() * sizeof(double)), residuals_.data(),
                   static_cast<int>(residuals_.size() * sizeof(double)), fitted.intrinsics.data(),
                   nullptr, frames.data(), nullptr, nullptr, 1, 0, static_cast<int>(frames.size()),
                   0, 0, boards_.data(), nullptr, static_cast<int>(boards_.size()), 0, pool_.data(),
                   &model, size, selections_, &constants, kBoard.cell_size(0), kBoard.grid()->cols,
                   kBoard.grid()->rows, false, false);
    for (const mrcal_pose_t& frame : frames) {
      const Eigen::Vector3d w(frame.r.xyz);
      const Eigen::Vector3d t(frame.t.xyz);
      fitted.camera_from_board.push_back({calvin::exp_so3(w), t});
    }
    return fitted;
  }

 private:
  Fitted start_;
  std::vector<mrcal_observation_board_t> boards_;
  std::vector<mrcal_point3_t> pool_;
  std::vector<double> residuals_;
  mrcal_problem_selections_t selections_{};
};

}  // namespace bench
