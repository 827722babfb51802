#include "pleat/base/processor_time.h"

#include <ctime>

namespace pleat {
namespace {

thread_local ProcessorTimeMeter::Scope* current_scope = nullptr;
thread_local ProcessorTimeMeter* current_meter = nullptr;

int64_t ThreadNanoseconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

ProcessorTimeMeter* ProcessorTimeMeter::OfThisThread() { return current_meter; }

ProcessorTimeMeter::Scope::Scope(ProcessorTimeMeter* meter) : meter_(meter), outer_(current_scope) {
  if (outer_ != nullptr) outer_->Update();
  counted_ns_ = ThreadNanoseconds();
  current_scope = this;
  current_meter = meter_;
}

ProcessorTimeMeter::Scope::~Scope() {
  Update();
  current_scope = outer_;
  current_meter = outer_ == nullptr ? nullptr : outer_->meter_;
  if (outer_ != nullptr) outer_->counted_ns_ = counted_ns_;
}

void ProcessorTimeMeter::Scope::Update() {
  if (current_scope != this) return;  // an inner one counts, or another thread asks
  const int64_t now_ns = ThreadNanoseconds();
  if (meter_ != nullptr) meter_->used_ns_ += now_ns - counted_ns_;
  counted_ns_ = now_ns;
}

}  // namespace pleat
