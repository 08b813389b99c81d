// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Tries starts on a sample of the views and ranks the cameras that they lead to.

#include "calvin/solve/start/start_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "calvin/solve/residuals/outliers.hpp"
#include "calvin/solve/start/pose_fit.hpp"

namespace calvin {

namespace {

// The trials of thorough().
constexpr std::size_t kTrialViews = 12;  // views on which a start is tried
constexpr std::size_t kTrials = 4;       // starts that are improved over all these views
constexpr std::size_t kTrialsOfFew = 8;  // where there are few views

// The sample of quick(): one focal length found on it gives the poses of all views.
constexpr std::size_t kQuickViews = 6;
constexpr std::size_t kQuickCorners = 16;  // of a view
constexpr std::size_t kPoseCorners = 10;   // of a view whose camera is known nearly

// Few and rough iterations, which bring a start near the optimum.
constexpr LmOptions kRough = {8, 1e-2, 1e-2, 1e-6};

// A lens with more coefficients than this does not start with all of them free.
constexpr int kPlainLens = 5;

// Robust scale, in image widths, from which on a start is in the wrong basin.
constexpr double kWrongBasin = 1e-3;
// Times the best scale: a start with a larger scale is not followed.
constexpr double kHopeless = 4;

StartSearch::Views sample_of(const StartSearch::Views& views, std::size_t most) {
  StartSearch::Views sample;
  const std::size_t n = std::min(views.size(), most);
  for (std::size_t i = 0; i < n; ++i) sample.push_back(views[i * views.size() / n]);
  return sample;
}

PointSet thinned(const PointSet& all, std::size_t most = kQuickCorners) {
  PointSet few = all.without_corners();
  few.reserve(most);
  for (const std::size_t i : spread_corners(all.size(), most)) few.append(all, i);
  return few;
}

// The same views with a few of their corners.
class Thinned {
 public:
  Thinned(const StartSearch::Views& views, const BoardShape& shape) {
    views_.reserve(views.size());
    for (const FitView* view : views) {
      views_.emplace_back(thinned(view->set), shape, last_of(views_));
      pointers_.push_back(&views_.back());
    }
  }
  [[nodiscard]] const StartSearch::Views& views() const { return pointers_; }

 private:
  std::vector<FitView> views_;
  StartSearch::Views pointers_;
};

bool same_camera(const Candidate& a, const Candidate& b, const ParameterTable& table) {
  constexpr double kSame = 1e-2;
  const double focal = values_of(a.shared, table.focal(0)).front();
  for (std::size_t i = 0; i < a.shared.size(); ++i) {
    const double unit = table.pinhole(0).has(static_cast<int>(i)) ? focal : 1;
    if (std::abs(a.shared[i] - b.shared[i]) > kSame * unit) return false;
  }
  return true;
}

bool nearer(const Candidate& a, const Candidate& b) { return a.scale < b.scale; }

}  // namespace

bool StartSearch::is_far(double scale) const { return !(scale < kWrongBasin * size_.width); }

bool StartSearch::is_rich() const { return coefficients() > kPlainLens; }

int StartSearch::coefficients() const { return parameterization_.table.distortion(0).count; }

bool StartSearch::many_basins(const Views& views) const {
  return views.size() < kFewViews || parameterization_.lens.starts.size() > 1;
}

Candidate StartSearch::quick(const Views& views) {
  const bool is_given = !parameterization_.initial.empty() || !parameterization_.start.empty();
  if (is_given || parameterization_.lens.starts.size() > 1 ||
      (is_rich() && views.size() < kFewViews)) {
    return {};
  }
  const std::size_t most = is_rich() ? kTrialViews : kQuickViews;
  const Thinned sample(sample_of(views, most), shape_);
  Candidate best = parameterization_.lens.perspective ? by_closed_form(sample.views())
                                                      : by_focal_lengths(sample.views());
  if (!std::isfinite(best.scale)) return {};
  const auto camera = adjustment_.camera(best.shared);
  if (!camera) return {};
  const CameraPoints points(*camera);
  best.poses.assign(views.size(), std::nullopt);
  for (std::size_t v = 0; v < views.size() && !adjustment_.cancelled(); ++v) {
    const PointSet few = thinned(views[v]->set, kPoseCorners);
    best.poses[v] = start_pose(few, rays_of(few, points));
  }
  return best;
}

Candidate StartSearch::by_closed_form(const Views& sample) {
  std::vector<Eigen::Matrix3d> homographies;
  for (const FitView* view : sample) {
    const auto h = view_homography(view->set, size_);
    if (!h) return {};
    homographies.push_back(*h);
  }
  Candidate best;
  for (const Guess& guess : closed_form_guesses(homographies, size_)) {
    Candidate c = with(guess, parameterization_.lens.starts.front());
    Guess held;
    const auto pinhole = values_of(c.shared, parameterization_.table.pinhole(0));
    std::copy(pinhole.begin(), pinhole.end(), held.begin());
    for (const auto& h : homographies) c.poses.push_back(pose_by_guess(h, held, size_));
    c.scale = scale_of(c, sample);
    if (c.scale < best.scale) best = std::move(c);
  }
  if (!std::isfinite(best.scale)) return best;
  return is_rich() ? improved(std::move(best), sample, Regularization::kNone)
                   : minimised(std::move(best), sample, parameterization_.basis, kRough, {});
}

Candidate StartSearch::by_focal_lengths(const Views& sample) {
  std::vector<Candidate> candidates;
  const std::vector<Guess> grid = focal_grid(size_, false);
  for (std::size_t i = 1; i < grid.size(); i += 2) {
    candidates.push_back(with(grid[i], parameterization_.lens.starts.front()));
  }
  auto found = best_of(std::move(candidates), sample, 1);
  return found.empty() ? Candidate() : std::move(found.front());
}

std::vector<Candidate> StartSearch::thorough(const Views& views) {
  const Views sample = sample_of(views, kTrialViews);
  std::vector<Candidate> found = best_of(from_initial(), sample, 1);
  if (found.empty() || is_far(found.front().scale)) {
    const std::size_t trials = views.size() < kFewViews ? kTrialsOfFew : kTrials;
    for (const auto& start : parameterization_.lens.starts) {
      auto more = best_of(guesses(sample, start), sample, trials);
      std::move(more.begin(), more.end(), std::back_inserter(found));
    }
  }
  std::stable_sort(found.begin(), found.end(), nearer);
  std::vector<Candidate> distinct;
  for (Candidate& c : found) {
    if (!std::isfinite(c.scale) || c.scale > kHopeless * found.front().scale) continue;
    const auto is_same = [&](const Candidate& other) {
      return same_camera(c, other, parameterization_.table);
    };
    if (std::any_of(distinct.begin(), distinct.end(), is_same)) continue;
    if (sample.size() < views.size()) c.poses = adjustment_.poses_for(c.shared, views);
    distinct.push_back(std::move(c));
  }
  return distinct;
}

std::vector<Candidate> StartSearch::from_initial() const {
  const bool by_method = !parameterization_.start.empty();
  if (parameterization_.initial.empty() && !by_method) return {};
  Candidate c;
  c.shared = by_method ? parameterization_.start : parameterization_.initial;
  parameterization_.table.apply(c.shared);
  return {std::move(c)};
}

Candidate StartSearch::with(const Guess& guess, const std::vector<double>& coefficients) const {
  Candidate c;
  const ParameterTable& table = parameterization_.table;
  c.shared.assign(static_cast<std::size_t>(table.count()), 0);
  std::copy(guess.begin(), guess.end(), c.shared.begin() + table.pinhole(0).first);
  std::copy(coefficients.begin(), coefficients.end(), c.shared.begin() + table.distortion(0).first);
  parameterization_.table.apply(c.shared);
  return c;
}

std::vector<Candidate> StartSearch::guesses(const Views& sample,
                                            const std::vector<double>& start) const {
  std::vector<Guess> cameras;
  if (parameterization_.lens.perspective) {
    std::vector<Eigen::Matrix3d> homographies;
    for (const FitView* view : sample) {
      if (const auto h = view_homography(view->set, size_)) homographies.push_back(*h);
    }
    cameras = closed_form_guesses(homographies, size_);
    for (const FitView* view : sample) {
      if (const auto guess = guess_in_space(view->set, size_)) cameras.push_back(*guess);
    }
  }
  const auto more = focal_grid(size_, parameterization_.lens.perspective);
  cameras.insert(cameras.end(), more.begin(), more.end());
  std::vector<Candidate> candidates;
  for (const Guess& guess : cameras) candidates.push_back(with(guess, start));
  return candidates;
}

std::vector<Candidate> StartSearch::best_of(std::vector<Candidate> candidates, const Views& sample,
                                            std::size_t trials) {
  const Thinned few(sample, shape_);
  for (Candidate& c : candidates) {
    if (adjustment_.cancelled()) return {};
    c.poses = adjustment_.poses_for(c.shared, few.views());
    c.scale = scale_of(c, few.views());
  }
  std::sort(candidates.begin(), candidates.end(), nearer);
  if (candidates.size() > trials) candidates.resize(trials);
  drop_copies(candidates, few.views());
  for (Candidate& c : candidates) c = improved(std::move(c), sample, Regularization::kPriors);
  std::sort(candidates.begin(), candidates.end(), nearer);
  return candidates;
}

void StartSearch::drop_copies(std::vector<Candidate>& candidates, const Views& few) {
  std::vector<Eigen::MatrixXd> directions = {stages().front()};
  // A rich lens would take a few corners for more than they tell.
  if (!is_rich()) directions.push_back(parameterization_.basis);
  std::vector<std::vector<Candidate>> ends(directions.size());  // of all that were followed so far
  const auto leads_elsewhere = [&](Candidate c) {
    constexpr double kSameScale = 1e-2;  // as a part
    for (std::size_t i = 0; i < directions.size(); ++i) {
      c = minimised(std::move(c), few, directions[i], kRough, {});
      const auto is_same = [&](const Candidate& other) {
        return same_camera(c, other, parameterization_.table) &&
               std::abs(c.scale - other.scale) <= kSameScale * other.scale;
      };
      if (std::any_of(ends[i].begin(), ends[i].end(), is_same)) return false;
      ends[i].push_back(c);
    }
    return true;
  };
  std::erase_if(candidates, [&](const Candidate& c) { return !leads_elsewhere(c); });
}

Eigen::MatrixXd StartSearch::leading(int most) const {
  const Eigen::MatrixXd& all = parameterization_.basis;
  const int first = parameterization_.table.distortion(0)[std::min(most, coefficients())];
  const ParameterRange behind = {first, parameterization_.table.count() - first};
  std::vector<Eigen::Index> columns;
  for (Eigen::Index c = 0; c < all.cols(); ++c) {
    if (!moves(all, c, behind)) columns.push_back(c);
  }
  if (columns.empty()) return all;
  Eigen::MatrixXd some(all.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    some.col(static_cast<Eigen::Index>(i)) = all.col(columns[i]);
  }
  return some;
}

// The directions of each stage: first the focal length, then also the strongest coefficients, then
// all.
std::vector<Eigen::MatrixXd> StartSearch::stages() const {
  std::vector<Eigen::MatrixXd> result;
  const ParameterTable& table = parameterization_.table;
  const int fx = table.focal(0)[0];
  const int fy = table.focal(0)[1];
  if (!table.held(fx) && !table.held(fy)) {
    Eigen::MatrixXd focal = Eigen::MatrixXd::Zero(table.count(), 1);
    focal(fx, 0) = 1;
    focal(fy, 0) = parameterization_.aspect();
    result.push_back(std::move(focal));
  }
  for (const int most : {2, kPlainLens}) {
    if (coefficients() > most) result.push_back(leading(most));
  }
  result.push_back(parameterization_.basis);
  return result;
}

Candidate StartSearch::minimised(Candidate c, const Views& sample, const Eigen::MatrixXd& basis,
                                 const LmOptions& options, const Priors& priors) {
  const Loss loss{Loss::Kind::kHuber, 2 * c.scale};
  Candidate result = {
      adjustment_.minimise_over(sample, std::move(c), basis, loss, options, priors).at};
  result.scale = scale_of(result, sample);
  return result;
}

Candidate StartSearch::improved(Candidate c, const Views& sample, Regularization regularization) {
  const int iterations = is_rich() ? 40 : 15;
  const auto step = [&](const Eigen::MatrixXd& basis, const Priors& priors) {
    c = minimised(std::move(c), sample, basis, {basis.cols() == 1 ? 5 : iterations, 1e-5}, priors);
  };
  const bool regularized = is_rich() && regularization == Regularization::kPriors;
  for (const Eigen::MatrixXd& basis : stages())
    step(basis, regularized ? small(1 / c.scale) : Priors());
  for (const double looser : {4, 16, 64, 256}) {
    if (regularized) step(parameterization_.basis, small(looser / c.scale));
  }
  return c;
}

// Priors at 0 for the higher coefficients: at the start nothing keeps numerator and denominator of
// a rational lens from growing together and cancelling.
StartSearch::Priors StartSearch::small(double sigma) const {
  Priors priors;
  for (int i = kPlainLens; i < coefficients(); ++i)
    priors.push_back({parameterization_.table.distortion(0)[i], 0, sigma});
  return priors;
}

double StartSearch::scale_of(const Candidate& c, const Views& views) {
  std::vector<double> all;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto d = adjustment_.distances(*views[v], c.shared, c.poses[v]);
    all.insert(all.end(), d.begin(), d.end());
  }
  return robust_scale(std::move(all));
}

}  // namespace calvin
