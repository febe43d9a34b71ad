#pragma once
// What has to be done to argv before an option parser sees it.

#include <string>
#include <vector>

namespace render {

/// A negative number is a value, not an option. The parser already leaves a minus sign before a digit alone; "-.5,180"
/// becomes "-0.5,180" for the same reason.
std::vector<std::string> with_negative_values(std::vector<std::string> arguments);

}  // namespace render
