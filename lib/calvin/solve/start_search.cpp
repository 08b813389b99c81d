// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

#include "calvin/solve/start_search.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calvin/solve/outliers.hpp"

namespace calvin {

namespace {

constexpr std::size_t kTrialViews = 12;
constexpr std::size_t kFewViews = 8;
constexpr std::size_t kTrials = 4;

// A start that is farther off than this, in image widths, is in the wrong valley.
constexpr double kFar = 1e-3;

std::vector<const FitView*> sample_of(const std::vector<const FitView*>& views) {
  std::vector<const FitView*> sample;
  const std::size_t n = std::min(views.size(), kTrialViews);
  for (std::size_t i = 0; i < n; ++i) sample.push_back(views[i * views.size() / n]);
  return sample;
}

}  // namespace

bool StartSearch::far(double scale) const { return !(scale < kFar * size_.width); }

Candidate StartSearch::quick(const std::vector<const FitView*>& views) {
  Candidate best;
  if (!freedom_.lens.perspective || !freedom_.initial.empty() || views.size() < kFewViews) {
    return best;
  }
  std::vector<Eigen::Matrix3d> homographies;
  for (const FitView* view : views) {
    const auto h = view_homography(view->set, size_);
    if (!h) return best;
    homographies.push_back(*h);
  }
  const auto poses = [&](const Candidate& c, std::size_t n) {
    const Guess held = {c.shared[0], c.shared[1], c.shared[2], c.shared[3]};
    Poses result;
    for (std::size_t v = 0; v < n; ++v) {
      result.push_back(pose_by_guess(homographies[v * views.size() / n], held, size_));
    }
    return result;
  };
  const std::vector<const FitView*> sample = sample_of(views);
  for (const Guess& guess : closed_form_guesses(homographies, size_)) {
    Candidate c = with(guess, freedom_.lens.starts.front());
    c.poses = poses(c, sample.size());
    c.scale = scale_of(c, sample);
    if (c.scale < best.scale) best = std::move(c);
  }
  if (std::isfinite(best.scale)) best.poses = poses(best, views.size());
  return best;
}

Candidate StartSearch::thorough(const std::vector<const FitView*>& views) {
  const std::vector<const FitView*> sample = sample_of(views);
  Candidate best = best_of(from_initial(), sample, 1);
  if (far(best.scale)) {
    Candidate other = best_of(guesses(sample), sample, kTrials);
    if (other.scale < best.scale) best = std::move(other);
  }
  if (std::isfinite(best.scale)) best.poses = least_squares_.poses_for(best.shared, views);
  return best;
}

std::vector<Candidate> StartSearch::from_initial() const {
  if (freedom_.initial.empty()) return {};
  Candidate c;
  c.shared = freedom_.initial;
  freedom_.hold(c.shared.data());
  return {std::move(c)};
}

Candidate StartSearch::with(const Guess& guess, const std::vector<double>& coefficients) const {
  Candidate c;
  c.shared.assign(static_cast<std::size_t>(freedom_.layout.shared()), 0);
  std::copy(guess.begin(), guess.end(), c.shared.begin());
  std::copy(coefficients.begin(), coefficients.end(), c.shared.begin() + 4);
  freedom_.hold(c.shared.data());
  return c;
}

std::vector<Candidate> StartSearch::guesses(const std::vector<const FitView*>& sample) const {
  std::vector<Guess> cameras;
  if (freedom_.lens.perspective) {
    std::vector<Eigen::Matrix3d> homographies;
    for (const FitView* view : sample) {
      if (const auto h = view_homography(view->set, size_)) homographies.push_back(*h);
    }
    cameras = closed_form_guesses(homographies, size_);
  }
  const auto more = focal_grid(size_, freedom_.lens.perspective);
  cameras.insert(cameras.end(), more.begin(), more.end());
  std::vector<Candidate> candidates;
  for (const Guess& guess : cameras) {
    for (const auto& start : freedom_.lens.starts) candidates.push_back(with(guess, start));
  }
  return candidates;
}

Candidate StartSearch::best_of(std::vector<Candidate> candidates,
                               const std::vector<const FitView*>& sample, std::size_t trials) {
  for (Candidate& c : candidates) {
    c.poses = least_squares_.poses_for(c.shared, sample);
    c.scale = scale_of(c, sample);
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.scale < b.scale; });
  if (candidates.size() > trials) candidates.resize(trials);
  Candidate best;
  Eigen::MatrixXd focal = Eigen::MatrixXd::Zero(freedom_.layout.shared(), 1);
  focal(0, 0) = 1;
  focal(1, 0) = freedom_.aspect();
  for (Candidate& c : candidates) {
    if (!freedom_.held[0] && !freedom_.held[1]) improve(c, sample, focal, 5);
    improve(c, sample, freedom_.basis, 15);
    if (c.scale < best.scale) best = std::move(c);
  }
  return best;
}

void StartSearch::improve(Candidate& c, const std::vector<const FitView*>& sample,
                          const Eigen::MatrixXd& basis, int iterations) {
  const Loss loss{Loss::Kind::kHuber, 2 * c.scale};
  (void)least_squares_.minimise_over(sample, c.shared, c.poses, basis, loss, {iterations, 1e-4});
  c.scale = scale_of(c, sample);
}

double StartSearch::scale_of(const Candidate& c, const std::vector<const FitView*>& views) {
  std::vector<double> all;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const auto d = least_squares_.distances(*views[v], c.shared, c.poses[v]);
    all.insert(all.end(), d.begin(), d.end());
  }
  return robust_scale(std::move(all));
}

}  // namespace calvin
