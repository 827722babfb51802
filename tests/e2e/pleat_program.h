// The command line in a folder of its own, for tests that tell a story with it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "e2e/process.h"
#include "pleat/base/file.h"
#include "support/temporary_folder.h"

namespace pleat {

class PleatProgram {
 public:
  const std::string& folder() const { return folder_.path(); }
  std::string File(const std::string& name) const { return folder_.File(name); }

  // Runs `pleat arguments...` to its end.
  ProcessResult Run(std::vector<std::string> arguments) {
    return Start(std::move(arguments))->Wait();
  }
  std::unique_ptr<Process> Start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), ProgramPath("pleat"));
    return std::make_unique<Process>(arguments);
  }

  // Generates a small performer: <folder>/made/performer.pc2 with its .obj.
  std::string GeneratePerformer(int num_frames, int num_vertices) {
    const ProcessResult result =
        Run({"generate", "performer", "-o", File("made"), "--frames", std::to_string(num_frames),
             "--vertices", std::to_string(num_vertices), "--quiet"});
    return result.exit_code == 0 ? File("made/performer.pc2") : result.err;
  }

 private:
  TemporaryFolder folder_;
};

// The bytes of a file, empty when it is not there.
inline std::string Bytes(const std::string& path) { return ReadFile(path).value_or(""); }

// A JSON file or text; a discarded value when it does not parse.
inline nlohmann::json ParseJson(const std::string& text) {
  return nlohmann::json::parse(text, nullptr, false);
}

}  // namespace pleat
