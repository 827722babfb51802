// The parts of the module pleat._pleat, one file each.
#pragma once

#include <pybind11/pybind11.h>

namespace pleat {

void BindSequences(pybind11::module_& module);    // Sequence, read, performer
void BindRigs(pybind11::module_& module);         // Rig, rig
void BindMotions(pybind11::module_& module);      // Motion
void BindCharacters(pybind11::module_& module);   // Character, train
void BindCodec(pybind11::module_& module);        // compress, decompress
void BindExperiments(pybind11::module_& module);  // experiment, experiment_names
void BindStreams(pybind11::module_& module);      // StreamDecoder

}  // namespace pleat
