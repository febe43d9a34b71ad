#include "render/app/arguments.h"

namespace render {

std::vector<std::string> with_negative_values(std::vector<std::string> arguments) {
    for (std::string& argument : arguments) {
        const bool fraction =
            argument.size() > 2 && argument[0] == '-' && argument[1] == '.' && argument[2] >= '0' && argument[2] <= '9';
        if (fraction) argument.insert(1, "0");
    }
    return arguments;
}

}  // namespace render
