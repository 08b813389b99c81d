// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The unknowns that all views of a problem share: where each stands, which of them are held or
// tied, and what was known of them before. After mrcal_state_index_*(). Internal.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "calvin/core/result.hpp"
#include "calvin/solve/parameters/parameter_order.hpp"

namespace calvin {

// What a table has to know of a camera.
struct TableCamera {
  std::string model;
  bool has_skew = false;  // the skew is estimated
  double skew = 0;        // px, where it is not estimated
  // Whether the camera has a place in the rig (camera_from_rig, 6 unknowns); else it is the rig.
  bool has_rig_pose = false;
  bool has_readout = false;  // the time from the first row to the last is an unknown
  // The intrinsics where they are known and so no unknowns, in the order of CameraUnknowns; the
  // skew is then known as well. A held unknown stays in the equations, a known one is not in them.
  std::vector<double> known = {};
};

// The unknowns stand in this order: those of every camera, the readout of every camera, the place
// of every camera in the rig, those of every board. "camera" and "board" are numbers in the lists
// that the table was made of; "unknown" is a number below count().
//
// An unknown has a value in a vector of count() values. The place of a camera in the rig moves by
// exp(d) from the left, as poses do: its six values are those of d and are 0 wherever a pose is.
class ParameterTable {
 public:
  ParameterTable() = default;
  explicit ParameterTable(std::vector<TableCamera> cameras, std::vector<BoardUnknowns> boards = {});

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t cameras() const { return cameras_.size(); }
  [[nodiscard]] std::size_t boards() const { return boards_.size(); }

  [[nodiscard]] const std::string& model(std::size_t camera) const {
    return cameras_[camera].of.model;
  }
  [[nodiscard]] const CameraUnknowns& unknowns(std::size_t camera) const {
    return cameras_[camera].unknowns;
  }

  // Whether the intrinsics of the camera are no unknowns.
  [[nodiscard]] bool is_known(std::size_t camera) const {
    return !cameras_[camera].of.known.empty();
  }
  // The intrinsics of the camera at these values, known or not.
  [[nodiscard]] const double* intrinsics_at(std::size_t camera,
                                            std::span<const double> values) const {
    return is_known(camera) ? cameras_[camera].of.known.data()
                            : values.data() + intrinsics(camera).first;
  }

  // The ranges. A range is empty where its unknowns are not estimated. camera() are all those that
  // a projection depends on, in the order of CameraUnknowns; intrinsics() are those that a Camera
  // is made of.
  [[nodiscard]] ParameterRange camera(std::size_t i) const { return within(i, order(i).all()); }
  [[nodiscard]] ParameterRange focal(std::size_t i) const { return within(i, order(i).focal()); }
  [[nodiscard]] ParameterRange center(std::size_t i) const { return within(i, order(i).center()); }
  [[nodiscard]] ParameterRange pinhole(std::size_t i) const {
    return within(i, order(i).pinhole());
  }
  [[nodiscard]] ParameterRange distortion(std::size_t i) const {
    return within(i, order(i).distortion());
  }
  [[nodiscard]] ParameterRange intrinsics(std::size_t i) const {
    return within(i, order(i).intrinsics());
  }
  [[nodiscard]] ParameterRange skew(std::size_t i) const { return within(i, order(i).skew()); }
  [[nodiscard]] ParameterRange readout(std::size_t i) const { return cameras_[i].readout; }
  [[nodiscard]] ParameterRange rig_pose(std::size_t i) const { return cameras_[i].rig_pose; }
  [[nodiscard]] ParameterRange board(std::size_t j) const {
    return boards_[j].unknowns.all().after(boards_[j].first);
  }
  [[nodiscard]] ParameterRange warp(std::size_t j) const {
    return boards_[j].unknowns.warp().after(boards_[j].first);
  }
  [[nodiscard]] ParameterRange aspect(std::size_t j) const {
    return boards_[j].unknowns.aspect().after(boards_[j].first);
  }
  [[nodiscard]] ParameterRange lights(std::size_t j) const {
    return boards_[j].unknowns.lights().after(boards_[j].first);
  }

  // The skew of a camera at these values, estimated or not, px.
  [[nodiscard]] double skew_at(std::size_t camera, std::span<const double> values) const;

  // The readout of a camera at these values, s; 0 where it is none of the unknowns.
  [[nodiscard]] double readout_at(std::size_t camera, std::span<const double> values) const {
    return readout(camera).empty() ? 0 : values[index(readout(camera).first)];
  }

  // "fx", or "camera1.fx" where there are several cameras; "board0.kx", "camera1.rx".
  [[nodiscard]] std::string name(int unknown) const;
  // Of one camera, by the name that a calibration file has for it: "fx", "k1", "skew".
  [[nodiscard]] std::optional<int> find(std::string_view parameter, std::size_t camera = 0) const;

  // Keeps an unknown at a value.
  void hold(int unknown, double value) { held_[index(unknown)] = value; }
  [[nodiscard]] const std::optional<double>& held(int unknown) const {
    return held_[index(unknown)];
  }

  // Lets `parameter` move as `ratio` times `with`. Neither is of a rig pose, and no parameter is
  // tied twice.
  struct Tie {
    int parameter = 0;
    int with = 0;
    double ratio = 1;
  };
  void tie(const Tie& tie) { ties_.push_back(tie); }
  [[nodiscard]] bool tied(int unknown) const;
  [[nodiscard]] const std::vector<Tie>& ties() const { return ties_; }
  // Lets every tie end at a free parameter; what is tied to a held parameter is held. To be called
  // after the last tie. An error where ties lead in a circle or contradict what is held.
  [[nodiscard]] Status resolve_ties();

  // A measurement of an unknown that was made before; there is none of a rig pose.
  struct Prior {
    int unknown = 0;
    double value = 0;
    double sigma = 1;
  };
  void add_prior(const Prior& prior) { priors_.push_back(prior); }
  [[nodiscard]] const std::vector<Prior>& priors() const { return priors_; }

  // unknowns x directions: a column for each unknown that is free, and in it whatever is tied to
  // it.
  [[nodiscard]] Eigen::MatrixXd basis() const;
  // Gives held and tied unknowns their values. Of tied focal lengths the product is kept.
  void apply(std::span<double> values) const;

 private:
  struct Camera {
    TableCamera of;
    CameraUnknowns unknowns;
    int first = 0;
    ParameterRange readout;
    ParameterRange rig_pose;
  };
  struct Board {
    BoardUnknowns unknowns;
    int first = 0;
  };

  static std::size_t index(int unknown) { return static_cast<std::size_t>(unknown); }
  [[nodiscard]] const CameraUnknowns& order(std::size_t i) const { return cameras_[i].unknowns; }
  [[nodiscard]] ParameterRange within(std::size_t i, ParameterRange range) const {
    return is_known(i) ? ParameterRange{cameras_[i].first, 0} : range.after(cameras_[i].first);
  }
  ParameterRange take(int unknowns);
  [[nodiscard]] bool same_focal(const Tie& tie) const;
  [[nodiscard]] std::string camera_name(std::size_t camera, int unknown) const;
  [[nodiscard]] std::string board_name(std::size_t board, int unknown) const;

  std::vector<Camera> cameras_;
  std::vector<Board> boards_;
  std::vector<std::optional<double>> held_;
  std::vector<Tie> ties_;
  std::vector<Prior> priors_;
  int count_ = 0;
};

// The values of a range.
[[nodiscard]] inline std::span<const double> values_of(std::span<const double> values,
                                                       ParameterRange range) {
  return values.subspan(static_cast<std::size_t>(range.first),
                        static_cast<std::size_t>(range.count));
}

// Whether a column of a basis moves any unknown of the range.
[[nodiscard]] inline bool moves(const Eigen::MatrixXd& basis, Eigen::Index column,
                                ParameterRange range) {
  return basis.col(column).segment(range.first, range.count).any();
}

}  // namespace calvin
