#include "pleat/store/staged_file.h"

#include <unistd.h>

namespace pleat {

StagedFile::~StagedFile() {
  if (!path_.empty() && unpublished_ == Unpublished::kRemove) unlink(path_.c_str());
}

}  // namespace pleat
