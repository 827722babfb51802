#include "alembic_xform.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

#include "absl/strings/str_cat.h"
#include "pleat/base/status.h"

namespace pleat {
namespace {

// The upper four bits of an operation.
enum XformOperation : uint8_t {
  kScale = 0,
  kTranslate = 1,
  kRotate = 2,  // about an axis
  kMatrix = 3,
  kRotateX = 4,
  kRotateY = 5,
  kRotateZ = 6,
};

// How many numbers an operation takes; 0 when it is unknown.
int NumNumbers(uint8_t operation) {
  switch (operation >> 4) {
    case kScale:
    case kTranslate:
      return 3;
    case kRotate:
      return 4;
    case kMatrix:
      return 16;
    case kRotateX:
    case kRotateY:
    case kRotateZ:
      return 1;
    default:
      return 0;
  }
}

// A turn about `axis` by degrees, for row vectors. No axis is no turn.
Eigen::Matrix4d RotationRows(const Eigen::Vector3d& axis, double degrees) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  const double length = axis.norm();
  if (!(length > 0)) return matrix;
  const Eigen::Vector3d unit = axis / length;
  const double radians = degrees * (std::numbers::pi / 180);
  const double sine = std::sin(radians), cosine = std::cos(radians), rest = 1 - cosine;
  const double x = unit.x(), y = unit.y(), z = unit.z();
  matrix.topLeftCorner<3, 3>() << x * x * rest + cosine, x * y * rest + z * sine,
      x * z * rest - y * sine,  //
      x * y * rest - z * sine, y * y * rest + cosine, y * z * rest + x * sine,
      x * z * rest + y * sine, y * z * rest - x * sine, z * z * rest + cosine;
  return matrix;
}

// One operation. numbers: as many as NumNumbers says.
Eigen::Matrix4d OperationRows(uint8_t operation, std::span<const double> numbers) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  switch (operation >> 4) {
    case kScale:
      for (int i = 0; i < 3; ++i) matrix(i, i) = numbers[i];
      return matrix;
    case kTranslate:
      for (int i = 0; i < 3; ++i) matrix(3, i) = numbers[i];
      return matrix;
    case kRotate:
      return RotationRows({numbers[0], numbers[1], numbers[2]}, numbers[3]);
    case kMatrix:
      for (int i = 0; i < 16; ++i) matrix(i / 4, i % 4) = numbers[i];
      return matrix;
    default:
      return RotationRows(Eigen::Vector3d::Unit((operation >> 4) - kRotateX), numbers[0]);
  }
}

// When the samples of a property are. Samples that are all equal count as one.
absl::StatusOr<AlembicTimes> FindTimes(const AlembicProperty& property, int64_t max_samples,
                                       const AlembicArchive& archive) {
  if (property.num_samples > max_samples) {
    return absl::ResourceExhaustedError(absl::StrCat(property.num_samples, " samples are over the ",
                                                     "limit of ", max_samples, " frames"));
  }
  AlembicTimes times = {.number = property.time_sampling};
  if (property.changes()) times.num_samples = static_cast<int>(property.num_samples);
  PLEAT_ASSIGN_OR_RETURN(times.sampling, archive.TimeSampling(property.time_sampling));
  PLEAT_RETURN_IF_ERROR(CheckTimes(times));
  return times;
}

}  // namespace

absl::StatusOr<AlembicXform> AlembicXform::Read(int object, int64_t max_samples,
                                                AlembicArchive* archive) {
  PLEAT_ASSIGN_OR_RETURN(const AlembicProperties all,
                         AlembicProperties::Read(archive->objects()[object].properties, archive));
  PLEAT_ASSIGN_OR_RETURN(const AlembicProperties properties, all.Compound(".xform", archive));
  AlembicXform xform;
  PLEAT_RETURN_IF_ERROR(xform.ReadOperations(properties, archive));
  PLEAT_RETURN_IF_ERROR(xform.ReadInherits(properties, max_samples, archive));
  PLEAT_RETURN_IF_ERROR(xform.ReadNumbers(properties, max_samples, archive));
  return xform;
}

absl::Status AlembicXform::ReadOperations(const AlembicProperties& properties,
                                          AlembicArchive* archive) {
  const AlembicProperty* operations = properties.Find(".ops");
  if (operations == nullptr || operations->num_samples == 0) return absl::OkStatus();
  if (operations->kind == AlembicKind::kCompound || operations->type != AlembicType::kUint8) {
    return absl::InvalidArgumentError("the operations of the transform are no bytes");
  }
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, ReadSampleValues(*operations, 0, archive));
  for (const char byte : bytes) {
    const auto operation = static_cast<uint8_t>(byte);
    const int needed = NumNumbers(operation);
    if (needed == 0) {
      return absl::InvalidArgumentError(absl::StrCat("operation ", operations_.size(),
                                                     " of the transform has the unknown type ",
                                                     operation >> 4));
    }
    operations_.push_back(operation);
    num_numbers_ += needed;
  }
  return absl::OkStatus();
}

absl::Status AlembicXform::ReadInherits(const AlembicProperties& properties, int64_t max_samples,
                                        AlembicArchive* archive) {
  const AlembicProperty* inherits = properties.Find(".inherits");
  if (inherits == nullptr || inherits->num_samples == 0 ||
      !inherits->Is(AlembicKind::kScalar, AlembicType::kBool, 1)) {
    return absl::OkStatus();
  }
  inherits_ = *inherits;
  PLEAT_ASSIGN_OR_RETURN(inherits_times_, FindTimes(inherits_, max_samples, *archive));
  PLEAT_ASSIGN_OR_RETURN(const std::string_view first, ReadSampleValues(inherits_, 0, archive));
  may_inherit_ = inherits_.changes() || first.empty() || first[0] != 0;
  return absl::OkStatus();
}

absl::Status AlembicXform::ReadNumbers(const AlembicProperties& properties, int64_t max_samples,
                                       AlembicArchive* archive) {
  const AlembicProperty* values = properties.Find(".vals");
  if (num_numbers_ == 0 || values == nullptr || values->num_samples == 0) {
    operations_.clear();  // nothing to apply: the identity
    return absl::OkStatus();
  }
  if (values->kind == AlembicKind::kCompound || values->type != AlembicType::kFloat64) {
    return absl::InvalidArgumentError("the numbers of the transform are no float64");
  }
  values_ = *values;
  PLEAT_ASSIGN_OR_RETURN(times_, FindTimes(values_, max_samples, *archive));
  return absl::OkStatus();
}

absl::StatusOr<AlembicXform::State> AlembicXform::At(double seconds,
                                                     AlembicArchive* archive) const {
  State state;
  if (inherits_times_.sampling != nullptr) {
    const TimePlace place = FindTime(inherits_times_, seconds);
    PLEAT_ASSIGN_OR_RETURN(
        const std::string_view inherits,
        ReadSampleValues(inherits_, static_cast<uint32_t>(place.before), archive));
    state.inherits = inherits.empty() || inherits[0] != 0;
  }
  if (operations_.empty()) return state;
  state.place = FindTime(times_, seconds);
  PLEAT_ASSIGN_OR_RETURN(state.before,
                         FindSample(values_, static_cast<uint32_t>(state.place.before), *archive));
  PLEAT_ASSIGN_OR_RETURN(state.after,
                         FindSample(values_, static_cast<uint32_t>(state.place.after), *archive));
  return state;
}

absl::StatusOr<std::vector<double>> AlembicXform::NumbersOf(OgawaRef sample,
                                                            AlembicArchive* archive) const {
  PLEAT_ASSIGN_OR_RETURN(const std::string_view bytes, ReadValues(values_, sample, archive));
  std::vector<double> numbers(static_cast<size_t>(num_numbers_));
  if (bytes.size() < numbers.size() * sizeof(double)) {
    return absl::DataLossError(absl::StrCat("a sample of the transform has ",
                                            bytes.size() / sizeof(double),
                                            " numbers; its operations need ", num_numbers_));
  }
  std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(double));
  return numbers;
}

absl::StatusOr<Eigen::Matrix4d> AlembicXform::MatrixOf(const State& state,
                                                       AlembicArchive* archive) const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (operations_.empty()) return matrix;
  PLEAT_ASSIGN_OR_RETURN(std::vector<double> numbers, NumbersOf(state.before, archive));
  if (state.before != state.after) {
    PLEAT_ASSIGN_OR_RETURN(const std::vector<double> after, NumbersOf(state.after, archive));
    for (size_t i = 0; i < numbers.size(); ++i) {
      numbers[i] += state.place.weight * (after[i] - numbers[i]);
    }
  }
  std::span<const double> rest(numbers);
  for (const uint8_t operation : operations_) {
    const auto used = static_cast<size_t>(NumNumbers(operation));
    matrix = MultiplyRows(OperationRows(operation, rest.first(used)), matrix);
    rest = rest.subspan(used);
  }
  return matrix;
}

Eigen::Matrix4d MultiplyRows(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b) {
  Eigen::Matrix4d product;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      product(i, k) = a(i, 0) * b(0, k) + a(i, 1) * b(1, k) + a(i, 2) * b(2, k) + a(i, 3) * b(3, k);
    }
  }
  return product;
}

}  // namespace pleat
