// Watching a job as a test does.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "pleat/service/job_service.h"
#include "support/status_matchers.h"

namespace pleat {

// The job's last state; its progress must never fall.
inline JobInfo WatchToEnd(JobService& jobs, const std::string& id) {
  JobInfo last;
  EXPECT_THAT(WatchJob(jobs, id,
                       [&](const JobInfo& info) {
                         EXPECT_GE(info.fraction, last.fraction);
                         last = info;
                         return true;
                       }),
              IsOk());
  return last;
}

}  // namespace pleat
