// Where the checkout is: tests read golden files, documents and scripts from it.
#pragma once

#include <string>

namespace pleat {

// Absolute path of `relative` in the checkout that the tests were built from. Compiled once: on the
// command line of every test the path would make the compiler cache miss from one clone to the
// next.
std::string InSourceFolder(const std::string& relative);

}  // namespace pleat
