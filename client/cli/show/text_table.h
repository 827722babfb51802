// Columns of text for people. Machines use --json.
#pragma once

#include <string>
#include <vector>

namespace pleat {

// Returns the table with its first column aligned left and all others right. Every row has as many
// cells as `header`.
std::string FormatTable(const std::vector<std::string>& header,
                        const std::vector<std::vector<std::string>>& rows);

// Returns the same as a Markdown table.
std::string FormatMarkdownTable(const std::vector<std::string>& header,
                                const std::vector<std::vector<std::string>>& rows);

// Returns "1.5 MB" and the like.
std::string FormatBytes(double bytes);

}  // namespace pleat
