#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pleat/base/utf8.h"
#include "pleat/formats/frame_files.h"

// Names of frames, one a line. Every path that comes out went in, and notes are clean text.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<std::string> names(1);
  for (size_t i = 0; i < size; ++i) {
    if (data[i] == '\n') {
      names.emplace_back();
    } else {
      names.back().push_back(static_cast<char>(data[i]));
    }
  }
  const auto files = pleat::SortFrameFiles(names);
  if (!files.ok()) return 0;
  for (const std::string& path : files->paths) {
    if (std::find(names.begin(), names.end(), path) == names.end()) __builtin_trap();
  }
  for (const pleat::InputNote& note : files->notes) {
    if (pleat::EscapeControls(note.text) != note.text) __builtin_trap();
  }
  return 0;
}
