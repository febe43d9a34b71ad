#pragma once
// Output storage of the walk: grows in large steps, is never cleared, costs no check per element.

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

namespace planet {

/// An array of trivial elements that keeps its storage from one use to the next. Elements beyond size() are garbage.
template <class T>
class GrowingArray {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    /// Room for `more` elements behind the present ones.
    void reserve_more(std::size_t more) {
        if (size_ + more <= capacity_) return;
        const std::size_t capacity = 2 * (size_ + more);
        // Large blocks are moved page by page, without copying, and pages not written yet take no memory.
        T* const grown = static_cast<T*>(std::realloc(data_.get(), capacity * sizeof(T)));
        if (!grown) throw std::bad_alloc();
        static_cast<void>(data_.release());
        data_.reset(grown);
        capacity_ = capacity;
    }
    /// For so many more there is room.
    std::size_t room() const { return capacity_ - size_; }
    /// Elements that are new are garbage.
    void resize(std::size_t size) {
        if (size > size_) reserve_more(size - size_);
        size_ = size;
    }
    /// Appends; room must have been made.
    void push(const T& value) { data_[size_++] = value; }
    void pop() { --size_; }
    void clear() { size_ = 0; }
    /// For writers that keep a pointer of their own: where the next element goes, and where it has got to.
    T* end() { return data_.get() + size_; }
    void set_end(const T* end) { size_ = static_cast<std::size_t>(end - data_.get()); }

    const T& back() const { return data_[size_ - 1]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    std::size_t size() const { return size_; }
    std::span<const T> span() const { return {data_.get(), size_}; }

  private:
    struct Free {
        void operator()(T* data) const { std::free(data); }
    };
    std::unique_ptr<T[], Free> data_;
    std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace planet
