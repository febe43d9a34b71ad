#pragma once
// Normals per pixel for a moving eye: patches are made beside the drawing, and stay on the GPU while there is room.

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <span>
#include <thread>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "planet/mesh/segments.h"
#include "render/gl/texture.h"
#include "render/picture/relief_patches.h"

namespace render {

class PatchCache {
  public:
    /// @param surface must outlive it @param threads that make patches @param capacity the most patches kept
    PatchCache(PatchSurface surface, double radius_m, unsigned threads, std::size_t capacity);
    ~PatchCache();

    /// Takes in what has been made, at most `most` patches, and asks for what the segments lack. Returns whether layers()
    /// has changed.
    bool update(const planet::Segments& segments, bool segments_changed, std::size_t most);

    /// Waits until update() has something to take in, if anything is being made.
    void wait();

    /// By segment: the layer of its patch, or -1 while there is none.
    std::span<const std::int32_t> layers() const { return layers_; }
    /// Of the last update's segments.
    std::size_t missing() const { return missing_; }
    const Texture& texture() const { return texture_; }

  private:
    using Levels = std::vector<std::vector<std::int16_t>>;
    struct Kept {
        int layer;
        std::uint64_t used;
    };
    struct Made {
        planet::LocationCode code;
        Levels levels;
    };

    void work();
    void take_in(const Made& made);
    int free_layer();
    void grow(int layers);

    PatchSurface surface_;
    double radius_m_;
    int capacity_;
    Texture texture_;
    std::unordered_map<std::uint64_t, Kept> kept_;
    std::vector<int> free_;
    std::vector<std::int32_t> layers_;
    std::size_t missing_ = 0;
    std::uint64_t frame_ = 0;

    std::mutex mutex_;
    std::condition_variable wake_, done_;
    std::vector<planet::LocationCode> wanted_;  // the next one last
    std::unordered_set<std::uint64_t> in_the_making_;
    std::vector<Made> made_;
    bool ending_ = false;
    std::vector<std::jthread> threads_;  // last: they use the above
};

}  // namespace render
