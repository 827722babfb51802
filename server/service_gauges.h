// What the service of this process says of itself to the metrics.
#pragma once

#include "pleat/grpc/grpc_server.h"
#include "pleat/local/local_character_service.h"
#include "pleat/metrics/server_metrics.h"

namespace pleat {

// Both must outlive the metrics' last answer.
void AddServiceGauges(LocalCharacterService* service, ServerMetrics* metrics);
void AddNetworkGauges(const GrpcServer* server, ServerMetrics* metrics);

}  // namespace pleat
