// How much memory the process may use.
#pragma once

#include <cstdint>
#include <string>

namespace pleat {

// The memory of the machine, or that of the control group of the process where it is less.
// cgroup_file: "memory.max" of the group, which holds a number or "max".
uint64_t MachineMemoryBytes(const std::string& cgroup_file = "/sys/fs/cgroup/memory.max");

}  // namespace pleat
