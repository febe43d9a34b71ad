// A signal at any moment leaves whole files or none: whatever the command writes, and whichever thread writes it.

#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <random>

#include "tests/render/app/can_draw.h"
#include "tests/render/app/folder_watch.h"
#include "tests/render/app/refine_program.h"

namespace render {
namespace {

namespace fs = std::filesystem;

struct Command {
    const char* name;
    const char* line;
    bool draws = false;
};
void PrintTo(const Command& command, std::ostream* out) {
    *out << command.line;
}

constexpr Command commands[] = {
    {"picture", "render --size 320x200 -o p.png", true},
    {"poster", "render --size 4100x24 --samples 1 -o p.tif", true},
    {"frames", "fly path.json --fps 4 --size 64x36 -o frames", true},
    {"video", "fly path.json --fps 4 --size 64x36 -o video.mp4", true},
    {"mesh", "mesh dem.vrt --max-deviation 5 -o m.glb --picture m.png", true},
    {"tin", "tin dem.vrt --max-deviation 5 -o t.ply --error-grid e.tif --picture t.png", false},
    {"tin_tiles", "tin dem.vrt --max-deviation 5 --tile 16 -o tiles", false},
    {"refine", "refine mesh.ply --steps 4 -o r.ply --progressive r.oprog", false},
    {"growing", "refine base.oprog --morph 5 -o grown", false},
    {"viewshed_raster", "query viewshed 37.58,-105.49 --radius 5km -o v.tif", false},
    {"viewshed_picture", "query viewshed 37.58,-105.49 --radius 5km -o v.png", false},
    {"profile", "query profile 37.5,-105.6 37.6,-105.5 -o profile.svg", false},
};

class Interrupted : public testing::TestWithParam<Command> {
  protected:
    using Files = std::map<std::string, std::string>;

    void SetUp() override {
        if (GetParam().draws && !can_draw()) GTEST_SKIP() << "no usable OpenGL";
        hilly_terrain().write(inputs_ / "dem.vrt");
        write_mesh_file(inputs_ / "mesh.ply", uneven_mesh());
        std::ofstream(inputs_ / "path.json") << R"({"keys": [{"at": [20, -100], "range": "9000km"},
            {"range": "8000km", "seconds": 1}]})";
        ASSERT_EQ(run(inputs_.path(), words("refine mesh.ply --steps 2 --progressive base.oprog")).status, 0);
        new_folder();
        FolderWatch watch(folder_->path());
        Process whole(folder_->path(), arguments());
        events_ = watch.wait_for(1 << 30, whole);
        const Outcome outcome = whole.wait();
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        whole_ = files();
        ASSERT_GT(whole_.size(), inputs_.names().size());
    }

    std::vector<std::string> arguments() const { return words(GetParam().line); }

    void new_folder() {
        folder_.emplace();
        fs::copy(inputs_.path(), folder_->path(), fs::copy_options::recursive);
    }

    /// Contents by path.
    Files files() const {
        Files list;
        for (const auto& entry : fs::recursive_directory_iterator(folder_->path()))
            list[fs::relative(entry.path(), folder_->path())] = entry.is_directory() ? "" : content(entry.path());
        return list;
    }

    /// Sends a signal right after the n-th thing that happens in the folder.
    void interrupt(int event, int signal_number) {
        new_folder();
        Outcome outcome;
        {
            FolderWatch watch(folder_->path());
            Process process(folder_->path(), arguments());
            watch.wait_for(event, process);
            ::kill(process.id(), signal_number);
            outcome = process.wait();
        }
        EXPECT_TRUE(outcome.status == 128 + signal_number || outcome.status == 0) << outcome.status << outcome.err;
        EXPECT_TRUE(outcome.err.empty()) << outcome.err;
        const Files left = files();
        for (const auto& [name, bytes] : left) {
            const auto found = whole_.find(name);
            if (found == whole_.end())
                ADD_FAILURE() << name << " is left of event " << event;
            else
                EXPECT_TRUE(bytes == found->second) << name << " is half-written, event " << event;
        }
        for (const auto& [name, bytes] : whole_)  // a folder is whole, too
            if (const auto slash = name.find('/'); slash != name.npos && left.contains(name.substr(0, slash))) {
                EXPECT_TRUE(left.contains(name)) << event;
            }
        EXPECT_TRUE(outcome.status != 0 || left == whole_) << event;
    }

    ScratchFolder inputs_;
    std::optional<ScratchFolder> folder_;
    Files whole_;
    int events_ = 0;
};

TEST_P(Interrupted, LeavesWholeFilesOrNone) {
    ASSERT_GT(events_, 2);
    interrupt(1, SIGINT);  // the instant in which the first file is made
    std::mt19937 random(1);
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP})
        interrupt(static_cast<int>(2 + random() % static_cast<unsigned>(events_ - 1)), signal_number);
}

INSTANTIATE_TEST_SUITE_P(Commands, Interrupted, testing::ValuesIn(commands),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace render
