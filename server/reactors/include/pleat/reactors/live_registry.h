// The live sessions that are open, so that a server that shuts down can end them at once.
#pragma once

#include <mutex>
#include <set>

namespace pleat {

class Drainable {
 public:
  // Ends the session as soon as the frame that is being written has been handed over.
  virtual void Drain() = 0;
  // Ends it although the client does not read.
  virtual void Abandon() = 0;

 protected:
  ~Drainable() = default;
};

// Thread-safe. Drain and Abandon run while the registry is locked, so they must not add or remove
// a session.
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

  // Keeps `session` in the registry as long as it lives. It must be the last member of the session,
  // so that it goes first: then no call of Drain or Abandon meets a session that is half destroyed.
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
