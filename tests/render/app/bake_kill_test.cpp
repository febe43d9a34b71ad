// A bake that is killed at any moment leaves a store that opens, verifies and goes on to the same content.

#include <gtest/gtest.h>
#include <sys/time.h>

#include "tests/render/app/baked_store.h"
#include "tests/render/app/folder_watch.h"

namespace render {
namespace {

namespace fs = std::filesystem;

const std::string arguments = "bake dem.vrt --least-level 12 --density 2 --threads 2 -o store.octa";
constexpr int kills = 30;  // of each kind

class KilledBake : public testing::Test {
  protected:
    KilledBake() {
        hilly_terrain().write(folder_ / "dem.vrt");
        rusage usage{};
        Process whole(folder_.path(), words(arguments));
        EXPECT_EQ(whole.wait(&usage).status, 0);
        processor_us_ = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1e6 +
                        static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
        rows_ = rows_of(folder_ / "store.octa");
        names_ = folder_.names();
        fs::remove(folder_ / "store.octa");
    }

    /// What a killed bake left is a store, and goes on. @return the tiles that it had
    std::uint64_t expect_resumes() {
        std::uint64_t tiles = 0;
        const fs::path file = folder_ / "store.octa";
        if (fs::exists(file) && fs::file_size(file) > 0) {
            const Outcome info = run(folder_.path(), words("info store.octa --json info.json"));
            EXPECT_EQ(info.status, 0) << info.err;
            if (info.status == 0) tiles = nlohmann::json::parse(content(folder_ / "info.json")).at("tiles");
            fs::remove(folder_ / "info.json");
            const Outcome verified = run(folder_.path(), words("verify store.octa"));
            EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
        }
        const Outcome resumed = run(folder_.path(), words(arguments + " --resume"));
        EXPECT_EQ(resumed.status, 0) << resumed.err;
        EXPECT_EQ(rows_of(file), rows_);
        EXPECT_EQ(folder_.names(), names_);
        fs::remove(file);
        return tiles;
    }

    ScratchFolder folder_;
    double processor_us_ = 0;  ///< of a whole bake
    std::string rows_;
    std::vector<std::string> names_;
};

// Moments are evenly spread over the processor time of a bake, so that they do not depend on what else the machine does.
// Nothing handles SIGPROF: it ends the process as SIGKILL does.
TEST_F(KilledBake, AtAnyMomentOfItsWork) {
    int killed = 0;
    for (int i = 0; i < kills; ++i) {
        SCOPED_TRACE(i);
        const auto moment = static_cast<suseconds_t>(processor_us_ * (i + 0.5) / kills);
        const Outcome outcome = run(folder_.path(), words(arguments), [&] {
            const itimerval timer{{0, 0}, {moment / 1'000'000, moment % 1'000'000}};
            ::setitimer(ITIMER_PROF, &timer, nullptr);
        });
        ASSERT_TRUE(outcome.status == 128 + SIGPROF || outcome.status == 0) << outcome.status << outcome.err;
        killed += outcome.status != 0;
        expect_resumes();
    }
    EXPECT_GE(killed, kills / 2);  // later bakes find files in the page cache, and end sooner
}

// Moments are evenly spread over what happens in the folder: files made, written, renamed, removed.
TEST_F(KilledBake, AtAnyMomentOfItsWriting) {
    int events = 0;
    {
        FolderWatch watch(folder_.path());
        Process whole(folder_.path(), words(arguments));
        events = watch.wait_for(1 << 30, whole);
        ASSERT_EQ(whole.wait().status, 0);
        fs::remove(folder_ / "store.octa");
    }
    ASSERT_GT(events, 10);
    int killed = 0, had_tiles = 0;
    for (int i = 0; i < kills; ++i) {
        SCOPED_TRACE(i);
        {
            FolderWatch watch(folder_.path());
            Process bake(folder_.path(), words(arguments));
            watch.wait_for(1 + events * i / kills, bake);
            ::kill(bake.id(), SIGKILL);
            killed += bake.wait().status == 128 + SIGKILL;
        }
        had_tiles += expect_resumes() > 0;
    }
    EXPECT_GE(killed, kills / 2);  // later bakes find files in the page cache, and end sooner
    EXPECT_GE(had_tiles, 3);
}

}  // namespace
}  // namespace render
