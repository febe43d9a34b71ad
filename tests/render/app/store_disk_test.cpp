// Stores on a disk that is full, and what a bake that was stopped leaves beside them.

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <fstream>

#include "tests/render/app/baked_store.h"

namespace render {
namespace {

namespace fs = std::filesystem;

const std::string arguments = "bake dem.vrt --finest-level 25 --least-level 12 -o ";

bool write_line(const char* file, const std::string& line) {
    std::ofstream out(file);
    return static_cast<bool>(out << line << std::flush);
}

/// In namespaces of this process's own, where it may mount without rights. False: not even there.
bool mount_small(const fs::path& folder, const char* size) {
    const std::string user = std::to_string(::getuid()), group = std::to_string(::getgid());
    return ::unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0 && write_line("/proc/self/setgroups", "deny") &&
           write_line("/proc/self/uid_map", "0 " + user + " 1") &&
           write_line("/proc/self/gid_map", "0 " + group + " 1") &&
           ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
           ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size) == 0;
}

constexpr int may_not_mount = 77;

/// Calls work() in a process of its own in which `folder` is a small filesystem. @return its exit status
template <class Work>
int in_small_filesystem(const fs::path& folder, const char* size, const Work& work) {
    const pid_t child = ::fork();
    if (child == 0) {
        if (!mount_small(folder, size)) ::_exit(may_not_mount);
        work();
        std::fflush(nullptr);
        ::_exit(testing::Test::HasFailure() ? 1 : 0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

class StoreDisk : public testing::Test {
  protected:
    StoreDisk() {
        hilly_terrain().write(folder_ / "dem.vrt");
        bake(folder_, "dem.vrt --finest-level 25");
        fs::remove(folder_ / "bake.json");
        fs::create_directory(folder_ / "small");
    }
    ScratchFolder folder_;
};

TEST_F(StoreDisk, ThatIsFullStopsABakeWhichGoesOnWhenThereIsRoom) {
    // As begun, in the middle, and when a copy of what is there is put in order.
    for (const char* size : {"size=16k", "size=64k", "size=200k", "size=360k"}) {
        SCOPED_TRACE(size);
        const int status = in_small_filesystem(folder_ / "small", size, [&] {
            const Outcome full = run(folder_.path(), words(arguments + "small/bad.octa"));
            EXPECT_EQ(full.status, 3);
            EXPECT_TRUE(full.err.starts_with("octaglobe: small/bad.octa")) << full.err;
            EXPECT_NE(full.err.find(": the disk is full"), std::string::npos) << full.err;
            EXPECT_EQ(std::count(full.err.begin(), full.err.end(), '\n'), 1) << full.err;
            const fs::path store = folder_ / "small/bad.octa";
            if (fs::exists(store) && fs::file_size(store) > 0) {
                EXPECT_FALSE(planet::ElevationStore::open(store).metadata().complete);
                EXPECT_EQ(run(folder_.path(), words("verify small/bad.octa")).status, 0);
            }
            EXPECT_EQ(::mount("tmpfs", (folder_ / "small").c_str(), "tmpfs", MS_REMOUNT, "size=16m"), 0);
            const Outcome resumed = run(folder_.path(), words(arguments + "small/bad.octa --resume"));
            EXPECT_EQ(resumed.status, 0) << resumed.err;
            EXPECT_EQ(rows_of(store), rows_of(folder_ / "store.octa"));
            EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "small"), {}), 1);
        });
        if (status == may_not_mount) GTEST_SKIP() << "a filesystem can be mounted with rights only";
        EXPECT_EQ(status, 0);
    }
}

TEST_F(StoreDisk, LeftoversSayWhatTheyAre) {
    for (const char* ending : {"-journal", "-beginning", "-beginning-journal", "-finishing", "-finishing-journal"}) {
        const std::string name = std::string("store.octa") + ending;
        fs::copy_file(folder_ / "store.octa", folder_ / name.c_str());
        for (const std::string command : {"info ", "verify "}) {
            const Outcome outcome = run(folder_.path(), words(command + name));
            EXPECT_EQ(outcome.status, 3);
            EXPECT_TRUE(outcome.err.starts_with("octaglobe: " + name + ": what a bake left beside its store"))
                << outcome.err;
            EXPECT_NE(outcome.err.find(" store.octa"), std::string::npos) << outcome.err;
        }
        fs::remove(folder_ / name.c_str());
        EXPECT_EQ(run(folder_.path(), words(arguments + name)).status, 2);
        EXPECT_FALSE(fs::exists(folder_ / name.c_str()));
    }
}

TEST_F(StoreDisk, LeftoversGoWithTheNextBake) {
    const auto names = folder_.names();
    const auto leave = [&] {
        for (const char* name : {"store.octa-beginning", "store.octa-beginning-journal", "store.octa-finishing",
                                 "store.octa-finishing-journal"})
            std::ofstream(folder_ / name) << "left";
    };
    for (const char* how : {" --resume", " --replace"}) {
        leave();
        EXPECT_EQ(run(folder_.path(), words(arguments + "store.octa" + how)).status, 0);
        EXPECT_EQ(folder_.names(), names) << how;
    }
    fs::remove(folder_ / "store.octa");
    leave();
    EXPECT_EQ(run(folder_.path(), words(arguments + "store.octa")).status, 0);
    EXPECT_EQ(folder_.names(), names);
}

}  // namespace
}  // namespace render
