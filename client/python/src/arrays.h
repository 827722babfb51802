// Arrays of callers and for them. Matrices of ours have a vertex per column, NumPy's arrays a
// vertex per row: with three float32 each, the bytes are the same.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "pleat/skeleton/pose.h"

namespace pleat {

// Arrays that are converted where another type or layout is given.
template <typename Value>
using TakenArray = pybind11::array_t<Value, pybind11::array::c_style | pybind11::array::forcecast>;

// Raises pleat.Error when `array` has another shape; -1 in `shape` allows any size.
void CheckShape(const pybind11::array& array, std::initializer_list<pybind11::ssize_t> shape,
                const std::string& name);

// A new array of that shape.
template <typename Value>
pybind11::array_t<Value> NewArray(std::vector<pybind11::ssize_t> shape) {
  return pybind11::array_t<Value>(std::move(shape));
}

// The array that results are written into: `out` itself, which must be a writable float32 array of
// that shape whose rows are contiguous (it is never copied), or a new one when it is none.
pybind11::array_t<float> TakeOut(const pybind11::object& out,
                                 std::initializer_list<pybind11::ssize_t> shape);

// Poses from root positions (N x 3) and rotations (N x J x 4, x, y, z, w), whose shapes were
// checked.
std::vector<Pose> TakePoses(const TakenArray<double>& root_positions,
                            const TakenArray<double>& rotations);

// The same the other way round.
pybind11::array_t<double> RootPositionsOf(const std::vector<Pose>& poses);
pybind11::array_t<double> RotationsOf(const std::vector<Pose>& poses);

}  // namespace pleat
