// How a client reaches a server.
#pragma once

#include <string>

#include "pleat/stream/frame_encoder.h"

namespace pleat {

struct RemoteOptions {
  double connect_seconds = 5;    // the time after which Connect gives up
  double deadline_seconds = 60;  // the longest time of a call that is no stream
  // Attempts in a row for an upload, a download or a watch, and for a call that a limit refused.
  int max_attempts = 5;
  // When a limit refuses a call, the server says how long to wait; a longer time is an error.
  double max_retry_seconds = 60;
  // How the frames of EvaluateClip and EvaluatePose are encoded. With 16 bits, positions on a
  // person are off by at most about .02 mm. Live sessions choose their own encoding.
  FrameEncoderOptions stream{.position_bits = 16};
  bool tls = false;
  std::string tls_root_certificates{};                     // PEM; empty: those of the system
  std::string tls_client_certificate{}, tls_client_key{};  // PEM, for servers that ask
  // Sent with every call. Connect refuses to send it to another machine without TLS.
  std::string token{};
};

}  // namespace pleat
