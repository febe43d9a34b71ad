#pragma once
// Runs a command as a user does, and reads its report and its meshes.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "planet/exporters/mesh_file.h"
#include "tests/render/app/program_process.h"

namespace render {

using Json = nlohmann::json;

class CommandTest : public testing::Test {
  protected:
    /// octaglobe COMMAND, which succeeds without a word on standard error; its report.
    Json report_of(const std::string& command) {
        outcome_ = run(folder_.path(), words(command + " --json report.json"));
        EXPECT_EQ(outcome_.status, 0) << command << ": " << outcome_.err;
        EXPECT_EQ(outcome_.err, "");
        if (outcome_.status != 0) return {};
        return Json::parse(content(folder_ / "report.json"));
    }
    planet::SurfaceMesh read(const std::string& name, planet::MeshReference* reference = nullptr) const {
        return planet::read_mesh((folder_.path() / name).string(), reference);
    }

    const ScratchFolder folder_;
    Outcome outcome_;
};

inline double number(const Json& report, const char* key) {
    return report.at(key).get<double>();
}

}  // namespace render
