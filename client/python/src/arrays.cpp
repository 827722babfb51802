#include "arrays.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "python_error.h"

namespace py = pybind11;

namespace pleat {
namespace {

std::string ShapeText(std::initializer_list<py::ssize_t> shape) {
  return absl::StrCat("(",
                      absl::StrJoin(shape, ", ",
                                    [](std::string* out, py::ssize_t size) {
                                      absl::StrAppend(out, size < 0 ? "any" : absl::StrCat(size));
                                    }),
                      ")");
}

}  // namespace

void CheckShape(const py::array& array, std::initializer_list<py::ssize_t> shape,
                const std::string& name) {
  const std::vector<py::ssize_t> given(array.shape(), array.shape() + array.ndim());
  const bool fits =
      given.size() == shape.size() &&
      std::equal(given.begin(), given.end(), shape.begin(),
                 [](py::ssize_t size, py::ssize_t wanted) { return wanted < 0 || size == wanted; });
  if (fits) return;
  throw StatusException(absl::InvalidArgumentError(absl::StrCat(
      name, " has the shape (", absl::StrJoin(given, ", "), "), expected ", ShapeText(shape))));
}

py::array_t<float> TakeOut(const py::object& out, std::initializer_list<py::ssize_t> shape) {
  if (out.is_none()) return py::array_t<float>(std::vector<py::ssize_t>(shape));
  if (!py::isinstance<py::array_t<float>>(out)) {
    throw StatusException(absl::InvalidArgumentError("out is no float32 array"));
  }
  auto array = py::reinterpret_borrow<py::array_t<float>>(out);
  CheckShape(array, shape, "out");
  const bool contiguous = (array.flags() & py::array::c_style) != 0;
  if (!array.writeable() || !contiguous) {
    throw StatusException(absl::InvalidArgumentError("out must be writable and C-contiguous"));
  }
  return array;
}

std::vector<Pose> TakePoses(const TakenArray<double>& root_positions,
                            const TakenArray<double>& rotations) {
  const auto num_joints = static_cast<size_t>(rotations.shape(1));
  std::vector<Pose> poses(static_cast<size_t>(rotations.shape(0)));
  const double* root = root_positions.data();
  const double* rotation = rotations.data();
  for (Pose& pose : poses) {
    pose.root_position = Eigen::Map<const Eigen::Vector3d>(root);
    root += 3;
    pose.rotations.resize(num_joints);
    for (Eigen::Quaterniond& q : pose.rotations) {
      q.coeffs() = Eigen::Map<const Eigen::Vector4d>(rotation);
      rotation += 4;
    }
  }
  return poses;
}

py::array_t<double> RootPositionsOf(const std::vector<Pose>& poses) {
  auto array = NewArray<double>({static_cast<py::ssize_t>(poses.size()), 3});
  double* values = array.mutable_data();
  for (const Pose& pose : poses) values = std::copy_n(pose.root_position.data(), 3, values);
  return array;
}

py::array_t<double> RotationsOf(const std::vector<Pose>& poses) {
  const auto num_joints = poses.empty() ? 0 : static_cast<py::ssize_t>(poses[0].rotations.size());
  auto array = NewArray<double>({static_cast<py::ssize_t>(poses.size()), num_joints, 4});
  double* values = array.mutable_data();
  for (const Pose& pose : poses) {
    for (const Eigen::Quaterniond& q : pose.rotations) {
      values = std::copy_n(q.coeffs().data(), 4, values);
    }
  }
  return array;
}

}  // namespace pleat
