#pragma once
// How a temporary file comes to be.

#include <filesystem>
#include <functional>
#include <memory>

namespace planet {

/// Calls `make`, which makes a file of that name, and returns what is to be kept until the file is whole or gone. So a
/// program can see to it that a signal leaves nothing half-written behind. An empty one: the file is just made.
using MakeFile =
    std::function<std::shared_ptr<void>(const std::filesystem::path& name, const std::function<void()>& make)>;

}  // namespace planet
