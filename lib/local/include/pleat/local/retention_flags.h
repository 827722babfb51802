// The flags of retention, which `pleatd` and `pleat store sweep` have in common.
#pragma once

#include <cstdint>

#include "pleat/local/retention.h"

namespace pleat {

struct RetentionFlags {
  int64_t keep_jobs = 0;
  double keep_jobs_days = 0;
  double keep_uploads_hours = 7 * 24;
};

// Calls visit(flag, member&, help, least, most) for each of them. least_upload_hours: while a
// server runs, clients need some time between two attempts.
template <typename Visitor>
void VisitRetentionFlags(RetentionFlags& flags, double least_upload_hours, Visitor&& visit) {
  visit("--keep-jobs", flags.keep_jobs,
        "Jobs of each project that have ended and stay in the list, the newest; 0 = all", 0, 1e9);
  visit("--keep-jobs-days", flags.keep_jobs_days,
        "Days that a job stays in the list after its end; 0 = for ever", 0, 36'500);
  visit("--keep-uploads-hours", flags.keep_uploads_hours,
        "Hours that what has arrived of an upload stays after its last byte", least_upload_hours,
        876'000);
}

// The rules that the flags ask for.
RetentionRules RulesOf(const RetentionFlags& flags);

}  // namespace pleat
