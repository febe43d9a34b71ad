#pragma once
// Values that are made when asked for, in a given amount of memory.

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace planet {

/// The least recently used values go first. Safe from several threads: a value is made by the first that asks for it
/// while others go on with other values; those that ask for the same one wait. One lock is enough where a value is asked
/// for once in hundreds of uses: it is held for a look into a table.
/// @tparam Value  has bytes(), the memory it takes, more than 0
template <class Value>
class MemoryCache {
  public:
    /// @param bytes of all values, but for those that somebody still holds; the last one made is kept whatever its size
    explicit MemoryCache(std::size_t bytes) : limit_(bytes) {}

    /// A number for each user, to make keys of.
    std::uint32_t new_user() {
        const std::lock_guard lock(mutex_);
        return users_++;
    }

    /// If `make` throws, the exception is passed on and the value can be asked for again.
    template <class Make>
    std::shared_ptr<const Value> get(std::uint64_t key, Make&& make) {
        const std::shared_ptr<Entry> entry = find_or_add(key);
        const std::lock_guard lock(entry->making);
        if (!entry->value) {
            try {
                entry->value = std::make_shared<const Value>(make());
            } catch (...) {
                forget(key, entry);
                throw;
            }
            account(key, entry);
        }
        return entry->value;
    }

    std::size_t bytes() const {
        const std::lock_guard lock(mutex_);
        return bytes_;
    }
    /// Values made so far.
    std::uint64_t made() const {
        const std::lock_guard lock(mutex_);
        return made_;
    }

  private:
    struct Entry {
        std::mutex making;
        std::shared_ptr<const Value> value;
        std::list<std::uint64_t>::iterator place;
        std::size_t bytes = 0;  // 0 while it is being made
    };

    std::shared_ptr<Entry> find_or_add(std::uint64_t key) {
        const std::lock_guard lock(mutex_);
        std::shared_ptr<Entry>& entry = entries_[key];
        if (entry) {
            order_.splice(order_.begin(), order_, entry->place);
        } else {
            entry = std::make_shared<Entry>();
            entry->place = order_.insert(order_.begin(), key);
        }
        return entry;
    }

    void account(std::uint64_t key, const std::shared_ptr<Entry>& entry) {
        const std::lock_guard lock(mutex_);
        ++made_;
        const auto found = entries_.find(key);
        if (found == entries_.end() || found->second != entry) return;  // forgotten since: whoever asked holds it
        entry->bytes = entry->value->bytes();
        bytes_ += entry->bytes;
        for (auto oldest = order_.end(); bytes_ > limit_ && oldest != order_.begin();) {
            const auto candidate = entries_.find(*--oldest);
            if (candidate->second == entry || candidate->second->bytes == 0) continue;  // in use, or being made
            bytes_ -= candidate->second->bytes;
            entries_.erase(candidate);
            oldest = order_.erase(oldest);
        }
    }

    void forget(std::uint64_t key, const std::shared_ptr<Entry>& entry) {
        const std::lock_guard lock(mutex_);
        const auto found = entries_.find(key);
        if (found == entries_.end() || found->second != entry) return;
        order_.erase(entry->place);
        entries_.erase(found);
    }

    std::size_t limit_;
    mutable std::mutex mutex_;
    std::uint32_t users_ = 0;
    std::unordered_map<std::uint64_t, std::shared_ptr<Entry>> entries_;
    std::list<std::uint64_t> order_;  // most recently used first
    std::size_t bytes_ = 0;
    std::uint64_t made_ = 0;
};

}  // namespace planet
