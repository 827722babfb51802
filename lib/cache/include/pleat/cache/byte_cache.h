// Shared immutable values by key, charged in bytes.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "pleat/cache/charge_account.h"

namespace pleat {

struct ByteCacheStats {
  uint64_t used_bytes = 0, capacity_bytes = 0;
  int num_entries = 0, num_pinned = 0;
  uint64_t hits = 0, misses = 0, evictions = 0;
};

// Least recently used entries go first; an entry is pinned while anybody outside holds its handle,
// and a pinned entry is never dropped (dropping it would free nothing, and the next reader would
// load it a second time). The sum of all charges never exceeds the capacity. A charge lives as long
// as the value, so that a value which was erased while somebody uses it is still counted.
// Thread-safe.
template <typename Value>
class ByteCache {
 public:
  using Handle = std::shared_ptr<const Value>;
  struct Loaded {
    Handle value;
    uint64_t charge_bytes = 0;
  };
  using Loader = std::function<absl::StatusOr<Loaded>(const std::string& key)>;

  // memory: what the cache shares with others, which may ask for room by Reclaim; it must outlive
  // every handle. Null: the cache has its capacity for itself.
  explicit ByteCache(uint64_t capacity_bytes, MemoryBudget* memory = nullptr)
      : account_(std::make_shared<ChargeAccount>(capacity_bytes, memory)) {}

  // The value of `key`; `load` is called without the lock, by one caller, while all others who ask
  // for the same key wait for its result. An error is handed to all who waited and not kept.
  // kResourceExhausted when the value does not fit beside what is in use.
  absl::StatusOr<Handle> Get(const std::string& key, const Loader& load) {
    std::unique_lock lock(mutex_);
    if (auto it = entries_.find(key); it != entries_.end()) {
      ++hits_;
      recency_.splice(recency_.begin(), recency_, it->second.place);
      return it->second.value;
    }
    if (auto it = loading_.find(key); it != loading_.end()) {
      ++hits_;
      const std::shared_ptr<Flight> flight = it->second;
      landed_.wait(lock, [&] { return flight->landed; });
      return flight->result;
    }
    ++misses_;
    const auto flight = std::make_shared<Flight>();
    loading_.emplace(key, flight);
    lock.unlock();
    absl::StatusOr<Loaded> loaded = Call(load, key);
    lock.lock();
    flight->result = Land(key, *flight, std::move(loaded));
    flight->landed = true;
    loading_.erase(key);
    landed_.notify_all();
    return flight->result;
  }

  // Forgets `key`; those who hold its handle keep the value. A load that is under way is handed to
  // those who wait but not kept.
  void Erase(const std::string& key) {
    std::lock_guard lock(mutex_);
    if (auto it = entries_.find(key); it != entries_.end()) Drop(it);
    if (auto it = loading_.find(key); it != loading_.end()) it->second->erased = true;
  }

  // Drops entries that nobody uses, the least recently used first, until `bytes` are free or none
  // is left.
  void Reclaim(uint64_t bytes) {
    std::lock_guard lock(mutex_);
    uint64_t freed = 0;
    DropUnpinned([&](const Entry& entry) {
      if (freed >= bytes) return false;
      freed += entry.charge_bytes;
      return true;
    });
  }

  ByteCacheStats stats() const {
    std::lock_guard lock(mutex_);
    ByteCacheStats stats{.used_bytes = account_->used_bytes(),
                         .capacity_bytes = account_->capacity_bytes(),
                         .num_entries = static_cast<int>(entries_.size()),
                         .hits = hits_,
                         .misses = misses_,
                         .evictions = evictions_};
    for (const auto& [key, entry] : entries_) stats.num_pinned += entry.pinned();
    return stats;
  }

 private:
  struct Entry {
    Handle value;
    uint64_t charge_bytes = 0;
    std::list<std::string>::iterator place;
    // New handles are copied from `value` under the lock or from a handle that is outside: at 1
    // nobody else can come to hold it.
    bool pinned() const { return value.use_count() > 1; }
  };
  using Entries = std::map<std::string, Entry>;
  // A loaded value with its charge: a handle points to the value and owns both. The account is
  // shared, because a handle may outlive the cache.
  struct Charged {
    Handle value;
    std::shared_ptr<ChargeAccount> account;
    Reservation charge;  // goes first
  };
  // One load under way; those who wait share it.
  struct Flight {
    bool landed = false, erased = false;
    absl::StatusOr<Handle> result = absl::UnknownError("still loading");
  };

  // An exception must not leave those who wait alone.
  static absl::StatusOr<Loaded> Call(const Loader& load, const std::string& key) {
    try {
      return load(key);
    } catch (const std::exception&) {  // memory, most likely; its text is for developers
      return absl::ResourceExhaustedError(std::string("cannot load '") + key +
                                          "': it may be too large for the memory that is left");
    }
  }

  // Makes room and takes the loaded value in. Called with the lock.
  absl::StatusOr<Handle> Land(const std::string& key, const Flight& flight,
                              absl::StatusOr<Loaded> loaded) {
    if (!loaded.ok()) return loaded.status();
    const uint64_t bytes = loaded->charge_bytes;
    DropUnpinned([&](const Entry&) { return !account_->Fits(bytes); });
    absl::StatusOr<Reservation> charge = account_->Charge(bytes, key);
    if (!charge.ok()) return charge.status();
    auto charged =
        std::make_shared<Charged>(Charged{std::move(loaded->value), account_, *std::move(charge)});
    Handle handle(charged, charged->value.get());
    if (flight.erased) return handle;
    recency_.push_front(key);
    entries_.emplace(key, Entry{handle, bytes, recency_.begin()});
    return handle;
  }

  // Drops entries that nobody uses, the least recently used first, as long as `wanted` says so.
  template <typename Wanted>
  void DropUnpinned(Wanted wanted) {
    for (auto place = recency_.end(); place != recency_.begin();) {
      auto it = entries_.find(*--place);
      if (it->second.pinned()) continue;
      if (!wanted(it->second)) return;
      ++place;  // Drop removes the element before it
      Drop(it);
      ++evictions_;
    }
  }

  void Drop(typename Entries::iterator it) {
    recency_.erase(it->second.place);
    entries_.erase(it);
  }

  mutable std::mutex mutex_;
  std::condition_variable landed_;
  const std::shared_ptr<ChargeAccount> account_;
  Entries entries_;
  std::list<std::string> recency_;  // most recently used first
  std::map<std::string, std::shared_ptr<Flight>> loading_;
  uint64_t hits_ = 0, misses_ = 0, evictions_ = 0;
};

}  // namespace pleat
