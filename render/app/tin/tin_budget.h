#pragma once
// The tolerance for a budget of triangles, where nothing tells it but trying.

#include <cstddef>
#include <functional>

namespace render {

struct BudgetFit {
    double tolerance = 0;       ///< metres
    std::size_t triangles = 0;  ///< that it gives: within the budget, unless no tolerance does
    int trials = 0;
};

/// Looks for the tolerance whose triangles are nearest to a budget and not above it, until there is less than a hundredth
/// left of it or after twelve trials.
/// @param triangles of a tolerance, metres: the larger this, the fewer, by and large; the same whenever asked
/// @param least, most metres: from 0 to what no budget that can be kept needs
BudgetFit fit_to_budget(const std::function<std::size_t(double)>& triangles, std::size_t budget, double least,
                        double most);

}  // namespace render
