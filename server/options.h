// The command line of pleatd.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "exposure.h"
#include "pleat/grpc/grpc_server.h"
#include "pleat/http/studio_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/observe/logging.h"

namespace pleat {

struct ServerOptions {
  LocalServiceOptions service;
  GrpcServerOptions grpc;
  LoggingOptions logging;
  StudioOptions studio;          // an empty address: no pages are served
  std::string shared_model;      // id of the model that the studio shows to everybody; empty = none
  std::string metrics_listen;    // HOST:PORT, empty = no metrics
  std::string token_file;        // who may call; it need not exist
  std::string audit_log;         // empty = none
  Exposure exposure;             // checked by ParseCommandLine
  double slow_call_seconds = 1;  // longer calls are a warning in the log
  double drain_seconds = 10;     // running calls may go on for so long after SIGTERM
};

// What the command line asks for: options, or a text to print and an exit code (for --help, for
// --version and for wrong flags). Parsing reads the token file.
struct CommandLine {
  ServerOptions options;
  bool exit = false;
  int exit_code = 0;
  std::string message;
};
CommandLine ParseCommandLine(int argc, const char* const* argv);

}  // namespace pleat
