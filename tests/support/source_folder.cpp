#include "support/source_folder.h"

namespace pleat {

std::string InSourceFolder(const std::string& relative) {
  return std::string(PLEAT_SOURCE_DIR "/") + relative;
}

}  // namespace pleat
