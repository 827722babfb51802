#include "machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace pleat {

uint64_t MachineMemoryBytes(const std::string& cgroup_file) {
  const uint64_t machine =
      static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  std::ifstream file(cgroup_file);
  uint64_t group = 0;
  return file >> group && group > 0 ? std::min(machine, group) : machine;
}

}  // namespace pleat
