#pragma once
// A value for every cell: one flat array a level in code order, and no other structure.

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "planet/quadtree/topology.h"

namespace planet {

/// sizeof(T) bytes a cell. Values start out undefined.
template <class T>
class DenseQuadtree {
  public:
    DenseQuadtree() = default;
    /// @param levels bisection levels 0 .. levels - 1
    DenseQuadtree(int root_bits, int root_count, int levels) : root_bits_(root_bits) {
        for (int level = 0; level < levels; ++level) {
            const std::size_t size = static_cast<std::size_t>(root_count) << level;
            arrays_.push_back({std::make_unique_for_overwrite<T[]>(size), size});
        }
    }

    int levels() const { return static_cast<int>(arrays_.size()); }
    /// All cells of a level, ascending codes.
    std::span<T> level(int l) { return {array(l).values.get(), array(l).size}; }
    std::span<const T> level(int l) const { return {array(l).values.get(), array(l).size}; }

    T& operator[](CellCode cell) { return arrays_[level_of(cell)].values[index(cell)]; }
    const T& operator[](CellCode cell) const { return arrays_[level_of(cell)].values[index(cell)]; }
    /// The same where the level is known.
    const T& at(CellCode cell, int l) const { return array(l).values[cell - (CellCode{1} << (root_bits_ + l))]; }

    std::size_t bytes() const {
        std::size_t n = 0;
        for (const Array& a : arrays_) n += a.size * sizeof(T);
        return n;
    }

  private:
    struct Array {
        std::unique_ptr<T[]> values;
        std::size_t size = 0;
    };
    Array& array(int l) { return arrays_[static_cast<std::size_t>(l)]; }
    const Array& array(int l) const { return arrays_[static_cast<std::size_t>(l)]; }
    std::size_t level_of(CellCode cell) const { return static_cast<std::size_t>(bisection_level_of(cell, root_bits_)); }
    static std::size_t index(CellCode cell) {
        return static_cast<std::size_t>(cell ^ std::bit_floor(cell));  // roots are numbered from 0
    }

    int root_bits_ = 0;
    std::vector<Array> arrays_;
};

}  // namespace planet
