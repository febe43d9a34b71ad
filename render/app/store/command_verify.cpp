// octaglobe verify: everything that reading a file relies on.

#include <iostream>
#include <memory>

#include "planet/error.h"
#include "planet/store/elevation_store.h"
#include "render/app/figures.h"
#include "render/app/program.h"
#include "render/app/progress.h"
#include "render/app/report.h"
#include "render/app/values.h"

namespace render {
namespace {

using planet::Error;
using planet::Fault;

struct Options {
    std::filesystem::path file;
    std::string json;
};

void verify(const Options& options) {
    Report report("verify", options.json);
    const auto store = planet::ElevationStore::open(options.file);
    const planet::StoreCheck found = [&] {
        Progress progress;
        const auto step = report.step("verify");
        return store.verify([&](double fraction) { progress.update("verify", fraction); });
    }();
    for (const auto& line : found.first_problems) std::cout << line << '\n';
    const bool complete = store.metadata().complete;
    if (found.ok())
        std::cout << options.file.native() << ": " << grouped(found.tiles) << " tiles, " << grouped(found.vertices)
                  << " vertices, " << grouped(found.side_records) << " shared sides: sound"
                  << (complete ? "" : "; not complete, --resume goes on") << '\n';
    report.set("file", options.file.native());
    report.set("tiles", found.tiles);
    report.set("vertices", found.vertices);
    report.set("side_records", found.side_records);
    report.set("complete", complete);
    report.set("passed", found.ok());
    report.set("problems", found.problems);
    report.set("first_problems", found.first_problems);
    report.write();
    if (found.ok()) return;
    const std::size_t more = found.problems - found.first_problems.size();
    throw Error(Fault::check_failed, options.file.native(),
                grouped(found.problems) + (found.problems == 1 ? " problem" : " problems") +
                    (more > 0 ? ", the first " + std::to_string(found.first_problems.size()) + " listed" : ""));
}

}  // namespace

void add_verify(CLI::App& program) {
    auto options = std::make_shared<Options>();
    CLI::App* command = add_command(program, "verify", "Check an elevation store: exit status 1 if anything is wrong",
                                    "octaglobe verify earth.octa");
    add_value(*command, "file", "FILE", "An elevation store made by octaglobe bake",
              [&file = options->file](std::string_view where, const std::string& text) {
                  if (text.empty()) throw Error(Fault::bad_usage, where, "empty file name", "a path");
                  file = text;
              })
        ->required();
    add_json_option(*command, options->json);
    command->final_callback([options] { verify(*options); });
}

}  // namespace render
