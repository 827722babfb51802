#include "pleat/base/status.h"
#include "pleat/mesh/topology.h"
