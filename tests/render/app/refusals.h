#pragma once
// What a command refuses: one line that says what, where and what would be accepted, the right exit status, and nothing
// left behind.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "tests/render/app/program_process.h"

namespace render {

struct Refusal {
    const char* arguments;
    int status;
    const char* line;      ///< what the line begins with, after "octaglobe: "
    const char* accepted;  ///< what it says would be accepted, or a part of that
};
inline void PrintTo(const Refusal& refusal, std::ostream* out) {
    *out << refusal.arguments;
}

/// octaglobe COMMAND ARGUMENTS in a folder with all that they name. @param prepare as of Process
inline void expect_one_line_and_no_file(const ScratchFolder& folder, const std::string& command, const Refusal& refusal,
                                        const std::function<void()>& prepare = {}) {
    const auto before = folder.names();
    const Outcome outcome = run(folder.path(), words(command + " " + refusal.arguments), prepare);
    EXPECT_EQ(outcome.status, refusal.status);
    EXPECT_TRUE(outcome.err.starts_with("octaglobe: " + std::string(refusal.line))) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    const auto accepted = outcome.err.find("; accepted: ");
    ASSERT_NE(accepted, std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find(refusal.accepted, accepted), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(folder.names(), before);
}

}  // namespace render
