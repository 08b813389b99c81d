// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// The corners that frames share, their differences, and the slopes of parabolas through them.

#include "calvin/session/views/corner_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "calvin/camera/image_transform.hpp"
#include "calvin/geometry/dense.hpp"
#include "calvin/solve/view.hpp"

namespace calvin {

namespace {

// Where an observation has a corner. Boards may have tens of thousands of them.
class CornerPlaces {
 public:
  explicit CornerPlaces(const Observation& seen) : ids_(seen.ids), order_(ids_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (std::is_sorted(ids_.begin(), ids_.end())) return;
    std::sort(order_.begin(), order_.end(),
              [this](std::size_t a, std::size_t b) { return ids_[a] < ids_[b]; });
  }

  // Ids are asked for one after the other: the next one is mostly where the last one was left.
  std::optional<std::size_t> of(int id) {
    const auto expected = order_.begin() + next_;
    const auto at = expected != order_.end() && ids_[*expected] == id
                        ? expected
                        : std::lower_bound(order_.begin(), order_.end(), id,
                                           [this](std::size_t i, int to) { return ids_[i] < to; });
    if (at == order_.end() || ids_[*at] != id) return std::nullopt;
    next_ = at - order_.begin() + 1;
    return *at;
  }

 private:
  const std::vector<int>& ids_;
  std::vector<std::size_t> order_;  // of rising ids
  std::ptrdiff_t next_ = 0;
};

// A corner of the newest frame, and its steps to the two frames before, px/s.
struct Steps {
  Pixel at;
  Pixel last;
  Pixel first;
};

Pixel speed(Pixel from, Pixel to, double seconds) {
  return {(to.u - from.u) / seconds, (to.v - from.v) / seconds};
}

std::vector<Steps> steps_of(const Observation& earlier, const Observation& before,
                            const Observation& now, double first, double last) {
  std::vector<Steps> steps;
  constexpr std::size_t kEnough = 500;  // corners for a smooth field
  const std::size_t every = std::max<std::size_t>(1, now.ids.size() / kEnough);
  CornerPlaces places(before);
  CornerPlaces earlier_places(earlier);
  for (std::size_t i = 0; i < now.ids.size(); i += every) {
    const auto b = places.of(now.ids[i]);
    const auto a = earlier_places.of(now.ids[i]);
    if (!a || !b) continue;
    steps.push_back({now.uv[i], speed(before.uv[*b], now.uv[i], last),
                     speed(earlier.uv[*a], before.uv[*b], first)});
  }
  return steps;
}

double square(Pixel p) { return p.u * p.u + p.v * p.v; }

// 1 x y, and their products where there are corners enough; of a flat board that moves in any way
// the velocities are such polynomials, but for the lens (H. C. Longuet-Higgins, The reconstruction
// of a plane surface from two perspective projections, 1986).
class Field {
 public:
  Field(const std::vector<Steps>& steps, int terms) : terms_(terms) {
    for (const Steps& s : steps) {
      center_.u += s.at.u / static_cast<double>(steps.size());
      center_.v += s.at.v / static_cast<double>(steps.size());
    }
    for (const Steps& s : steps) {
      extent_ = std::max({extent_, std::abs(s.at.u - center_.u), std::abs(s.at.v - center_.v)});
    }
  }

  [[nodiscard]] Eigen::RowVectorXd row(Pixel at) const {
    const double x = (at.u - center_.u) / extent_;
    const double y = (at.v - center_.v) / extent_;
    Eigen::RowVectorXd all(6);
    all << 1, x, y, x * x, x * y, y * y;
    return all.head(terms_);
  }

 private:
  int terms_;
  Pixel center_;
  double extent_ = 1;  // px
};

}  // namespace

double seconds_between(const Observation& from, const Observation& to) {
  if (from.timestamp == kNoTimestamp || to.timestamp == kNoTimestamp) return 0;
  return to.timestamp > from.timestamp ? 1e-9 * static_cast<double>(to.timestamp - from.timestamp)
                                       : 0;
}

bool shows_same_picture(const Observation& a, const Observation& b) {
  constexpr double kAlike = 0.2;      // sigmas; of two pictures it is the root of 2
  constexpr double kRounding = 1e-6;  // px
  if (a.uv.size() != b.uv.size()) return false;
  double squares = 0;
  double most = 0;
  // Most pictures differ in the first corner already.
  for (std::size_t i = 0; i < a.uv.size(); ++i) {
    const auto known = [i](const Observation& o) {
      return i < o.sigma.size() && is_known_sigma(o.sigma[i]) ? o.sigma[i] : 0;
    };
    const double sigma = kAlike * std::min(known(a), known(b)) + kRounding;
    const double step = square({a.uv[i].u - b.uv[i].u, a.uv[i].v - b.uv[i].v});
    if (step > 100 * sigma * sigma) return false;
    squares += step;
    most += 2 * sigma * sigma;
  }
  return squares <= most && a.board == b.board && a.ids == b.ids;
}

CornerMotion corner_motion(const Observation& from, const Observation& to) {
  std::vector<Pixel> moves;
  Pixel mean;
  double squares = 0;
  const auto variance = [](const Observation& o, std::size_t i) {
    return i < o.sigma.size() && is_known_sigma(o.sigma[i]) ? 2 * o.sigma[i] * o.sigma[i] : 0;
  };
  CornerPlaces places(from);
  for (std::size_t i = 0; i < to.ids.size(); ++i) {
    const auto before = places.of(to.ids[i]);
    if (!before) continue;
    const Pixel& old = from.uv[*before];
    moves.push_back({to.uv[i].u - old.u, to.uv[i].v - old.v});
    squares += square(moves.back()) - variance(to, i) - variance(from, *before);
    mean.u += moves.back().u;
    mean.v += moves.back().v;
  }
  CornerMotion m;
  m.shared = moves.size();
  if (moves.empty()) return m;
  const auto n = static_cast<double>(moves.size());
  mean = {mean.u / n, mean.v / n};
  m.center = std::hypot(mean.u, mean.v);
  m.all = std::sqrt(std::max(squares, 0.0) / n);
  for (const Pixel& d : moves) {
    m.about_center += std::hypot(d.u - mean.u, d.v - mean.v) / n;
  }
  return m;
}

std::optional<CornerVelocities> corner_velocities(const Observation& earlier,
                                                  const Observation& before,
                                                  const Observation& now) {
  constexpr std::size_t kFewest = 6;   // corners for a linear field
  constexpr std::size_t kEnough = 16;  // for a quadratic one
  constexpr double kSteady = 0.7;      // change of a step, of the step
  const double first = seconds_between(earlier, before);
  const double last = seconds_between(before, now);
  if (!(first > 0 && last > 0)) return std::nullopt;
  const std::vector<Steps> steps = steps_of(earlier, before, now, first, last);
  if (steps.size() < kFewest) return std::nullopt;
  const Field field(steps, steps.size() < kEnough ? 3 : 6);
  const auto n = static_cast<Eigen::Index>(steps.size());
  Eigen::MatrixXd rows(n, field.row(steps.front().at).size());
  Eigen::MatrixXd slopes(n, 2);
  Eigen::MatrixXd changes(n, 2);
  double size = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Steps& s = steps[static_cast<std::size_t>(i)];
    rows.row(i) = field.row(s.at);
    changes.row(i) << s.last.u - s.first.u, s.last.v - s.first.v;
    slopes.row(i) << s.last.u, s.last.v;
    size += square(s.last);
  }
  slopes += changes * (last / (first + last));
  Eigen::MatrixXd both(n, 4);
  both << slopes, changes;
  const LeastSquares fit = least_squares(rows, both);
  if (fit.rank < rows.cols()) return std::nullopt;
  const Eigen::MatrixXd fields = fit.x.leftCols<2>();
  const Eigen::MatrixXd explained = product(rows, fit.x);
  const double degrees = 2.0 * static_cast<double>(n - rows.cols());
  const double noise = degrees > 0 ? (slopes - explained.leftCols<2>()).squaredNorm() / degrees : 0;
  // What is left of the changes once the noise of three positions in each is taken off.
  const double change = explained.rightCols<2>().squaredNorm();
  if (change > kSteady * kSteady * size + noise * static_cast<double>(n)) return std::nullopt;
  CornerVelocities result;
  for (const Pixel& at : now.uv) {
    const Eigen::RowVectorXd velocity = field.row(at) * fields;
    result.of.push_back({velocity[0], velocity[1]});
  }
  result.sigma = std::sqrt(noise * static_cast<double>(rows.cols()) / static_cast<double>(n));
  result.change = {changes.col(0).mean(), changes.col(1).mean()};
  return result;
}

// A cubic through four positions has the slope of the parabola through the last three and a third
// of how much the change of the steps has changed.
double uneven_motion(const CornerVelocities& now, const std::optional<SteadyMotion>& before) {
  constexpr double kOfThirdDifference = 1.0 / 3;
  const Pixel last = before ? before->change : Pixel{};
  return kOfThirdDifference * std::hypot(now.change.u - last.u, now.change.v - last.v);
}

bool is_significant(const CornerVelocities& velocities) {
  constexpr double kSigmas = 2;
  double squares = 0;
  for (const Pixel& v : velocities.of) squares += square(v);
  const double sigma = kSigmas * velocities.sigma;
  return squares > 2 * sigma * sigma * static_cast<double>(velocities.of.size());
}

double left_of_motion(double sigma, double readout, double v, int height) {
  return sigma * readout * std::abs(row_delay(v, height));
}

}  // namespace calvin
