// mesh does not depend on gp, so its include path does not lead there.
#include "pleat/gp/kernel.h"
#include "pleat/mesh/topology.h"
