#include "cli/load/load_run.h"

#include <sys/prctl.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "pleat/base/random.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

using Clock = std::chrono::steady_clock;

// Poses that are late are still sent for this long after the end of the schedule.
constexpr double kGraceSeconds = 1;
constexpr auto kNap = std::chrono::milliseconds(50);  // the longest sleep without a look at `stop`

Clock::duration Seconds(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// Returns pose `index` of an endless walk from the first pose to the last one and back, which has
// no cuts.
const Pose& PoseToAndFro(const std::vector<Pose>& poses, size_t index) {
  if (poses.size() == 1) return poses[0];
  const size_t k = index % (2 * poses.size() - 2);
  return poses[k < poses.size() ? k : 2 * poses.size() - 2 - k];
}

// One client: a session, a sender and a receiver. In an open loop the sender has a thread of its
// own, which keeps to the schedule whatever the server does. In a closed loop one thread does both.
// Each member is written by one of the two threads; the results are read when both have ended.
class Client {
 public:
  Client(std::unique_ptr<LiveSession> session, const std::vector<Pose>& poses,
         std::vector<double> send_times, size_t first_pose, std::atomic<bool>* stop)
      : session_(std::move(session)),
        poses_(poses),
        send_times_(std::move(send_times)),
        first_pose_(first_pose),
        stop_(stop) {}

  void RunOpen(Clock::time_point start, double end_s) {
    std::thread sender([&] { SendAll(start, end_s); });
    LiveFrame frame;
    while (Take(session_->Receive(&frame), frame, start)) {
    }
    sender.join();
  }

  void RunClosed(Clock::time_point start, double end_s) {
    std::this_thread::sleep_until(start);
    LiveFrame frame;
    const Clock::time_point end = start + Seconds(end_s);
    for (size_t k = 0; Clock::now() < end && !*stop_; ++k) {
      send_times_.push_back(std::chrono::duration<double>(Clock::now() - start).count());
      const absl::Status sent = session_->Send(k, PoseToAndFro(poses_, first_pose_ + k));
      num_sent_ += sent.ok();
      if (!Take(sent.ok() ? session_->Receive(&frame) : sent, frame, start)) return;
    }
  }

  void AddTo(LoadResult* result) {
    result->num_intended += static_cast<int>(send_times_.size());
    result->num_sent += num_sent_;
    result->num_superseded += num_superseded_;
    result->num_rejected += num_rejected_;
    result->num_resumed += num_resumed_;
    result->seconds = std::max(result->seconds, last_frame_s_);
    result->clients.push_back(std::move(samples_));
  }
  const absl::Status& status() const { return status_; }
  uint64_t first_cpu_us() const { return first_cpu_us_; }
  uint64_t last_cpu_us() const { return last_cpu_us_; }

 private:
  void SendAll(Clock::time_point start, double end_s) {
    prctl(PR_SET_TIMERSLACK, 1UL);  // the default of the kernel makes every pose 50 us late
    const Clock::time_point end = start + Seconds(end_s + kGraceSeconds);
    for (size_t k = 0; k < send_times_.size() && !*stop_; ++k) {
      const Clock::time_point due = start + Seconds(send_times_[k]);
      while (Clock::now() < due && !*stop_) {
        std::this_thread::sleep_until(std::min(due, Clock::now() + kNap));
      }
      if (Clock::now() > end) break;
      if (!session_->Send(k, PoseToAndFro(poses_, first_pose_ + k)).ok()) return;
      ++num_sent_;
    }
    session_->SendDone();
  }

  // Notes one answer. Returns false at the end of the session.
  bool Take(const absl::Status& status, const LiveFrame& frame, Clock::time_point start) {
    if (session_->ended()) {
      if (status.code() != absl::StatusCode::kOutOfRange) status_ = status;
      return false;
    }
    if (!status.ok()) {
      ++num_rejected_;
      return true;
    }
    if (frame.number >= send_times_.size()) {
      status_ = absl::DataLossError("the server answered a pose that was not sent");
      *stop_ = true;
      return true;  // or the sender could wait for ever for a credit
    }
    const double now_s = std::chrono::duration<double>(Clock::now() - start).count();
    const double sent_s = send_times_[frame.number];
    samples_.push_back({.sent_s = sent_s,
                        .latency_ms = 1e3 * (now_s - sent_s),
                        .times = frame.times,
                        .num_bytes = frame.num_bytes});
    num_superseded_ += frame.num_superseded;
    num_resumed_ += frame.resumed;
    last_frame_s_ = now_s;
    if (first_cpu_us_ == 0) first_cpu_us_ = frame.times.server_cpu_us;
    last_cpu_us_ = frame.times.server_cpu_us;
    return true;
  }

  std::unique_ptr<LiveSession> session_;
  const std::vector<Pose>& poses_;
  std::vector<double> send_times_;
  const size_t first_pose_;
  std::atomic<bool>* stop_;
  std::vector<LoadSample> samples_;
  absl::Status status_;
  std::atomic<int> num_sent_ = 0;
  int num_superseded_ = 0, num_rejected_ = 0, num_resumed_ = 0;
  double last_frame_s_ = 0;
  uint64_t first_cpu_us_ = 0, last_cpu_us_ = 0;
};

}  // namespace

std::vector<double> SendTimes(const LoadOptions& options, int client) {
  std::vector<double> times;
  if (options.arrivals == Arrivals::kClosed) return times;
  Random random(options.seed + static_cast<uint64_t>(client));
  // Clients start at different times. Otherwise all of them would send at the same moments forever.
  double time = client / (options.rate_fps * options.num_clients);
  if (options.arrivals == Arrivals::kFixed) {
    const auto count = static_cast<int>(std::floor(options.seconds * options.rate_fps + 1e-9));
    for (int k = 0; k < count; ++k) times.push_back(time + k / options.rate_fps);
    return times;
  }
  while (true) {
    time += -std::log1p(-random.Uniform()) / options.rate_fps;
    if (time >= options.seconds) return times;
    times.push_back(time);
  }
}

absl::StatusOr<LoadResult> RunLoad(RemotePoses& remote, const ClipQuery& character,
                                   const std::vector<Pose>& poses, const LoadOptions& options,
                                   const std::function<bool()>& interrupted) {
  std::atomic<bool> stop = false;
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < options.num_clients; ++i) {
    PLEAT_ASSIGN_OR_RETURN(std::unique_ptr<LiveSession> session,
                           remote.OpenLiveSession(character, options.session));
    clients.push_back(std::make_unique<Client>(
        std::move(session), poses, SendTimes(options, i),
        poses.size() * static_cast<size_t>(i) / static_cast<size_t>(options.num_clients), &stop));
  }
  // The sessions are open by now. All clients share one start, a moment ahead, so that their
  // threads have begun when the schedule does.
  const Clock::time_point start = Clock::now() + kNap;
  std::atomic<int> num_running = options.num_clients;
  std::vector<std::thread> threads;
  for (const auto& client : clients) {
    threads.emplace_back([&, client = client.get()] {
      if (options.arrivals == Arrivals::kClosed) {
        client->RunClosed(start, options.seconds);
      } else {
        client->RunOpen(start, options.seconds);
      }
      --num_running;
    });
  }
  while (num_running > 0) {
    if (interrupted()) stop = true;
    std::this_thread::sleep_for(kNap);
  }
  for (std::thread& thread : threads) thread.join();
  if (interrupted()) return absl::CancelledError("interrupted");

  LoadResult result;
  uint64_t first_cpu_us = std::numeric_limits<uint64_t>::max(), last_cpu_us = 0;
  for (const auto& client : clients) {
    PLEAT_RETURN_IF_ERROR(client->status());
    client->AddTo(&result);
    if (client->first_cpu_us() == 0) continue;
    first_cpu_us = std::min(first_cpu_us, client->first_cpu_us());
    last_cpu_us = std::max(last_cpu_us, client->last_cpu_us());
  }
  if (last_cpu_us == 0) return absl::UnavailableError("the server has answered no pose in time");
  result.server_cpu_seconds = static_cast<double>(last_cpu_us - first_cpu_us) * 1e-6;
  return result;
}

}  // namespace pleat
