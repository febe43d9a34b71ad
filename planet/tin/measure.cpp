#include "planet/tin/measure.h"

namespace planet {

namespace {

using Index = Delaunay::Index;

class LocalMeasure : public TinMeasure {
  public:
    explicit LocalMeasure(const HeightGrid& grid) : grid_(grid) {}
    void measure(const Delaunay& mesh, std::span<const Index> triangles, std::span<Measured> out) override {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const auto worst = worst_sample<double>(grid_, sorted_triangle(mesh, grid_, triangles[i]));
            out[i] = {worst.deviation, worst.deviation, worst.sample};
        }
    }

  private:
    const HeightGrid& grid_;
};

// Sums over a triangle's samples. Those on its sides count in both triangles.
class SummedMeasure : public TinMeasure {
  public:
    SummedMeasure(const HeightGrid& grid, bool squared) : grid_(grid), squared_(squared) {}
    void measure(const Delaunay& mesh, std::span<const Index> triangles, std::span<Measured> out) override {
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            const SortedTriangle t = sorted_triangle(mesh, grid_, triangles[i]);
            const auto worst = worst_sample<double>(grid_, t);
            out[i] = {worst.sample.x < 0 ? 0 : priority(t), worst.deviation, worst.sample};
        }
    }

    bool adds_up() const override { return true; }
    double priority(const SortedTriangle& t) const override {
        using namespace scan;
        const ScaledDistances<double> distances(grid_, t);
        Values<double> total{};
        for_each_span(t, [&](int y, int first, int last) {
            for (int x = first; x <= last; x += lanes) {
                Values<double> d;
                distances.at(x, y, d);
                d /= distances.area();
                const Places<double> counts = (count_up<double> <= last - x) & (d >= 0);  // no void is >= 0
                total += counts ? (squared_ ? d * d : d) : Values<double>{};
            }
            return true;
        });
        double out = 0;
        for (int i = 0; i < lanes; ++i) out += total[i];
        return out;
    }

  private:
    const HeightGrid& grid_;
    const bool squared_;
};

class InnerMeasure : public TinMeasure {
  public:
    InnerMeasure(TinMetric metric, const HeightGrid& grid) : grid_(grid), measure_(make_measure(metric, grid)) {}

    void measure(const Delaunay& mesh, std::span<const Index> triangles, std::span<Measured> out) override {
        measure_->measure(mesh, triangles, out);
        for (std::size_t i = 0; i < triangles.size(); ++i)
            if (on_border(out[i].sample)) propose_inner(sorted_triangle(mesh, grid_, triangles[i]), out[i]);
    }
    bool adds_up() const override { return measure_->adds_up(); }
    double priority(const SortedTriangle& t) const override { return measure_->priority(t); }

  private:
    bool on_border(glm::ivec2 p) const {
        return p.x == 0 || p.y == 0 || p.x == grid_.width() - 1 || p.y == grid_.height() - 1;
    }
    void propose_inner(const SortedTriangle& t, Measured& out) const {
        out.deviation = 0;
        out.sample = glm::ivec2(-1);
        const scan::ScaledDistances<double> distances(grid_, t);
        for_each_span(t, [&](int y, int first, int last) {
            for (int x = first; x <= last; ++x) {
                const double d = distances.one(x, y);  // NaN where void
                if (on_border({x, y}) || !(d > out.deviation)) continue;
                out.deviation = d;
                out.sample = {x, y};
            }
            return true;
        });
    }

    const HeightGrid& grid_;
    const std::unique_ptr<TinMeasure> measure_;
};

}  // namespace

std::unique_ptr<TinMeasure> make_inner_measure(TinMetric metric, const HeightGrid& grid) {
    return std::make_unique<InnerMeasure>(metric, grid);
}

std::unique_ptr<TinMeasure> make_measure(TinMetric metric, const HeightGrid& grid) {
    if (metric == TinMetric::local) return std::make_unique<LocalMeasure>(grid);
    return std::make_unique<SummedMeasure>(grid, metric == TinMetric::rms);
}

}  // namespace planet
