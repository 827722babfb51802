#include "pleat.h"

extern "C" {

uint32_t pleat_api_version(void) { return PLEAT_API_VERSION; }

const char* pleat_version(void) { return PLEAT_VERSION; }

}  // extern "C"
