// Checks where a verb writes, before any work is done: names with an ending that promises something
// else are refused, and nothing that exists is replaced without --force.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "cli/io/animation_writer.h"
#include "cli/session.h"

namespace pleat {

// A file that a verb may write.
struct OutputFile {
  std::string flag;  // the flag that names it, for messages
  std::string path;  // empty: the flag was not given
  // The endings that it may have, with the dot. A name without an ending is taken as it is.
  std::vector<std::string> endings;
};

// A usage error names the first of `files` that has an unknown ending, that exists (unless --force
// was given), that is a folder or a device, or that is the same as another of them.
absl::Status CheckOutputFiles(const Session& session, const std::vector<OutputFile>& files);

// A usage error says that the folder is not empty (unless --force was given), that it is a file, or
// that its name has an ending as files have. Such a name is taken when it ends in a slash or when
// the folder exists.
absl::Status CheckOutputFolder(const Session& session, const std::string& flag,
                               const std::string& path);

// Checks OUT of an AnimationWriter, given by -o. format_name: the value of --format, which `format`
// came from.
absl::Status CheckAnimationOutput(const Session& session, const std::string& path,
                                  AnimationFormat format, const std::string& format_name);

}  // namespace pleat
