// The files of the page, as the build has embedded them (client/web).
#pragma once

#include <string_view>
#include <vector>

namespace pleat {

struct PageFile {
  std::string_view path;          // "/studio.js"
  std::string_view content_type;  // "text/javascript; charset=utf-8"
  std::string_view bytes;         // gzip
  std::string_view tag;           // changes with the content; quoted, as an ETag is
};

// Defined by the build.
const std::vector<PageFile>& PageFiles();

}  // namespace pleat
