#pragma once
// The file that `octaglobe bake` writes: what is there now, and whether it may be touched.

#include <filesystem>

namespace render {

enum class BakeTarget {
    absent,      ///< no file
    unfinished,  ///< a store whose bake did not come to its end
    finished,    ///< a whole store
    replaced,    ///< a store, sound or not, that --replace gives up
};

/// A store is hours of work, so it is never overwritten unasked: a finished one is refused without --replace (or
/// --resume, which leaves it), an unfinished one without either. What is no store is refused always.
/// Throws planet::Error: bad_usage for a name that cannot be written or must not, bad_data for a store that --resume
/// finds damaged.
BakeTarget check_bake_target(const std::filesystem::path& output, bool resume, bool replace);

}  // namespace render
