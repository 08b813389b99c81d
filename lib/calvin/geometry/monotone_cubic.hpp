// SPDX-License-Identifier: LGPL-2.1-or-later
// SPDX-FileCopyrightText: 2026 The gst-calvin authors

// A smooth curve through points that turns back nowhere where the points do not.
#pragma once

#include <span>
#include <vector>

namespace calvin {

// The weights, of sum 1, by which the values at `nodes` (ascending, one or more) make the value at
// `x`: a piecewise cubic through all values with a continuous slope. The slope at a node is a mix
// of those of the straight lines to its neighbours, as the parabola through the three has it; where
// that would make the curve of `guides`, the values of one quantity, rise above or fall below its
// neighbours, as the weighted harmonic mean has it (F. Fritsch, J. Butland, SIAM J. Sci. Stat.
// Comput. 5(2), 1984). All quantities that hang together are to be made with one set of weights:
// errors of theirs that make up for each other at the nodes then do so in between, too.
// Beyond the ends the value is that of the end.
[[nodiscard]] std::vector<double> monotone_cubic_weights(std::span<const double> nodes,
                                                         std::span<const double> guides, double x);

}  // namespace calvin
