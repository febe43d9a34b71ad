#pragma once
// The machine-readable report of a command: one flat JSON object, SI units in the keys.

#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "render/app/output_file.h"

namespace render {

/// Keys keep the order in which they were first set. Numbers that are not finite become null, bytes that are not UTF-8
/// the replacement character. `version`, `command`, `seconds_total`, `seconds` (an object: step -> seconds) and
/// `peak_memory_bytes` are always there; the clock starts when the report is made.
class Report {
  public:
    /// @param path where write() puts it; empty: nowhere. An unwritable path is refused at once, naming --json.
    Report(std::string_view command, const std::string& path);

    void set(const std::string& key, nlohmann::ordered_json value) { values_[key] = std::move(value); }
    /// Adds to a step's time.
    void add_seconds(const std::string& step, double seconds) { seconds_[step] += seconds; }

    /// Times the step until the returned object goes. Steps may be repeated, and then add up.
    class Step {
      public:
        Step(Report& report, std::string name) : report_(report), name_(std::move(name)) {}
        Step(const Step&) = delete;
        Step& operator=(const Step&) = delete;
        ~Step();

      private:
        Report& report_;
        std::string name_;
        std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    };
    [[nodiscard]] Step step(std::string name) { return {*this, std::move(name)}; }

    /// The report as it stands, ending in a newline.
    std::string text() const;

    /// Writes the file, whole or not at all. Once, at the end of the command, after its other output: a report that
    /// exists tells of output that exists.
    void write();

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    nlohmann::ordered_json values_ = nlohmann::ordered_json::object();
    std::map<std::string, double> seconds_;
    std::unique_ptr<OutputFile> file_;
};

/// The largest resident size of this process so far, bytes.
std::uint64_t peak_memory_bytes();

}  // namespace render
