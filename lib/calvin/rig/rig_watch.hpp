// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Whether the cameras of a rig stand where it has them, instant by instant: one that is pushed is
// told of while the others go on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "calvin/core/rig.hpp"
#include "calvin/rig/rig_views.hpp"
#include "calvin/rig/solve_rig.hpp"
#include "calvin/rig/watch/pair_tests.hpp"

namespace calvin {

// A rig, and how well pairs of its cameras agree with it where it was solved.
struct WatchedRig {
  struct Pair {
    std::size_t a = 0;  // cameras of the rig, a < b
    std::size_t b = 0;
    double usual =
        1;  // e^T C^-1 e / 6 of an instant, at least 1: how far covariances are too small
  };
  Rig rig;
  std::vector<Pair> pairs;  // those that have seen boards together often enough to be watched
};

// By some of the instants that the rig was solved from. Takes no longer than some fits of poses.
[[nodiscard]] WatchedRig watched_rig(const Rig& rig, const std::vector<RigCameraViews>& seen,
                                     const RigOptions& options);

// A camera that stands elsewhere than the rig has it.
struct MovedCamera {
  std::vector<std::string> cameras;  // one of them: two where no third camera tells which
  std::uint64_t since = 0;           // ns, of the first instant that contradicts the rig
  double place = 0;                  // m
  double turn = 0;                   // rad
};

// "The camera 'left' has moved: it stands 5.1 mm and 0.48 degrees from where the rig has it."
[[nodiscard]] std::string to_text(const MovedCamera& moved);

// Keeps what was said of each camera last. Not thread-safe.
class RigWatch {
 public:
  // Forgets all.
  void start() { cameras_.clear(); }

  // Instants after those that were told before, in which views of different cameras are at most
  // `tolerance` ns apart. A camera has moved where several instants in a row say so by the other
  // cameras, each beyond what its covariance allows and all in the same way, and where their mean
  // does by 5 sigmas. Of two cameras it is the one that a third one speaks against. Cameras in
  // `left_out` are not looked at, and what was said of them and by them is forgotten.
  [[nodiscard]] std::vector<MovedCamera> look(const WatchedRig& watched,
                                              const std::vector<std::string>& left_out,
                                              const std::vector<RigCameraViews>& seen,
                                              std::uint64_t tolerance);

 private:
  struct Mean {
    rig::Vector6 change;
    rig::Matrix6 covariance;
  };
  struct Evidence {
    int in_a_row = 0;          // instants that contradict the rig in the same way, up to the last
    std::uint64_t since = 0;   // ns, of the first of them
    std::set<std::string> by;  // the other cameras in these instants
    std::uint64_t agreed = 0;  // ns, of the last instant that agrees with the rig; 0: none
    // Of these instants, those between which the board has moved.
    rig::Matrix6 information = rig::Matrix6::Zero();
    rig::Vector6 weighted = rig::Vector6::Zero();
    std::array<Pixel, 2> seen{};

    void add(const rig::PairTest& test, const std::string& other, double usual);
    [[nodiscard]] Mean mean() const;
    [[nodiscard]] bool says_same(const rig::Discrepancy& now, double usual) const;
  };

  void forget(const std::vector<std::string>& cameras);
  [[nodiscard]] std::optional<MovedCamera> judge(const std::string& camera,
                                                 const rig::Discrepancy& last, double usual,
                                                 bool is_pair) const;

  std::map<std::string, Evidence> cameras_;
};

}  // namespace calvin
