// Other programs that tests ask, where they are on this machine.
#pragma once

#include <array>
#include <cstdio>
#include <memory>
#include <string>

namespace pleat {

// What `command` prints; empty when it fails to start.
inline std::string OutputOf(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  std::array<char, 4096> buffer;
  while (pipe != nullptr && fgets(buffer.data(), buffer.size(), pipe.get()) != nullptr) {
    output += buffer.data();
  }
  return output;
}

// True when node finds the npm package: `npm install NAME` in any folder, and NODE_PATH=that
// folder/node_modules.
inline bool HasNodePackage(const std::string& name) {
  return OutputOf("node -e \"require.resolve('" + name +
                  "'); console.log('found')\" 2>/dev/null") == "found\n";
}

}  // namespace pleat
