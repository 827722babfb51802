// The base of every reactor, and the one scheme of who owns them.
//
// A reactor is the server's side of one call. gRPC drives it by callbacks (OnReadDone, OnWriteDone,
// OnCancel, OnDone), tasks on executors do its work, and listeners of the service wake it.
//
// Owners. gRPC owns a reactor from StartReactor until OnDone: `self_` is its share. Every task that
// waits on an executor (Post) and every foreign callback that says so (Hold) owns it as well. The
// last owner destroys it; nothing here ever says `delete`. A task that was still queued when gRPC
// let go finds the call finished and returns at once: the request, the response and the
// CallbackServerContext belong to gRPC and are gone after OnDone.
//
// Threads. OnReadDone, OnWriteDone and OnCancel may run at the same time as each other, as a task,
// and as the function that called StartRead, StartWrite or Finish and has not returned yet. Two of
// one kind never overlap, because a reactor has at most one read and one write under way. A reactor
// is therefore either strictly sequential (exactly one read, write or task is under way, and its
// end starts the next: unary calls, uploads, pull streams) or guards its state by one mutex
// (watches, live sessions).
//
// The end. Finish is called once, by the step that finds the call over, when no task and no write
// is under way; a read may be, since gRPC ends it. Before Finish the reactor lets go of what it has
// from the service (model, upload, subscription): whoever has read the status finds it free, and no
// listener calls a reactor that has ended. OnDone is gRPC's last callback: it comes after Finish,
// when every read, write and callback is over.
//
// Cancellation. OnCancel tells that the client is gone, its deadline has passed or the server no
// longer waits. It only leaves a note, for whoever is at work may be using everything else; the
// read or write under way ends with ok = false, and the next step calls Finish.
//
// The server counts the objects (OpenCalls) and outlives them, hence the context is always there.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "pleat/base/executor.h"
#include "pleat/observe/request_scope.h"
#include "pleat/reactors/handler_context.h"

namespace pleat {

// GrpcReactor: grpc::ServerUnaryReactor, grpc::ServerReadReactor<Request>, ... A derived class has
// a public function Start, which starts its first read or task.
template <typename GrpcReactor>
class CallReactor : public GrpcReactor,
                    public std::enable_shared_from_this<CallReactor<GrpcReactor>> {
 public:
  void OnDone() final { self_.reset(); }

 protected:
  // A reactor is made inside the scope of its request and keeps the tag for all that it does.
  explicit CallReactor(HandlerContext* context)
      : open_call_(&context->calls->open_calls), request_(CurrentRequest()) {}

  // For RequestScope, around what does not run by Post.
  const RequestTag& request() const { return request_; }

  // Keeps the reactor alive. Call it where it still is: before Finish.
  std::shared_ptr<const void> Hold() { return this->shared_from_this(); }

  // Runs `task`, which must not throw, on `executor`; the reactor lives until it has run.
  template <typename Task>
  void Post(Executor* executor, Task task, uint64_t flow = 0,
            TurnKind kind = TurnKind::kInteractive) {
    executor->Post(
        [this, hold = Hold(), task = std::move(task)]() mutable {
          const RequestScope scope(request_);
          task();
        },
        flow, kind);
  }

 private:
  template <typename Reactor, typename... Arguments>
  friend Reactor* StartReactor(Arguments&&... arguments);

  const OpenCalls::Entry open_call_;
  const RequestTag request_;           // of the call
  std::shared_ptr<CallReactor> self_;  // gRPC's share
};

// The only way to make a reactor: what it gives belongs to gRPC.
template <typename Reactor, typename... Arguments>
Reactor* StartReactor(Arguments&&... arguments) {
  const auto reactor = std::make_shared<Reactor>(std::forward<Arguments>(arguments)...);
  reactor->self_ = reactor;
  reactor->Start();
  return reactor.get();
}

}  // namespace pleat
