// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads `fix` and `initial` into held values, ties and the basis of the directions.

#include "calvin/solve/freedom.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/models.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

// Models whose coefficients mean the same where they have the same name.
constexpr std::array<std::string_view, 6> kBrownFamily = {"pinhole",   "brown4",      "brown5",
                                                          "rational8", "thinprism12", "tilted14"};

constexpr std::string_view kSkew = "skew";

bool is_brown(std::string_view model) {
  return std::find(kBrownFamily.begin(), kBrownFamily.end(), model) != kBrownFamily.end();
}

using Names = std::vector<std::string_view>;

// The parameters of `model` as `calibration` has them; coefficients that it does not have
// are those of `start`.
std::vector<double> values_of(const Calibration& calibration, const Names& names,
                              std::string_view model, const std::vector<double>& start) {
  const bool related =
      calibration.model == model || (is_brown(calibration.model) && is_brown(model));
  std::vector<double> values;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool pinhole = i < 4 || names[i] == kSkew;
    const Parameter* p = pinhole || related ? calibration.find(names[i]) : nullptr;
    const bool has_start = i >= 4 && i - 4 < start.size();
    values.push_back(p != nullptr ? p->value : has_start ? start[i - 4] : 0);
  }
  return values;
}

// Reads the words of `fix` one after the other.
class Reader {
 public:
  Reader(Freedom& freedom, const Names& names, ImageSize size)
      : freedom_(freedom), names_(names), center_(image_center(size)) {}

  Status read(std::string_view word) {
    if (word == "aspect") {
      const auto& initial = freedom_.initial;
      return tie(0, 1, initial.empty() ? 1 : initial[1] / initial[0], word);
    }
    if (word == "center") {
      hold(2);
      hold(3);
      return {};
    }
    if (const auto equals = word.find('='); equals != std::string_view::npos) {
      const auto first = index_of(trim(word.substr(0, equals)));
      const auto second = index_of(trim(word.substr(equals + 1)));
      if (!first || !second) return unknown(word);
      return tie(*first, *second, 1, word);
    }
    const auto index = index_of(word);
    if (!index) return unknown(word);
    if (*index < 2 && freedom_.initial.empty()) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' cannot be fixed at nothing: give a calibration that has "
                                    "its value (initial).",
                                    word));
    }
    hold(*index);
    return {};
  }

 private:
  std::optional<std::size_t> index_of(std::string_view name) const {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at == names_.end()) return std::nullopt;
    return static_cast<std::size_t>(at - names_.begin());
  }

  void hold(std::size_t index) {
    double value = 0;
    // A lens without distortion, as near as the model has one.
    if (index >= 4 && index - 4 < freedom_.lens.starts.front().size()) {
      value = freedom_.lens.starts.front()[index - 4];
    }
    if (index == 2) value = center_.u;
    if (index == 3) value = center_.v;
    if (!freedom_.initial.empty()) value = freedom_.initial[index];
    freedom_.held[index] = value;
  }

  Status tie(std::size_t with, std::size_t parameter, double ratio, std::string_view word) {
    const auto taken = [&](const Freedom::Tie& t) { return t.parameter == parameter; };
    const bool twice = std::any_of(freedom_.ties.begin(), freedom_.ties.end(), taken);
    if (with == parameter || twice) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' ties a parameter that is tied already.", word));
    }
    freedom_.ties.push_back({parameter, with, ratio});
    return {};
  }

  Status unknown(std::string_view word) const {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("'{}' cannot be fixed. What can: aspect, center, {}, and two of them tied to "
                    "one value, as in fx=fy.",
                    word, join(names_, ", ")));
  }

  Freedom& freedom_;
  const Names& names_;
  Pixel center_;
};

LensTraits traits_of(std::string_view model) {
  LensTraits traits;
  visit_model(model, [&]<typename M>() {
    traits.perspective = M::Lens::kPerspective;
    for (const auto& start : M::Lens::kStarts) {
      traits.starts.emplace_back(start.begin(), start.end());
    }
  });
  return traits;
}

// A parameter that is tied to a held one is held too; a chain of ties ends at a free parameter.
Status resolve_ties(Freedom& freedom, const Names& names) {
  for (bool changed = true; changed;) {
    changed = false;
    for (Freedom::Tie& tie : freedom.ties) {
      const auto& target = freedom.held[tie.with];
      if (freedom.held[tie.parameter] && !target) {
        return make_error(ErrorCode::kInvalidArgument,
                          fmt::format("'{}' cannot be both fixed and tied to '{}'.",
                                      names[tie.parameter], names[tie.with]));
      }
      if (target && !freedom.held[tie.parameter]) {
        freedom.held[tie.parameter] = tie.ratio * *target;
        changed = true;
      }
      for (const Freedom::Tie& other : freedom.ties) {
        if (other.parameter != tie.with) continue;
        if (other.with == tie.parameter) {
          return make_error(ErrorCode::kInvalidArgument, "What is tied leads in a circle.");
        }
        tie = {tie.parameter, other.with, tie.ratio * other.ratio};
        changed = true;
      }
    }
  }
  return {};
}

void make_basis(Freedom& freedom) {
  const std::size_t count = freedom.held.size();
  freedom.estimated.assign(count, false);
  std::vector<Eigen::Index> column(count, -1);
  Eigen::Index columns = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto tied = [i](const Freedom::Tie& t) { return t.parameter == i; };
    freedom.estimated[i] = !freedom.held[i].has_value();
    const bool own = std::none_of(freedom.ties.begin(), freedom.ties.end(), tied);
    if (freedom.estimated[i] && own) column[i] = columns++;
  }
  freedom.basis = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), columns);
  for (std::size_t i = 0; i < count; ++i) {
    if (column[i] >= 0) freedom.basis(static_cast<Eigen::Index>(i), column[i]) = 1;
  }
  for (const Freedom::Tie& tie : freedom.ties) {
    if (!freedom.estimated[tie.parameter]) continue;
    freedom.basis(static_cast<Eigen::Index>(tie.parameter), column[tie.with]) = tie.ratio;
  }
}

}  // namespace

RowPoint Freedom::row_point(const std::vector<double>& shared) const {
  return calvin::row_point(layout, shared.data(), skew);
}

int Freedom::pinhole_directions() const {
  int directions = 0;
  for (Eigen::Index c = 0; c < basis.cols(); ++c) directions += basis.col(c).head(4).any() ? 1 : 0;
  // Skew takes one more equation of the boards.
  if (layout.skew) ++directions;
  return directions;
}

void Freedom::hold(double* parameters) const {
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i]) parameters[i] = *held[i];
  }
  for (const Tie& tie : ties) {
    if (held[tie.parameter]) continue;
    const double product = parameters[tie.with] * parameters[tie.parameter] / tie.ratio;
    if (tie.parameter < 2 && tie.with < 2 && product > 0) {
      parameters[tie.with] = std::sqrt(product);
    }
    parameters[tie.parameter] = tie.ratio * parameters[tie.with];
  }
}

double Freedom::aspect() const {
  if (held[0] && held[1]) return *held[1] / *held[0];
  for (const Tie& tie : ties) {
    if (tie.parameter == 1 && tie.with == 0) return tie.ratio;
    if (tie.parameter == 0 && tie.with == 1) return 1 / tie.ratio;
  }
  return 1;
}

Result<Freedom> make_freedom(const SolveOptions& options, ImageSize size, int modes) {
  Names names = parameter_names(options.model);
  if (names.empty()) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The camera model '{}' is not known to this version. Known "
                                  "models: {}.",
                                  options.model, join(model_names(), ", ")));
  }
  Freedom freedom;
  freedom.model = options.model;
  freedom.lens = traits_of(options.model);
  freedom.layout = {static_cast<int>(names.size()) - 4, options.skew, modes};
  if (options.skew) names.push_back(kSkew);
  freedom.held.resize(static_cast<std::size_t>(freedom.layout.shared()));
  if (options.initial) {
    const auto camera = Camera::make(*options.initial);
    if (!camera) return tl::unexpected<Error>(camera.error());
    if (size.width > 0 && camera->image_size() != size) {
      return make_error(
          ErrorCode::kInvalidArgument,
          fmt::format("The initial calibration is for {}x{} px, the views are of {}x{}: scale it.",
                      camera->image_size().width, camera->image_size().height, size.width,
                      size.height));
    }
    freedom.initial =
        values_of(*options.initial, names, options.model, freedom.lens.starts.front());
    freedom.initial.resize(freedom.held.size(), 0);
    if (!options.skew) freedom.skew = camera->skew();
  }
  Reader reader(freedom, names, size);
  for (const std::string& word : options.fix) {
    if (const Status read = reader.read(trim(word)); !read) {
      return tl::unexpected<Error>(read.error());
    }
  }
  if (const Status resolved = resolve_ties(freedom, names); !resolved) {
    return tl::unexpected<Error>(resolved.error());
  }
  make_basis(freedom);
  if (freedom.basis.cols() == 0) {
    return make_error(ErrorCode::kInvalidArgument,
                      "Everything is fixed: there is nothing left to estimate.");
  }
  return freedom;
}

}  // namespace calvin
