#pragma once
// Where heights come from: which of a field's source files.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace planet {

/// Files are numbered from 1 through all of a field's sources, in their order (source_files() in elevation_field.h). 0 is
/// no source: the height 0 where nothing answers.
struct HeightOrigin {
    std::uint32_t file = 0;  ///< the one with the greatest weight
    std::uint32_t other =
        0;  ///< of the others with any weight the one with the greatest; the same again: there is none

    bool blended() const { return other != file; }
    friend bool operator==(const HeightOrigin&, const HeightOrigin&) = default;
};

/// An origin while weights still count.
struct WeighedOrigin {
    HeightOrigin origin;
    float weight = 1;  ///< of `file`, 0..1; the rest is `other`'s, but for what others have still
};

/// Origins of heights in a row, small where they are alike.
class OriginPlane {
  public:
    /// Of heights of which it is not known.
    OriginPlane() = default;
    explicit OriginPlane(std::span<const WeighedOrigin> origins);
    /// @param kinds  distinct, at least one
    /// @param kind   by height, below the number of kinds; empty if there is one kind
    OriginPlane(std::vector<HeightOrigin> kinds, std::vector<std::uint16_t> kind)
        : kinds_(std::move(kinds)), kind_(std::move(kind)) {}

    bool known() const { return !kinds_.empty(); }
    /// Of a plane that is known.
    HeightOrigin operator[](std::size_t i) const { return kinds_[kind_.empty() ? 0 : kind_[i]]; }

    /// In the order in which heights first have them.
    std::span<const HeightOrigin> kinds() const { return kinds_; }
    /// By height; empty if there is one kind.
    std::span<const std::uint16_t> kind() const { return kind_; }
    std::size_t bytes() const { return kinds_.capacity() * sizeof kinds_[0] + kind_.capacity() * sizeof kind_[0]; }

  private:
    std::vector<HeightOrigin> kinds_;
    std::vector<std::uint16_t> kind_;
};

}  // namespace planet
