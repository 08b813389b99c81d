// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads `fix` and `initial` into held values, ties and the basis of the directions.

#include "calvin/solve/residuals/parameterization.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

constexpr std::string_view kSkew = "skew";

using Names = std::vector<std::string_view>;

// The parameters of a model with that lens as `calibration` has them; coefficients that it does not
// have are those that a solve starts from.
std::vector<double> values_of(const Calibration& calibration, const Names& names,
                              const LensTraits& lens) {
  const bool related = share_coefficients(*find_lens(calibration.model), lens);
  const std::vector<double>& start = lens.starts.front();
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
  Reader(Parameterization& parameterization, const Names& names, ImageSize size)
      : parameterization_(parameterization), names_(names), center_(image_center(size)) {}

  Status read(std::string_view word) {
    if (word == "aspect") {
      const auto& initial = parameterization_.initial;
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
    if (*index < 2 && parameterization_.initial.empty()) {
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
    if (index >= 4 && index - 4 < parameterization_.lens.starts.front().size()) {
      value = parameterization_.lens.starts.front()[index - 4];
    }
    if (index == 2) value = center_.u;
    if (index == 3) value = center_.v;
    if (!parameterization_.initial.empty()) value = parameterization_.initial[index];
    parameterization_.held[index] = value;
  }

  Status tie(std::size_t with, std::size_t parameter, double ratio, std::string_view word) {
    const auto taken = [&](const Parameterization::Tie& t) { return t.parameter == parameter; };
    const bool twice =
        std::any_of(parameterization_.ties.begin(), parameterization_.ties.end(), taken);
    if (with == parameter || twice) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' ties a parameter that is tied already.", word));
    }
    parameterization_.ties.push_back({parameter, with, ratio});
    return {};
  }

  Status unknown(std::string_view word) const {
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("'{}' cannot be fixed. What can: aspect, center, {}, and two of them tied to "
                    "one value, as in fx=fy.",
                    word, join(names_, ", ")));
  }

  Parameterization& parameterization_;
  const Names& names_;
  Pixel center_;
};

// A parameter that is tied to a held one is held too; a chain of ties ends at a free parameter.
Status resolve_ties(Parameterization& parameterization, const Names& names) {
  for (bool changed = true; changed;) {
    changed = false;
    for (Parameterization::Tie& tie : parameterization.ties) {
      const auto& target = parameterization.held[tie.with];
      if (parameterization.held[tie.parameter] && !target) {
        return make_error(ErrorCode::kInvalidArgument,
                          fmt::format("'{}' cannot be both fixed and tied to '{}'.",
                                      names[tie.parameter], names[tie.with]));
      }
      if (target && !parameterization.held[tie.parameter]) {
        parameterization.held[tie.parameter] = tie.ratio * *target;
        changed = true;
      }
      for (const Parameterization::Tie& other : parameterization.ties) {
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

void make_basis(Parameterization& parameterization) {
  const std::size_t count = parameterization.held.size();
  parameterization.estimated.assign(count, false);
  std::vector<Eigen::Index> column(count, -1);
  Eigen::Index columns = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto tied = [i](const Parameterization::Tie& t) { return t.parameter == i; };
    parameterization.estimated[i] = !parameterization.held[i].has_value();
    const bool own = std::none_of(parameterization.ties.begin(), parameterization.ties.end(), tied);
    if (parameterization.estimated[i] && own) column[i] = columns++;
  }
  parameterization.basis = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), columns);
  for (std::size_t i = 0; i < count; ++i) {
    if (column[i] >= 0) parameterization.basis(static_cast<Eigen::Index>(i), column[i]) = 1;
  }
  for (const Parameterization::Tie& tie : parameterization.ties) {
    if (!parameterization.estimated[tie.parameter]) continue;
    parameterization.basis(static_cast<Eigen::Index>(tie.parameter), column[tie.with]) = tie.ratio;
  }
}

}  // namespace

RowPoint Parameterization::row_point(const std::vector<double>& shared) const {
  return calvin::row_point(layout, shared.data(), skew);
}

int Parameterization::pinhole_directions() const {
  int directions = 0;
  for (Eigen::Index c = 0; c < basis.cols(); ++c) directions += basis.col(c).head(4).any() ? 1 : 0;
  // Skew takes one more equation of the boards.
  if (layout.skew) ++directions;
  return directions;
}

void Parameterization::hold(double* parameters) const {
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

double Parameterization::aspect() const {
  if (held[0] && held[1]) return *held[1] / *held[0];
  for (const Tie& tie : ties) {
    if (tie.parameter == 1 && tie.with == 0) return tie.ratio;
    if (tie.parameter == 0 && tie.with == 1) return 1 / tie.ratio;
  }
  return 1;
}

Result<Parameterization> make_parameterization(const SolveOptions& options, ImageSize size,
                                               int modes) {
  Names names = parameter_names(options.model);
  if (names.empty()) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The camera model '{}' is not known to this version. Known "
                                  "models: {}.",
                                  options.model, join(model_names(), ", ")));
  }
  Parameterization parameterization;
  parameterization.model = options.model;
  parameterization.lens = *find_lens(options.model);
  parameterization.layout = {static_cast<int>(names.size()) - 4, options.skew, modes};
  if (options.skew) names.push_back(kSkew);
  parameterization.held.resize(static_cast<std::size_t>(parameterization.layout.shared()));
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
    parameterization.initial = values_of(*options.initial, names, parameterization.lens);
    parameterization.initial.resize(parameterization.held.size(), 0);
    if (!options.skew) parameterization.skew = camera->skew();
  }
  Reader reader(parameterization, names, size);
  for (const std::string& word : options.fix) {
    if (const Status read = reader.read(trim(word)); !read) {
      return tl::unexpected<Error>(read.error());
    }
  }
  if (const Status resolved = resolve_ties(parameterization, names); !resolved) {
    return tl::unexpected<Error>(resolved.error());
  }
  make_basis(parameterization);
  if (parameterization.basis.cols() == 0) {
    return make_error(ErrorCode::kInvalidArgument,
                      "Everything is fixed: there is nothing left to estimate.");
  }
  return parameterization;
}

}  // namespace calvin
