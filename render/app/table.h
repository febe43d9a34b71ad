#pragma once
// Rows of text in columns.

#include <ostream>
#include <string>
#include <vector>

namespace render {

/// Prints rows with their columns aligned, two blanks between them; the last column is as wide as it likes. Cells are
/// ASCII. Rows may differ in length.
void print_table(std::ostream& out, const std::vector<std::vector<std::string>>& rows);

}  // namespace render
