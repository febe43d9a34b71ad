#pragma once
// A smooth map of the plane, known only by an expensive function (a map projection), as a quadtree of polynomials.

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace planet {

/// Each leaf holds a polynomial of degree 5 in both directions through 6 x 6 Chebyshev nodes. It is accepted if it is
/// within half the tolerance of the function at 9 x 9 other points, its sides and corners among them; a degree-5
/// polynomial of a function that passes stays within the tolerance between them. Else the leaf is split. Leaves that
/// are still not smooth after 8 splits (where a map is cut) keep no polynomial and ask the function itself: the bound
/// holds everywhere, and evaluation takes about 20 ns but for the rim of a cut.
class PatchMap {
  public:
    /// Values at points; NaN where the map has none. Must be safe from several threads.
    using Function = std::function<void(std::span<const glm::dvec2> at, std::span<glm::dvec3> values)>;

    /// @param tolerance largest difference in any component of the value
    PatchMap(glm::dvec2 low, glm::dvec2 high, Function function, double tolerance);

    /// NaN outside [low, high] and where the function has no value.
    glm::dvec3 operator()(glm::dvec2 p) const;

    /// How many leaves hold a polynomial, and how many ask the function.
    struct Size {
        int polynomials = 0, exact = 0;
    };
    Size size() const;

  private:
    static constexpr int order = 6;
    using Patch = std::array<glm::dvec3, order * order>;  // coefficients of x^i y^j at i + 6 j, x and y in [-1, 1]
    static constexpr int asks_function = -1, has_none = -2;
    struct Node {
        int children = 0;  // index of the first of four, 0: a leaf
        int patch = asks_function;
    };

    void build(std::size_t node, glm::dvec2 low, glm::dvec2 high, int depth);
    /// The node's polynomial, or how it does without; false if it should be split.
    bool fit(Node& node, glm::dvec2 low, glm::dvec2 high, int depth);

    glm::dvec2 low_, high_;
    Function function_;
    double tolerance_;
    std::vector<Node> nodes_;
    std::vector<Patch> patches_;
};

}  // namespace planet
