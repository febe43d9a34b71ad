// The help fits into the windows that people have.

#include <gtest/gtest.h>

#include "render/viewer/help_layout.h"
#include "render/viewer/keys.h"

namespace render {
namespace {

/// As wide as DejaVu Sans in the mean.
float width_of(const std::string& text, float font) {
    return 0.45f * font * static_cast<float>(text.size());
}

TEST(HelpLayout, EveryGroupIsThereOnceAndInOrder) {
    const std::vector<HelpGroup> groups = help_groups();
    for (const auto& [width, height] : {std::pair(1248.f, 600.f), {1248.f, 300.f}, {608.f, 360.f}, {200.f, 100.f}}) {
        const HelpLayout layout = lay_out_help(groups, width_of, width, height);
        std::vector<std::string> titles;
        for (const HelpLayout::Column& column : layout.columns) {
            EXPECT_FALSE(column.groups.empty());
            for (const HelpGroup& group : column.groups) titles.push_back(group.title);
        }
        ASSERT_EQ(titles.size(), groups.size());
        for (std::size_t i = 0; i < groups.size(); ++i) EXPECT_EQ(titles[i], groups[i].title);
    }
}

TEST(HelpLayout, TakesTheLargestThatFits) {
    const std::vector<HelpGroup> groups = help_groups();
    const auto layout = [&](float width, float height) { return lay_out_help(groups, width_of, width, height); };
    const HelpLayout usual = layout(1248, 600), wide = layout(1248, 340), small = layout(608, 376),
                     tiny = layout(608, 250);
    EXPECT_EQ(usual.density, 0);
    EXPECT_EQ(usual.columns.size(), 2u);
    EXPECT_EQ(wide.density, 0);
    EXPECT_EQ(wide.columns.size(), 3u);
    EXPECT_LE(wide.height, 340);
    EXPECT_EQ(small.density, 1);
    EXPECT_EQ(small.columns.size(), 2u);
    EXPECT_LE(small.height, 376);
    EXPECT_LE(small.width, 608);
    EXPECT_EQ(tiny.density, 1);
    EXPECT_GT(tiny.height, 250);
    for (const HelpLayout::Column& column : usual.columns) EXPECT_GT(column.width, column.keys + 16);
}

// No even one is lower: the tallest column of two, if the groups went in any other way.
TEST(HelpLayout, ColumnsAreEven) {
    const HelpLine line{"k", "what"};
    const std::vector<HelpGroup> groups{
        {"a", {line}}, {"b", {line, line, line, line}}, {"c", {line}}, {"d", {line, line}}};
    const HelpLayout layout = lay_out_help(groups, width_of, 1e4f, 1e4f);
    ASSERT_EQ(layout.columns.size(), 2u);
    EXPECT_EQ(layout.columns[0].groups.size(), 2u);
    EXPECT_EQ(layout.height, 2 * 8 + 7 * 18);
}

TEST(HelpLayout, NothingToShow) {
    const HelpLayout layout = lay_out_help({}, width_of, 100, 100);
    EXPECT_EQ(layout.height, 0);
    EXPECT_EQ(layout.columns.size(), 1u);
}

}  // namespace
}  // namespace render
