#include "render/app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace render {

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::update(std::string_view step, double fraction) {
    if (!terminal_) return;
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && now - last_ < std::chrono::milliseconds(50)) return;
    last_ = now;
    shown_ = true;
    const int length = static_cast<int>(step.size());
    if (std::isnan(fraction))
        std::fprintf(stderr, "\r\033[K%.*s ...", length, step.data());
    else
        std::fprintf(stderr, "\r\033[K%.*s %3.0f %%", length, step.data(), 100 * std::clamp(fraction, 0.0, 1.0));
    std::fflush(stderr);
}

}  // namespace render
