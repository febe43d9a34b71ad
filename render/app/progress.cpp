#include "render/app/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace render {

Progress::Progress() : terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    clear();
}

void Progress::clear() {
    const std::lock_guard lock(mutex_);
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
}

void Progress::update(std::string_view step, double fraction) {
    if (!terminal_) return;
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (shown_ && now - last_ < std::chrono::milliseconds(50)) return;
    last_ = now;
    shown_ = true;
    if (step != step_) {
        step_ = step;
        left_ = {};
    }
    std::string line = step_;
    if (std::isnan(fraction)) {
        line += " ...";
    } else {
        const double done = std::clamp(fraction, 0.0, 1.0);
        line += " " + std::to_string(static_cast<int>(100 * done)) + " %";
        const auto left = left_.update(std::chrono::duration<double>(now - start_).count(), done);
        if (left) line += ", " + duration_text(*left) + " left";
    }
    std::fprintf(stderr, "\r\033[K%s", line.c_str());
    std::fflush(stderr);
}

}  // namespace render
