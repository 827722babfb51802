#include "bindings.h"
#include "python_error.h"

PYBIND11_MODULE(_pleat, module) {
  module.doc() = "Pleat in this process; use the package pleat, which documents it.";
  module.attr("__version__") = PLEAT_VERSION;
  pleat::BindErrors(module);
  pleat::BindSequences(module);
  pleat::BindRigs(module);
  pleat::BindMotions(module);
  pleat::BindCharacters(module);
  pleat::BindCodec(module);
  pleat::BindExperiments(module);
  pleat::BindStreams(module);
}
