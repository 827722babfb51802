// The joints of bones that Pleat writes for other programs (MakeExportJoints), taken back.
#pragma once

#include <vector>

#include "pleat/formats/rig_file.h"

namespace pleat {

// Takes the joints "<name>_bone" of a rig away that rest on the joint above them and have "<name>"
// alone below them, as Pleat writes them, and gives their weights to the bones that end in
// "<name>": the rig is then the one that was written. A rig stays as it is where it has none, or
// where weights of other joints do not say which bone is meant.
// skin_places: where each joint of file->skeleton stands in the skin, -1 = nowhere.
void TakeBoneJoints(const std::vector<int>& skin_places, RigFile* file);

}  // namespace pleat
