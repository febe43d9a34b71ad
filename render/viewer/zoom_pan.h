#pragma once
// Out, across and in again: of all ways between two views, the one along which the picture flows least. After van Wijk
// and Nuij, "Smooth and efficient zooming and panning" (2003): u is the ground distance, w the range.

namespace render {

class ZoomPan {
  public:
    ZoomPan() = default;
    /// @param ground_m between the places, 0 or more @param from_m, to_m ranges, above 0
    /// @param rho how much zooming is preferred to panning; the paper's users liked sqrt 2, near 0 there is no way out
    ZoomPan(double ground_m, double from_m, double to_m, double rho);

    /// Of the way, in the paper's measure s.
    double length() const { return length_; }

    struct State {
        double part;            ///< of the ground, 0..1
        double range;           ///< m
        double part_rate;       ///< for each unit of the length
        double log_range_rate;  ///< the same for the natural logarithm of the range
    };
    /// @param s 0..length()
    State at(double s) const;

  private:
    double ground_m_ = 0, from_m_ = 1, to_m_ = 1, rho_ = 1;
    double r0_ = 0, length_ = 0;
    bool zooms_only_ = true;
};

}  // namespace render
