// Lines of sight against a slow reference that knows nothing of cells, and viewsheds against lines of sight.

#include <gtest/gtest.h>

#include <cmath>

#include "ground_stores.h"
#include "planet/error.h"
#include "planet/terrain/viewshed.h"

namespace planet {
namespace {

using testing::hills;
using testing::level_sea;
using testing::normal_of;
using testing::place;

/// The least height of a line over the ground, by steps along it: an arc of curvature k / R in earth-centred coordinates,
/// and at each step the ground below by its geodetic normal. The ends are left out.
class SlowSight {
  public:
    SlowSight(const StoreField& field, const Geodetic& from, const Geodetic& to, const SightOptions& o)
        : cursor_(field.cursor()) {
        const glm::dvec3 n = normal_of(from), m = normal_of(to);
        eye_ = ecef_from_normal(wgs84, n, {ground_at(cursor_, n).h().m + o.eye_height});
        target_ = ecef_from_normal(wgs84, m, {ground_at(cursor_, m).h().m + o.target_height});
        const glm::dvec3 chord = target_ - eye_;
        lift_ = o.refraction * glm::dot(chord, chord) / (2 * curvature_radii(wgs84, n).mean());
    }

    double clearance(double s) {
        const glm::dvec3 on_chord = eye_ + s * (target_ - eye_);
        const glm::dvec3 up = position_from_ecef(wgs84, on_chord).normal;
        const NormalPosition p = position_from_ecef(wgs84, on_chord + s * (1 - s) * lift_ * up);
        return p.h.m - ground_at(cursor_, p.normal).h().m;
    }

    /// Steps of 1 / 1500, and finer ones where the least may be.
    double least() {
        constexpr int count = 1500, fine = 40;
        std::vector<double> at(count + 1);
        double least = 1e9;
        for (int i = 1; i < count; ++i)
            least = std::min(least, at[static_cast<std::size_t>(i)] = clearance(i / double(count)));
        for (int i = 1; i < count; ++i) {
            if (at[static_cast<std::size_t>(i)] > least + 25) continue;
            for (int k = -fine; k <= fine; ++k) {
                const double s = (i + k / double(fine)) / count;
                if (s > 0.3 / count && s < 1 - 0.3 / count) least = std::min(least, clearance(s));
            }
        }
        return least;
    }

  private:
    SurfaceCursor cursor_;
    glm::dvec3 eye_, target_;
    double lift_;
};

TEST(Sight, AgreesWithTheSlowReference) {
    testing::PlacesInHills places;
    int visible = 0, hidden = 0;
    for (int i = 0; i < 90; ++i) {
        SightOptions o;
        o.eye_height = 5 + 300 * places.unit();
        o.target_height = 5 + 300 * places.unit();
        o.refraction = i % 3 == 0 ? 0 : i % 3 == 1 ? 0.13 : 0.3;
        const Geodetic from = places.next(), to = places.next();
        const Sight sight = line_of_sight(hills(), from, to, o);
        const double least = SlowSight(hills(), from, to, o).least();
        if (std::abs(least) < 0.1) continue;
        ASSERT_EQ(sight.visible, least > 0) << i << ": " << least << ", " << sight.clearance;
        // The steepest obstruction need not be the deepest, but nothing is deeper in the ground than the least.
        if (!sight.visible) {
            ASSERT_GT(sight.clearance, least - 0.1) << i;
            ASSERT_LT(sight.clearance, 0) << i;
        }
        ++(sight.visible ? visible : hidden);
    }
    EXPECT_GT(visible, 10);
    EXPECT_GT(hidden, 15);
}

// The rise that is needed is the rise that helps.
TEST(Sight, RiseNeededIsEnoughAndNoMore) {
    testing::PlacesInHills places(9);
    int tried = 0;
    for (int i = 0; i < 60; ++i) {
        SightOptions o;
        o.target_height = 1;
        const Geodetic from = places.next(), to = places.next();
        const Sight sight = line_of_sight(hills(), from, to, o);
        if (sight.visible || sight.rise_needed > 10000) continue;
        ++tried;
        // Up at the target leans away from up at the eye: by less than 1 % over 60 km.
        o.target_height = 1 + sight.rise_needed * 1.02 + 0.01;
        ASSERT_TRUE(line_of_sight(hills(), from, to, o).visible) << i;
        o.target_height = 1 + sight.rise_needed * 0.98 - 0.01;
        ASSERT_FALSE(line_of_sight(hills(), from, to, o).visible) << i;
    }
    EXPECT_GT(tried, 15);
}

// A sphere's horizon: sqrt(2 R h) each, R / (1 - k) for bent light; along the meridian and across it.
TEST(Sight, HorizonOfALevelSea) {
    const Geodesics lines;
    for (const double k : {0.0, 0.13}) {
        for (const double azimuth : {0.0, 90.0, 217.0}) {
            const Geodetic eye = place(37, -40);
            const double R = curvature_radii(wgs84, normal_of(eye)).at_azimuth(azimuth * degrees);
            const double effective = 1 / (1 / R - k / curvature_radii(wgs84, normal_of(eye)).mean());
            for (const double target : {0.0, 50.0}) {
                SightOptions o;
                o.eye_height = 12;
                o.target_height = target;
                o.refraction = k;
                const double reach = std::sqrt(2 * effective * 12) + std::sqrt(2 * effective * target);
                for (const double factor : {0.5, 0.99, 1.01, 1.5}) {
                    const GeodesicPoint p = lines.direct(eye, azimuth * degrees, reach * factor);
                    const Sight s = line_of_sight(level_sea(), eye, {p.latitude, p.longitude, {}}, o);
                    EXPECT_EQ(s.visible, factor < 1) << k << " " << azimuth << " " << target << " " << factor;
                    // Without a source there is no bound to be within.
                    EXPECT_EQ(s.certain, factor < 1 ? Visibility::visible : Visibility::hidden);
                    if (factor == 1.5) {
                        EXPECT_NEAR(s.obstruction_distance, std::sqrt(2 * effective * 12), 0.01 * reach);
                    }
                }
            }
        }
    }
}

TEST(Sight, CertaintyFollowsTheBound) {
    testing::PlacesInHills places(3);
    int undecided = 0, decided = 0;
    for (int i = 0; i < 60; ++i) {
        SightOptions o;
        o.eye_height = o.target_height = i % 2 == 0 ? 2 : 3000;
        const Geodetic from = places.next();
        const Geodetic to = i % 2 == 0 ? Geodetic{from.latitude + 5e-5, from.longitude, {}} : places.next();
        const Sight s = line_of_sight(hills(), from, to, o);
        if (s.certain == Visibility::undecided) {
            ++undecided;
            continue;
        }
        ++decided;
        EXPECT_EQ(s.visible, s.certain == Visibility::visible);
        EXPECT_EQ(s.visible, s.clearance >= 0);
    }
    EXPECT_GT(undecided, 5);  // an eye 2 m above ground that is known to more than that
    EXPECT_GT(decided, 20);
}

TEST(Sight, IsTheSameBothWays) {
    testing::PlacesInHills places(17);
    int compared = 0;
    for (int i = 0; i < 80; ++i) {
        SightOptions there;
        there.eye_height = 10;
        there.target_height = 40;
        SightOptions back = there;
        std::swap(back.eye_height, back.target_height);
        const Geodetic a = places.next(), b = places.next();
        const Sight s = line_of_sight(hills(), a, b, there), r = line_of_sight(hills(), b, a, back);
        if (std::abs(s.clearance) < 0.2) continue;
        ++compared;
        EXPECT_EQ(s.visible, r.visible) << i << " " << s.clearance << " " << r.clearance;
        EXPECT_NEAR(s.distance, r.distance, 1e-6);
    }
    EXPECT_GT(compared, 50);
}

TEST(Sight, SeamsAndShortLines) {
    SightOptions o;
    o.target_height = 2;
    for (const auto& [a, b] :
         {std::pair{place(90, 0), place(89.99, 50)}, std::pair{place(-89.99, 10), place(-89.99, -170)},
          std::pair{place(0.01, 179.99), place(-0.01, -179.99)}, std::pair{place(0, 89.99), place(0, 90.01)}}) {
        const Sight s = line_of_sight(level_sea(), a, b, o);
        EXPECT_TRUE(s.visible);
        EXPECT_GT(s.cells, 1u);
    }
    const Sight same = line_of_sight(hills(), testing::hills_middle, testing::hills_middle, o);
    EXPECT_TRUE(same.visible);
    EXPECT_NEAR(same.distance, 0, 1e-6);
}

TEST(Sight, RefusesWhatIsOutOfRange) {
    const Geodetic a = place(46, 8), b = place(46.1, 8);
    SightOptions o;
    EXPECT_THROW(line_of_sight(level_sea(), a, place(-46, -172), o), Error);
    EXPECT_THROW(line_of_sight(level_sea(), a, place(NAN, 0), o), Error);
    for (double SightOptions::*member :
         {&SightOptions::eye_height, &SightOptions::target_height, &SightOptions::refraction})
        for (const double value : {-5.0, 1e6, double(NAN)}) {
            SightOptions bad;
            bad.*member = value;
            EXPECT_THROW(line_of_sight(level_sea(), a, b, bad), Error) << value;
        }
}

// Every cell, by a line of sight of its own.
TEST(Viewshed, IsALineOfSightToEachCell) {
    const Geodesics lines;
    testing::PlacesInHills places(23);
    for (const double target_height : {0.0, 25.0}) {
        const Geodetic eye = places.next(20000);
        ViewshedOptions o;
        o.radius = 9000;
        o.cell = 450;
        o.target_height = target_height;
        const Viewshed view = viewshed(hills(), eye, o);
        ASSERT_EQ(view.side, 41);
        std::size_t seen = 0, different = 0, near = 0;
        for (int row = 0; row < view.side; ++row)
            for (int column = 0; column < view.side; ++column) {
                const glm::dvec2 p = view.middle(column, row);
                if (glm::length(p) > o.radius) {
                    ASSERT_EQ(view.at(column, row), Viewshed::outside);
                    continue;
                }
                const GeodesicPoint to = lines.direct(eye, std::atan2(p.x, p.y), glm::length(p));
                const Sight s = line_of_sight(hills(), eye, {to.latitude, to.longitude, {}}, o);
                seen += s.visible;
                // Floats of the viewshed: a few mm.
                const bool touch = s.visible ? s.clearance < 0.02 : s.rise_needed < 0.02;
                if (s.visible != (view.at(column, row) == Viewshed::visible)) ++(touch ? near : different);
            }
        EXPECT_EQ(different, 0u);
        EXPECT_LE(near, 3u);
        EXPECT_GT(view.visible_count, 50u);
        EXPECT_LT(view.visible_count, view.count - 50);
        EXPECT_NEAR(static_cast<double>(seen), static_cast<double>(view.visible_count), static_cast<double>(near));
    }
}

TEST(Viewshed, OfALevelSeaIsTheDiscOfTheHorizon) {
    for (const Geodetic& eye : {place(20, 30), place(90, 0), place(-5, 180)}) {
        ViewshedOptions o;
        o.eye_height = 30;
        o.refraction = 0;
        o.radius = 30000;
        o.cell = 300;
        const Viewshed view = viewshed(level_sea(), eye, o);
        const CurvatureRadii radii = curvature_radii(wgs84, normal_of(eye));
        for (int row = 0; row < view.side; ++row)
            for (int column = 0; column < view.side; ++column) {
                const glm::dvec2 p = view.middle(column, row);
                const double d = glm::length(p);
                if (d > o.radius) continue;
                const double horizon = std::sqrt(2 * radii.at_azimuth(std::atan2(p.x, p.y)) * 30);
                if (std::abs(d / horizon - 1) < 1e-2) continue;
                ASSERT_EQ(view.at(column, row), d < horizon ? Viewshed::visible : Viewshed::hidden)
                    << d << " " << horizon;
            }
        EXPECT_NEAR(view.visible_area / (std::numbers::pi * 60 * radii.mean()), 1, 0.02);
        EXPECT_EQ(view.bound, 0);
    }
}

TEST(Viewshed, DoesNotDependOnThreads) {
    ViewshedOptions o;
    o.radius = 8000;
    o.cell = 200;
    o.threads = 1;
    const Viewshed one = viewshed(hills(), testing::hills_middle, o);
    o.threads = 3;
    const Viewshed three = viewshed(hills(), testing::hills_middle, o);
    EXPECT_EQ(one.cells, three.cells);
    EXPECT_EQ(one.visible_area, three.visible_area);
}

TEST(Viewshed, RefusesWhatIsOutOfRange) {
    ViewshedOptions o;
    for (const double radius : {0.0, 5.0, 6e5, double(NAN)}) {
        o.radius = radius;
        EXPECT_THROW(viewshed(level_sea(), place(0, 0), o), Error) << radius;
    }
    o.radius = 500000;
    o.cell = 10;
    EXPECT_THROW(viewshed(level_sea(), place(0, 0), o), Error);
}

}  // namespace
}  // namespace planet
