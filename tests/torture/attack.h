// A server under attack, somebody who uses it meanwhile, and what both look like afterwards.
#pragma once

#include <grpcpp/channel.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/synchronization/notification.h"
#include "pleat/remote/remote_character_service.h"
#include "pleat/skeleton/pose_track.h"

namespace pleat {

// What stays the same for all attacks of a run.
struct AttackedServer {
  std::string data_dir{};
  uint64_t memory_bytes = 0;  // --memory-bytes
  double seconds = 5;         // of one attack
  std::string model_id{};     // there before the attack
  std::vector<Pose> poses{};  // that fit it
};

// One attack while it runs. Attackers are threads that do as they like until `over`.
class Attack {
 public:
  Attack(const AttackedServer& server, std::string address);
  ~Attack() { End(); }

  const AttackedServer& server() const { return server_; }
  const std::string& address() const { return address_; }
  // A connection of its own.
  std::shared_ptr<grpc::Channel> NewChannel() const;
  std::unique_ptr<RemoteCharacterService> Connect() const;
  bool over() const { return over_.HasBeenNotified(); }
  // Waits so long, or until the attack is over; false then.
  bool Pause(double seconds) const {
    return !over_.WaitForNotificationWithTimeout(absl::Seconds(seconds));
  }

  // Runs `attacker` on `num_threads` threads, each with a number.
  void Start(int num_threads, std::function<void(int)> attacker);
  void End();  // tells the attackers and waits for them

  void CountLoad() { ++num_calls_; }
  uint64_t num_calls() const { return num_calls_; }

  // The server has said OK: from now on the sequence must be there.
  void Acknowledged(const std::string& sequence_id);
  std::set<std::string> acknowledged() const;

 private:
  const AttackedServer& server_;
  const std::string address_;
  absl::Notification over_;
  std::vector<std::thread> threads_;
  std::atomic<uint64_t> num_calls_ = 0;
  mutable std::mutex mutex_;
  std::set<std::string> acknowledged_;  // guarded by mutex_
};

struct AttackKind {
  const char* name;
  const char* load;  // in words, for the table
  std::function<void(Attack*)> start;
};
// All attacks, the first of which is none.
const std::vector<AttackKind>& AttackKinds();

}  // namespace pleat
