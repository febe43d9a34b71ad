#include "planet/tin/border_line.h"

#include <algorithm>
#include <cmath>

namespace planet {

namespace {

// Of the samples between two that are kept: the farthest from the line between them, if beyond the bound.
int farthest(const std::vector<float>& line, int first, int last, const TinBound& bound) {
    const auto height = [&](int i) { return static_cast<double>(line[static_cast<std::size_t>(i)]); };
    const double start = height(first), slope = (height(last) - start) / (last - first);
    int worst = -1;
    double distance = bound.tolerance, sum = 0;
    for (int i = first + 1; i < last; ++i) {
        const double d = std::abs(height(i) - (start + slope * (i - first)));
        if (d > distance) {
            distance = d;
            worst = i;
        }
        if (!std::isnan(d)) sum += bound.metric == TinMetric::rms ? d * d : d;
    }
    const bool small = bound.metric != TinMetric::local && 0.5 * (last - first) * sum <= bound.least_priority;
    return small ? -1 : worst;
}

}  // namespace

std::vector<int> simplified_line(const std::vector<float>& line, const TinBound& bound, std::vector<int> keep) {
    const int n = static_cast<int>(line.size());
    keep.insert(keep.end(), {0, n - 1});
    for (int i = 0; i + 1 < n; ++i)
        if (std::isnan(line[static_cast<std::size_t>(i)]) != std::isnan(line[static_cast<std::size_t>(i) + 1]))
            keep.insert(keep.end(), {i, i + 1});
    std::sort(keep.begin(), keep.end());
    keep.erase(std::unique(keep.begin(), keep.end()), keep.end());
    std::vector<int> kept, ends(keep.rbegin(), keep.rend());
    kept.push_back(ends.back());
    ends.pop_back();
    while (!ends.empty()) {
        const int worst = farthest(line, kept.back(), ends.back(), bound);
        if (worst >= 0) {
            ends.push_back(worst);
        } else {
            kept.push_back(ends.back());
            ends.pop_back();
        }
    }
    return kept;
}

}  // namespace planet
