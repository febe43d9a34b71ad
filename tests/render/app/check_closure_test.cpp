// The closure part of the certificate: all of it holds, and its tables have the figures of the paper.

#include <gtest/gtest.h>

#include <algorithm>

#include "render/app/check/check_parts.h"

namespace render {
namespace {

TEST(CheckClosure, HoldsAndPrintsTwoTables) {
    const CheckPart part = check_closure();
    EXPECT_TRUE(part.skipped.empty());
    for (const auto& row : part.rows) EXPECT_TRUE(row.passed) << row.name << " " << row.value;
    const auto centres = std::count_if(part.rows.begin(), part.rows.end(), [](const auto& row) {
        return row.name.starts_with("merging domain of a patch's centre, n = 2^");
    });
    EXPECT_EQ(centres, 9);  // 2^9, 2^11 .. 2^25
    for (const char* figures : {"2^9   289               238      238         10.5182\n",
                                "2^25  16785409          81710    81710       14.1059\n", "10 sqrt(2)  14.1421\n",
                                "\n8   238    238      11.3828         6.8702           40           285\n",
                                "\n24  81710  81710    13.9883\n"})
        EXPECT_NE(part.tables.find(figures), std::string::npos) << figures << part.tables;
}

}  // namespace
}  // namespace render
