// Runs a script in a Python that has a module, for tests that ask another implementation. Without
// one they skip.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

namespace pleat {

// The command of a Python that can import `module`.
inline std::optional<std::string> FindPythonWith(const std::string& module) {
  for (const char* command : {"python3", "/usr/bin/python3"}) {
    const std::string call = std::string(command) + " -c 'import " + module + "' >/dev/null 2>&1";
    if (std::system(call.c_str()) == 0) return command;
  }
  return std::nullopt;
}

// Runs `script` with the folder as its only argument; what it prints goes to the log of the test.
inline bool RunScript(const std::string& command, const std::string& script,
                      const std::string& folder) {
  const std::string path = folder + "/script.py";
  std::ofstream(path) << script;
  return std::system((command + " '" + path + "' '" + folder + "' 1>&2").c_str()) == 0;
}

}  // namespace pleat

// Declares `variable` as such a command or skips the test.
#define PLEAT_PYTHON_OR_SKIP(variable, module)                                         \
  const std::optional<std::string> variable##_found = ::pleat::FindPythonWith(module); \
  if (!variable##_found) GTEST_SKIP() << "no Python with " << (module) << " is here";  \
  const std::string variable = *variable##_found
