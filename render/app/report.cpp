#include "render/app/report.h"

#include <sys/resource.h>

#include "render/app/version.h"

namespace render {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

Report::Report(std::string_view command, const std::string& path) {
    if (!path.empty()) file_ = std::make_unique<OutputFile>("--json", path);
    set("version", version);
    set("command", command);
}

Report::Step::~Step() {
    report_.add_seconds(name_, seconds_since(start_));
}

std::string Report::text() const {
    nlohmann::ordered_json all = values_;
    all["seconds_total"] = seconds_since(start_);
    all["seconds"] = nlohmann::ordered_json::object();
    for (const auto& [step, seconds] : seconds_) all["seconds"][step] = seconds;
    all["peak_memory_bytes"] = peak_memory_bytes();
    return all.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void Report::write() {
    if (file_) file_->commit(text());
    file_.reset();
}

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

}  // namespace render
