// The Gaussian processes see matrices only: no include path of theirs leads to meshes.
#include "pleat/gp/kernel.h"
#include "pleat/mesh/topology.h"
