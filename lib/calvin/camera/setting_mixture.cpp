// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Sums the parameters of settings, and their covariances.

#include "calvin/camera/setting_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/geometry/dense.hpp"

namespace calvin {

namespace {

double value_of(const Calibration& calibration, std::string_view name) {
  const Parameter* p = calibration.find(name);
  return p == nullptr ? 0 : p->value;
}

// One calibration as numbers, and what becomes of them in a mixture.
class Mixture {
 public:
  Mixture(const ZoomTable& table, ZoomLaw law, const std::vector<double>& weights)
      : table_(table), law_(law) {
    const Calibration& first = table.settings.front().calibration;
    const LensTraits& lens = *find_lens(first.model);
    for (const std::string_view name : parameter_names(first.model)) names_.emplace_back(name);
    orders_.assign(4, 0);  // of fx fy cx cy
    orders_.insert(orders_.end(), lens.orders.begin(), lens.orders.end());
    add_skew();
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (weights[i] != 0) parts_.push_back({&table.settings[i].calibration, weights[i]});
    }
    mix();
  }

  [[nodiscard]] Calibration take() {
    Calibration calibration;
    for (std::size_t k = 0; k < names_.size(); ++k) {
      calibration.parameters.push_back({names_[k], values_[k], {}});
    }
    add_covariance(calibration);
    return calibration;
  }

 private:
  struct Part {
    const Calibration* calibration;
    double weight;
  };
  [[nodiscard]] static bool is_focal(std::size_t k) { return k < 2; }
  [[nodiscard]] double f_of(const Part& part) const { return value_of(*part.calibration, "fx"); }
  // By which a coefficient of a part counts as one of the mixture.
  [[nodiscard]] double growth(const Part& part, std::size_t k) const {
    return std::pow(values_[0] / f_of(part), orders_[k]);
  }

  void add_skew() {
    const bool skewed = std::ranges::any_of(table_.settings, [](const ZoomSetting& setting) {
      return setting.calibration.find("skew") != nullptr;
    });
    if (!skewed) return;
    names_.emplace_back("skew");
    orders_.push_back(0);
  }

  void mix() {
    values_.assign(names_.size(), 0);
    for (std::size_t k = 0; k < names_.size(); ++k) {
      for (const Part& part : parts_) {
        const double value = value_of(*part.calibration, names_[k]);
        values_[k] += part.weight * (is_focal(k) ? by_law(law_, value) : growth(part, k) * value);
      }
      if (is_focal(k)) values_[k] = from_law(law_, values_[k]);
    }
  }

  // Of the mixture by the parameters of a part.
  [[nodiscard]] Eigen::MatrixXd derivative(const Part& part) const {
    const auto n = static_cast<Eigen::Index>(names_.size());
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t k = 0; k < names_.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double value = value_of(*part.calibration, names_[k]);
      if (is_focal(k)) {
        j(row, row) = part.weight * slope_of_law(law_, value) / slope_of_law(law_, values_[k]);
        continue;
      }
      j(row, row) = part.weight * growth(part, k);
      j(row, 0) = orders_[k] * (values_[k] / values_[0] * j(0, 0) -
                                part.weight * growth(part, k) * value / f_of(part));
    }
    return j;
  }

  // Over all parameters; zero for those that were not estimated.
  [[nodiscard]] Eigen::MatrixXd covariance_of(const Calibration& calibration) const {
    std::vector<Eigen::Index> rows;
    for (const Parameter& p : calibration.parameters) {
      if (p.sigma) rows.push_back(std::ranges::find(names_, p.name) - names_.begin());
    }
    const auto n = static_cast<Eigen::Index>(names_.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    const bool known = calibration.covariance.size() == rows.size() * rows.size();
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (std::size_t c = 0; known && c < rows.size(); ++c) {
        all(rows[r], rows[c]) = calibration.covariance[r * rows.size() + c];
      }
      const double sigma = *calibration.find(names_[static_cast<std::size_t>(rows[r])])->sigma;
      if (!known) all(rows[r], rows[r]) = sigma * sigma;
    }
    return all;
  }

  void add_covariance(Calibration& calibration) const {
    const auto n = static_cast<Eigen::Index>(names_.size());
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n, n);
    for (const Part& part : parts_) {
      all += congruent(covariance_of(*part.calibration), derivative(part).transpose());
    }
    std::vector<Eigen::Index> rows;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (!(all(k, k) > 0)) continue;
      rows.push_back(k);
      calibration.parameters[static_cast<std::size_t>(k)].sigma = std::sqrt(all(k, k));
    }
    for (const Eigen::Index r : rows) {
      for (const Eigen::Index c : rows) {
        calibration.covariance.push_back((all(r, c) + all(c, r)) / 2);
      }
    }
  }

  const ZoomTable& table_;
  ZoomLaw law_;
  std::vector<std::string> names_;
  std::vector<int> orders_;
  std::vector<Part> parts_;
  std::vector<double> values_;
};

}  // namespace

Calibration mix_settings(const ZoomTable& table, ZoomLaw law, const std::vector<double>& weights) {
  return Mixture(table, law, weights).take();
}

}  // namespace calvin
