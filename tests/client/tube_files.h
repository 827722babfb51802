// A swaying tube as files: the sequence, a rig for it, a small model and a motion of the model.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "client/run_pleat.h"
#include "pleat/base/file.h"
#include "pleat/formats/model_file.h"
#include "pleat/formats/motion_reader.h"
#include "pleat/formats/rig_file.h"
#include "pleat/formats/sequence_file.h"
#include "pleat/skinning/user_rig.h"
#include "support/fake_training.h"
#include "support/status_matchers.h"
#include "support/temporary_folder.h"

namespace pleat {

class TubeFiles {
 public:
  static constexpr int kNumFrames = 10, kNumVertices = 96, kNumMotionFrames = 6;

  TubeFiles() {
    EXPECT_THAT(WriteSequenceFile(sequence_path(), clip_), IsOk());
    EXPECT_THAT(WriteFile(model_path(), EncodeModel(*model_)), IsOk());
    EXPECT_THAT(WriteMotion(motion_path(), model_->skeleton(),
                            MakeMotion(model_->skeleton(), kNumMotionFrames)),
                IsOk());
    const UserRig rig{model_->skeleton(), model_->rig().weights, 0, {}};
    EXPECT_THAT(WriteFile(rig_path(), EncodeRig(rig)), IsOk());
  }

  const MeshSequence& clip() const { return clip_; }
  const CharacterModel& model() const { return *model_; }

  std::string File(const std::string& name) const { return folder_.File(name); }
  std::string sequence_path() const { return File("tube.pseq"); }
  std::string model_path() const { return File("tube.pleat"); }
  std::string motion_path() const { return File("motion.json"); }
  std::string rig_path() const { return File("rig.json"); }

  // `pleat VERB ... --local --data-dir D`: through a store of this test.
  Outcome RunInStore(std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--local", "--data-dir", File("store")});
    return RunPleat(arguments);
  }
  // Trains a model of the tube in the store, in a moment: a given rig, the simplest learner.
  Outcome TrainInStore(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"train",     sequence_path(), "--rig",    rig_path(),
                                          "--learner", "ridge",         "--refine", "none"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunInStore(arguments);
  }

 private:
  const TemporaryFolder folder_;
  const MeshSequence clip_ = MakeSwayingTube(kNumFrames);
  const std::shared_ptr<const CharacterModel> model_ = MakeFakeModel(clip_, TrainOptions());
};

}  // namespace pleat
