// The live sessions that are open, so that a server that shuts down can end them at once.
#pragma once

#include <mutex>
#include <set>

namespace pleat {

class Drainable {
 public:
  virtual void Drain() = 0;    // ends as soon as what is under way has been handed over
  virtual void Abandon() = 0;  // ends although the client does not read
 protected:
  ~Drainable() = default;
};

// Thread-safe.
class LiveRegistry {
 public:
  void DrainAll() {
    std::lock_guard lock(mutex_);
    for (Drainable* session : sessions_) session->Drain();
  }
  void AbandonAll() {
    std::lock_guard lock(mutex_);
    for (Drainable* session : sessions_) session->Abandon();
  }

  // In the registry as long as it lives. The last member of a session, so that it goes first.
  class Entry {
   public:
    Entry(LiveRegistry* registry, Drainable* session) : registry_(registry), session_(session) {
      std::lock_guard lock(registry_->mutex_);
      registry_->sessions_.insert(session_);
    }
    ~Entry() {
      std::lock_guard lock(registry_->mutex_);
      registry_->sessions_.erase(session_);
    }
    Entry(const Entry&) = delete;
    Entry& operator=(const Entry&) = delete;

   private:
    LiveRegistry* registry_;
    Drainable* session_;
  };

 private:
  std::mutex mutex_;
  std::set<Drainable*> sessions_;  // guarded by mutex_
};

}  // namespace pleat
