// Progress as a terminal shows it.

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/render/app/baked_store.h"

namespace render {
namespace {

/// A terminal of our own.
class Terminal {
  public:
    Terminal() : ours_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {
        if (ours_ >= 0 && ::grantpt(ours_) == 0 && ::unlockpt(ours_) == 0)
            theirs_ = ::open(::ptsname(ours_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    }
    ~Terminal() {
        ::close(ours_);
        ::close(theirs_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    int theirs() const { return theirs_; }
    /// What has been written to it.
    std::string text() const {
        std::string all;
        char bytes[4096];
        for (ssize_t length; (length = ::read(ours_, bytes, sizeof bytes)) > 0;)
            all.append(bytes, static_cast<std::size_t>(length));
        return all;
    }

  private:
    int ours_ = -1, theirs_ = -1;
};

TEST(Progress, IsOneLineThatGoes) {
    const ScratchFolder folder;
    hilly_terrain().write(folder / "dem.vrt");
    const Terminal terminal;
    if (terminal.theirs() < 0) GTEST_SKIP() << "no terminals here";
    const std::pair<const char*, const char*> commands[] = {
        {"bake dem.vrt --least-level 14 -o store.octa", " %"},
        {"verify store.octa", " %"},
        {"mesh dem.vrt --max-triangles 500 --priority rms -o mesh.ply", "reading ..."},
        {"mesh dem.vrt --max-deviation 0 -o mesh.glb", "reading ..."}};  // refused, for a .glb rounds
    for (const auto& [arguments, part] : commands) {
        const Outcome outcome = run(folder.path(), words(arguments), [&] { ::dup2(terminal.theirs(), STDERR_FILENO); });
        std::string shown = terminal.text();
        EXPECT_NE(shown.find(part), std::string::npos) << shown;
        // What a refusal says comes after the line has gone.
        EXPECT_EQ(shown.find('\n') == std::string::npos, outcome.status == 0) << shown;
        shown.resize(std::min(shown.size(), shown.find("octaglobe: ")));
        EXPECT_TRUE(shown.ends_with("\r\033[K")) << shown;
    }
}

}  // namespace
}  // namespace render
