#include "pleat/local/retention_flags.h"

namespace pleat {

RetentionRules RulesOf(const RetentionFlags& flags) {
  RetentionRules rules;
  rules.max_ended_jobs = flags.keep_jobs;
  if (flags.keep_jobs_days > 0) rules.max_job_age = absl::Hours(24 * flags.keep_jobs_days);
  rules.max_upload_age = absl::Hours(flags.keep_uploads_hours);
  return rules;
}

}  // namespace pleat
