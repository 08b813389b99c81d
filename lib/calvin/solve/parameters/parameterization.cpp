// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// Reads `fix` and `initial` into held values, ties and the basis of the directions.

#include "calvin/solve/parameters/parameterization.hpp"

#include <cmath>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "calvin/camera/camera.hpp"
#include "calvin/camera/lens_table.hpp"
#include "calvin/core/image.hpp"
#include "calvin/core/text.hpp"

namespace calvin {

namespace {

// Of coefficients of the lens: that of an unknown; 0 for all that is no coefficient.
double coefficient(const std::vector<double>& coefficients,
                   const Parameterization& parameterization, int unknown) {
  const ParameterRange distortion = parameterization.table.distortion(0);
  const auto i = static_cast<std::size_t>(unknown - distortion.first);
  return distortion.has(unknown) && i < coefficients.size() ? coefficients[i] : 0;
}

// What `calibration` says of an unknown. Coefficients of an unrelated model do not count.
std::optional<double> value_in(const Calibration& calibration,
                               const Parameterization& parameterization, int unknown) {
  const ParameterTable& table = parameterization.table;
  if (table.distortion(0).has(unknown) &&
      !share_coefficients(*find_lens(calibration.model), parameterization.lens)) {
    return std::nullopt;
  }
  const Parameter* p = calibration.find(table.name(unknown));
  return p != nullptr ? std::optional(p->value) : std::nullopt;
}

// All unknowns as `calibration` has them; the coefficients that it does not have, as at a start.
std::vector<double> initial_of(const Calibration& calibration,
                               const Parameterization& parameterization) {
  const ParameterTable& table = parameterization.table;
  const std::vector<double>& start = parameterization.lens.starts.front();
  std::vector<double> values(static_cast<std::size_t>(table.count()), 0);
  for (int i = 0; i < table.camera(0).end(); ++i) {
    values[static_cast<std::size_t>(i)] = value_in(calibration, parameterization, i)
                                              .value_or(coefficient(start, parameterization, i));
  }
  return values;
}

// Reads the words of `fix` one after the other.
class Reader {
 public:
  Reader(Parameterization& parameterization, const std::optional<Calibration>& initial,
         ImageSize size)
      : parameterization_(parameterization),
        table_(parameterization.table),
        initial_(initial),
        center_(image_center(size)) {}

  Status read(std::string_view word) {
    const ParameterRange focal = table_.focal(0);
    if (word == "aspect") {
      return tie(focal[0], focal[1], initial_aspect(), word);
    }
    if (word == "center") {
      for (int i = 0; i < 2; ++i) hold(table_.center(0)[i]);
      return {};
    }
    if (const auto equals = word.find('='); equals != std::string_view::npos) {
      const auto first = table_.find(trim(word.substr(0, equals)));
      const auto number = parse_double(trim(word.substr(equals + 1)));
      if (first && number) return hold_at(*first, *number, word);
      const auto second = table_.find(trim(word.substr(equals + 1)));
      if (!first || !second) return unknown(word);
      return tie(*first, *second, 1, word);
    }
    const auto index = table_.find(word);
    if (!index) return unknown(word);
    if (focal.has(*index) && parameterization_.initial.empty()) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' cannot be fixed at nothing: give a calibration that has "
                                    "its value (initial), or the value, as in {}=800.",
                                    word, word));
    }
    hold(*index);
    return {};
  }

 private:
  // fy / fx to hold.
  [[nodiscard]] double initial_aspect() const {
    if (parameterization_.initial.empty()) return 1;
    const auto focal = values_of(parameterization_.initial, table_.focal(0));
    return focal[1] / focal[0];
  }

  void hold(int unknown) {
    double value = coefficient(parameterization_.lens.neutral, parameterization_, unknown);
    if (unknown == table_.center(0)[0]) value = center_.u;
    if (unknown == table_.center(0)[1]) value = center_.v;
    if (initial_) value = value_in(*initial_, parameterization_, unknown).value_or(value);
    table_.hold(unknown, value);
  }

  Status hold_at(int unknown, double value, std::string_view word) {
    constexpr double kMost = 1e9;  // px, and more than any coefficient
    if (!(std::abs(value) <= kMost)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' cannot be fixed: no camera has such a number; give one "
                                    "of at most {:g}.",
                                    word, kMost));
    }
    if (table_.focal(0).has(unknown) && !(value > 0)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' cannot be fixed: a focal length is positive.", word));
    }
    table_.hold(unknown, value);
    return {};
  }

  Status tie(int with, int parameter, double ratio, std::string_view word) {
    if (with == parameter || table_.tied(parameter)) {
      return make_error(ErrorCode::kInvalidArgument,
                        fmt::format("'{}' ties a parameter that is tied already.", word));
    }
    table_.tie({parameter, with, ratio});
    return {};
  }

  [[nodiscard]] Status unknown(std::string_view word) const {
    std::vector<std::string> names;
    for (int i = 0; i < table_.camera(0).end(); ++i) names.push_back(table_.name(i));
    return make_error(
        ErrorCode::kInvalidArgument,
        fmt::format("'{}' cannot be fixed. What can: aspect, center, {} or all, and two of them "
                    "tied to one value, as in fx=fy, or one to a number, as in fx=800.",
                    word, join(names, ", ")));
  }

  Parameterization& parameterization_;
  ParameterTable& table_;
  const std::optional<Calibration>& initial_;
  Pixel center_;
};

// Whether a calibration of images of this size, 0x0 where it is not known, can be started from; the
// camera that it is.
Result<Camera> initial_camera(const Calibration& initial, ImageSize size) {
  auto camera = Camera::make(initial);
  if (!camera || size.width == 0 || camera->image_size() == size) return camera;
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("The initial calibration is for {}x{} px, the views are of {}x{}: scale it.",
                  camera->image_size().width, camera->image_size().height, size.width,
                  size.height));
}

}  // namespace

int Parameterization::pinhole_directions() const {
  int directions = 0;
  for (Eigen::Index c = 0; c < basis.cols(); ++c) {
    directions += moves(basis, c, table.pinhole(0)) ? 1 : 0;
  }
  // Skew takes one more equation of the boards.
  if (!table.skew(0).empty()) ++directions;
  return directions;
}

double Parameterization::aspect() const {
  const int fx = table.focal(0)[0];
  const int fy = table.focal(0)[1];
  if (table.held(fx) && table.held(fy)) return *table.held(fy) / *table.held(fx);
  for (const ParameterTable::Tie& tie : table.ties()) {
    if (tie.parameter == fy && tie.with == fx) return tie.ratio;
    if (tie.parameter == fx && tie.with == fy) return 1 / tie.ratio;
  }
  return 1;
}

Result<Parameterization> make_parameterization(const SolveOptions& options, ImageSize size,
                                               const BoardUnknowns& board) {
  if (parameter_names(options.model).empty()) {
    return make_error(ErrorCode::kUnsupported,
                      fmt::format("The camera model '{}' is not known to this version. Known "
                                  "models: {}.",
                                  options.model, join(model_names(), ", ")));
  }
  Parameterization parameterization;
  parameterization.model = options.model;
  parameterization.lens = *find_lens(options.model);
  TableCamera camera = {options.model, options.skew};
  camera.has_readout = options.readout.has_value();
  if (options.initial) {
    const auto initial = initial_camera(*options.initial, size);
    if (!initial) return tl::unexpected<Error>(initial.error());
    camera.skew = initial->skew();
  }
  parameterization.table = ParameterTable({std::move(camera)}, {board});
  ParameterTable& table = parameterization.table;
  if (options.readout && options.readout->sigma == 0) {
    table.hold(table.readout(0).first, options.readout->value);
  }
  if (options.initial) parameterization.initial = initial_of(*options.initial, parameterization);
  Reader reader(parameterization, options.initial, size);
  for (const std::string& word : options.fix) {
    if (const Status read = reader.read(trim(word)); !read) {
      return tl::unexpected<Error>(read.error());
    }
  }
  if (const Status resolved = table.resolve_ties(); !resolved) {
    return tl::unexpected<Error>(resolved.error());
  }
  parameterization.basis = table.basis();
  if (parameterization.basis.cols() == 0) {
    return make_error(ErrorCode::kInvalidArgument,
                      "Everything is fixed: there is nothing left to estimate. For the places of "
                      "boards before a known camera fix all, and give initial.");
  }
  return parameterization;
}

Status check_readout(const ReadoutTime& readout) {
  constexpr double kMost = 60;  // s: no frame takes longer
  if (std::abs(readout.value) <= kMost && readout.sigma >= 0 && readout.sigma <= kMost) return {};
  return make_error(
      ErrorCode::kInvalidArgument,
      fmt::format("A readout of {} s with a sigma of {} s is that of no frame: give a time from "
                  "-{} to {} s, and a sigma that is not negative (readout).",
                  readout.value, readout.sigma, kMost, kMost));
}

void start_from(const Calibration& camera, Parameterization& parameterization) {
  parameterization.start = initial_of(camera, parameterization);
}

}  // namespace calvin
