// How a client reaches a server.
#pragma once

#include <string>

#include "pleat/stream/frame_encoder.h"

namespace pleat {

struct RemoteOptions {
  double connect_seconds = 5;    // until Connect gives up
  double deadline_seconds = 60;  // of one call that is no stream
  int max_attempts = 5;          // of an upload, download or watch that breaks off
  // How EvaluateClip encodes its frames; 16 bits are about .02 mm on a person. Live sessions choose
  // their own encoding.
  FrameEncoderOptions stream{.position_bits = 16};
  bool tls = false;
  std::string tls_root_certificates{};                     // PEM; empty = those of the system
  std::string tls_client_certificate{}, tls_client_key{};  // PEM; for servers that ask for them
};

}  // namespace pleat
