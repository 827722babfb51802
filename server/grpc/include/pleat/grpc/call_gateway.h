// Calls that reach this server by another way than gRPC, such as from a browser. They go through
// the server's own channel in this process, so admission, limits, quotas, metrics and the audit log
// are those of every other call. Messages are the bytes of the protobufs of the method.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace pleat {

// On whose behalf a call is made. What it says is believed, because only this process can say it.
struct ForeignCaller {
  std::string token{};  // without "Bearer "; empty: none
  std::string peer{};   // as gRPC writes it: "ipv4:10.0.0.7:52114"
  std::string request_id{};
  // Ids, separated by commas, of the content that it sees without a token; empty: as tokens say.
  std::string shared{};
};

// One call with at most one message under way in each direction. Not for two threads at once.
// Destroying it cancels the call.
class GatewayCall {
 public:
  enum class Got { kMessage, kNothingYet, kEnd };

  virtual ~GatewayCall() = default;
  // False: the call is over, and Finish says why.
  virtual bool Send(std::string_view message) = 0;
  virtual void SendNoMore() = 0;
  // Waits so long at most. kNothingYet: ask again; the message is kept.
  virtual Got Receive(std::string* message, double patience_seconds) = 0;
  // Ask after kEnd, or when Send gave false.
  virtual absl::Status Finish() = 0;
};

// What a call in both directions tells, from threads of gRPC, one at a time.
struct DuplexListener {
  std::function<void(std::string message)> on_message{};
  std::function<void()> on_sent{};
  std::function<void(const absl::Status& status)> on_end{};  // the last
};

// A call in both directions that blocks nobody. Thread-safe; after the end nothing has an effect.
class DuplexCall {
 public:
  virtual ~DuplexCall() = default;
  virtual void Send(std::string_view message) = 0;  // the next one after on_sent
  virtual void ReceiveNext() = 0;                   // the next one after on_message
  virtual void Cancel() = 0;
};

// Thread-safe. Its calls must end before the server does.
class CallGateway {
 public:
  virtual ~CallGateway() = default;
  // method: "/pleat.v1.ModelService/GetModel".
  virtual std::unique_ptr<GatewayCall> Start(const std::string& method,
                                             const ForeignCaller& caller) = 0;
  // The call lives until its end, however long the pointer does.
  virtual std::shared_ptr<DuplexCall> Open(const std::string& method, const ForeignCaller& caller,
                                           DuplexListener listener) = 0;
};

}  // namespace pleat
