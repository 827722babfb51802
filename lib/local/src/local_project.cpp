#include "pleat/local/local_project.h"

namespace pleat {

LocalProject::LocalProject(const SharedByProjects& shared, const LocalProjectOptions& options)
    : files_(shared.store, options.limits, options.wall_clock,
             {.project = options.name,
              .share_content = options.project.share_content,
              .max_bytes = options.project.max_bytes,
              .upload_memory = &shared.memory->uploads}),
      frames_(ProjectQuota::OfFrames(options.name, options.project.frames_per_second)),
      job_time_(ProjectQuota::OfJobTime(options.name, options.project.job_cpu_seconds_per_hour)),
      sequences_(&files_),
      models_(&files_, shared.model_cache),
      compressed_sequences_(&files_, &shared.memory->decoders, &frames_),
      poses_(&models_, shared.pose_engine, options.limits.max_frames, &frames_),
      jobs_(&files_, &sequences_,
            JobRunner(&files_, &sequences_, options.train, options.num_threads_per_job,
                      &shared.memory->jobs),
            shared.jobs, &job_time_) {}

}  // namespace pleat
