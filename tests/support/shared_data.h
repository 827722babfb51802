// The optional folder of real captured sequences. Tests that use it skip where it is absent.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "support/source_folder.h"

namespace pleat {

// Path of `relative` in the folder of captured sequences (environment variable PLEAT_SHARED_DATA,
// else shared/data beside the checkout); nullopt when the file is not on this machine.
inline std::optional<std::string> FindSharedData(const std::string& relative) {
  std::filesystem::path folder = InSourceFolder("../shared/data");
  if (const char* from_environment = std::getenv("PLEAT_SHARED_DATA")) folder = from_environment;
  const std::filesystem::path path = folder / relative;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path.lexically_normal().string();
}

}  // namespace pleat

// Declares `variable` as the path of a captured file or skips the test with a clear word.
#define PLEAT_SHARED_DATA_OR_SKIP(variable, relative)                                    \
  const std::optional<std::string> variable##_found = ::pleat::FindSharedData(relative); \
  if (!variable##_found)                                                                 \
    GTEST_SKIP() << "captured sequence " << (relative)                                   \
                 << " is not on this machine (PLEAT_SHARED_DATA)";                       \
  const std::string variable = *variable##_found
