#include "render/app/tin/tin_budget.h"

#include <algorithm>
#include <cmath>

namespace render {
namespace {

constexpr int most_trials = 12;
constexpr double first_guess = 20;        ///< m
constexpr double usual_exponent = 1.3;    ///< triangles fall with this power of the tolerance, on most terrain
constexpr double next_to_nothing = 1e-3;  ///< m

class BudgetSearch {
  public:
    BudgetSearch(const std::function<std::size_t(double)>& triangles, std::size_t budget)
        : triangles_(triangles), budget_(budget) {}

    BudgetFit run(double least, double most) {
        above_ = {least, 0};
        below_ = {most, try_out(most)};
        if (below_.triangles > budget_) return {most, below_.triangles, trials_};
        for (double next = std::clamp(first_guess, least, most); !near_enough() && trials_ < most_trials;) {
            const Trial trial{next, try_out(next)};
            (trial.triangles > budget_ ? above_ : below_) = trial;
            if (trial.tolerance <= least && trial.triangles <= budget_) break;
            next = following(trial, least);
        }
        return {below_.tolerance, below_.triangles, trials_};
    }

  private:
    struct Trial {
        double tolerance;
        std::size_t triangles;
    };

    std::size_t try_out(double tolerance) {
        ++trials_;
        return triangles_(tolerance);
    }
    bool near_enough() const { return 100 * below_.triangles >= 99 * budget_; }

    /// Aims a little below the budget, along the power that the last two trials suggest.
    double following(const Trial& trial, double least) {
        const auto count = [](std::size_t n) { return static_cast<double>(std::max<std::size_t>(n, 1)); };
        if (last_.triangles > 0 && last_.tolerance != trial.tolerance) {
            const double exponent =
                std::log(count(last_.triangles) / count(trial.triangles)) / std::log(trial.tolerance / last_.tolerance);
            if (exponent > 0.3 && exponent < 4) exponent_ = exponent;
        }
        last_ = trial;
        const double aim = 0.996 * static_cast<double>(budget_);
        const double next = trial.tolerance * std::pow(count(trial.triangles) / aim, 1 / exponent_);
        if (above_.triangles == 0 && next < std::max(least, next_to_nothing)) return least;
        if (next > above_.tolerance && next < below_.tolerance) return next;
        return above_.tolerance > 0 ? std::sqrt(above_.tolerance * below_.tolerance) : below_.tolerance / 4;
    }

    const std::function<std::size_t(double)>& triangles_;
    const std::size_t budget_;
    int trials_ = 0;
    double exponent_ = usual_exponent;
    Trial above_{}, below_{};  ///< the budget, as near as is known
    Trial last_{};
};

}  // namespace

BudgetFit fit_to_budget(const std::function<std::size_t(double)>& triangles, std::size_t budget, double least,
                        double most) {
    return BudgetSearch(triangles, budget).run(least, most);
}

}  // namespace render
