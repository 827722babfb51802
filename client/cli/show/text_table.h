// Columns of text for people; machines use --json.
#pragma once

#include <string>
#include <vector>

namespace pleat {

// The first column is aligned left, all others right; every row has as many cells as `header`.
std::string FormatTable(const std::vector<std::string>& header,
                        const std::vector<std::vector<std::string>>& rows);

// The same as a Markdown table.
std::string FormatMarkdownTable(const std::vector<std::string>& header,
                                const std::vector<std::vector<std::string>>& rows);

// "1.5 MB"
std::string FormatBytes(double bytes);

}  // namespace pleat
