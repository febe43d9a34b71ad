#include "render/viewer/zoom_pan.h"

#include <algorithm>
#include <cmath>

namespace render {

ZoomPan::ZoomPan(double ground_m, double from_m, double to_m, double rho)
    : ground_m_(ground_m), from_m_(from_m), to_m_(to_m), rho_(rho) {
    const double u = ground_m, w0 = from_m, w1 = to_m, r2 = rho * rho;
    zooms_only_ = r2 * u < 2e-6 * std::min(w0, w1);
    if (zooms_only_) {
        length_ = std::abs(std::log(w1 / w0)) / rho;
        return;
    }
    const double r4u2 = r2 * r2 * u * u;
    const double b0 = (w1 * w1 - w0 * w0 + r4u2) / (2 * w0 * r2 * u),
                 b1 = (w1 * w1 - w0 * w0 - r4u2) / (2 * w1 * r2 * u);
    r0_ = -std::asinh(b0);
    length_ = (-std::asinh(b1) - r0_) / rho;
}

ZoomPan::State ZoomPan::at(double s) const {
    const double w0 = from_m_;
    if (zooms_only_) {
        const double t = length_ > 0 ? s / length_ : 1;
        return {t, w0 * std::pow(to_m_ / w0, t), length_ > 0 ? 1 / length_ : 0, to_m_ < w0 ? -rho_ : rho_};
    }
    const double x = rho_ * s + r0_, u = w0 / (rho_ * rho_) * (std::cosh(r0_) * std::tanh(x) - std::sinh(r0_));
    const double sech = 1 / std::cosh(x);
    return {std::clamp(u / ground_m_, 0.0, 1.0), w0 * std::cosh(r0_) * sech,
            w0 * std::cosh(r0_) * sech * sech / (rho_ * ground_m_), -rho_ * std::tanh(x)};
}

}  // namespace render
