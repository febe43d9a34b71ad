#pragma once
// A priority queue of triangles, each in it at most once, largest key first.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace planet {

class IndexedHeap {
  public:
    struct Key {
        double priority;
        glm::ivec2 sample;  ///< of equal priorities the first in rows comes first
        bool before(const Key& o) const {
            if (priority != o.priority) return priority > o.priority;
            return sample.y != o.sample.y ? sample.y < o.sample.y : sample.x < o.sample.x;
        }
    };

    bool empty() const { return heap_.empty(); }
    std::uint32_t top() const { return heap_.front().element; }
    const Key& top_key() const { return heap_.front().key; }

    void set(std::uint32_t element, const Key& key) {
        if (element >= place_.size()) place_.resize(element + 1, nowhere);
        std::uint32_t at = place_[element];
        if (at == nowhere) {
            at = static_cast<std::uint32_t>(heap_.size());
            heap_.push_back({key, element});
            place_[element] = at;
        }
        heap_[at].key = key;
        sift(at);
    }
    void remove(std::uint32_t element) {
        if (element >= place_.size() || place_[element] == nowhere) return;
        const std::uint32_t at = place_[element];
        place_[element] = nowhere;
        const Entry last = heap_.back();
        heap_.pop_back();
        if (at == heap_.size()) return;
        put(at, last);
        sift(at);
    }
    void clear() {
        heap_.clear();
        place_.clear();
    }

  private:
    struct Entry {
        Key key;
        std::uint32_t element;
    };
    static constexpr std::uint32_t nowhere = 0xffffffffu;

    void put(std::uint32_t at, const Entry& entry) {
        heap_[at] = entry;
        place_[entry.element] = at;
    }
    void sift(std::uint32_t at) {
        const Entry entry = heap_[at];
        while (at > 0 && entry.key.before(heap_[(at - 1) / 2].key)) {
            put(at, heap_[(at - 1) / 2]);
            at = (at - 1) / 2;
        }
        for (;;) {
            std::uint32_t child = 2 * at + 1;
            if (child >= heap_.size()) break;
            if (child + 1 < heap_.size() && heap_[child + 1].key.before(heap_[child].key)) ++child;
            if (!heap_[child].key.before(entry.key)) break;
            put(at, heap_[child]);
            at = child;
        }
        put(at, entry);
    }

    std::vector<Entry> heap_;
    std::vector<std::uint32_t> place_;  ///< by element
};

}  // namespace planet
