#include "cli/verbs/content_flag.h"

#include <CLI/Validators.hpp>
#include <string>

namespace pleat {
namespace {

constexpr StreamContent kContents[] = {StreamContent::kMesh, StreamContent::kControlMesh,
                                       StreamContent::kParameters};

}  // namespace

const char* StreamContentName(StreamContent content) {
  switch (content) {
    case StreamContent::kMesh:
      return "mesh";
    case StreamContent::kControlMesh:
      return "control";
    case StreamContent::kParameters:
      return "parameters";
  }
  return "unknown";
}

void AddContentFlag(CLI::App* verb, StreamContent* content) {
  std::vector<std::string> names;
  for (const StreamContent known : kContents) names.push_back(StreamContentName(known));
  verb->add_option_function<std::string>(
          "--content",
          [content](const std::string& name) {
            for (const StreamContent known : kContents) {
              if (name == StreamContentName(known)) *content = known;
            }
          },
          "of frames from a server: mesh (every vertex), control (a twentieth of the vertices, for "
          "previews) or parameters (under a kilobyte, shown by the model here)")
      ->check(CLI::IsMember(names))
      ->default_str(StreamContentName(*content));
}

}  // namespace pleat
