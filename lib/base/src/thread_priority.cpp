#include "pleat/base/thread_priority.h"

#include <pthread.h>
#include <sched.h>

namespace pleat {

void RunInIdleTime() {
  const sched_param no_priority{};
  pthread_setschedparam(pthread_self(), SCHED_IDLE, &no_priority);
}

}  // namespace pleat
