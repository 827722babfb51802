// The transforms of an Alembic archive over time.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "alembic_archive.h"
#include "alembic_properties.h"
#include "alembic_time.h"

namespace pleat {

// One object with the schema AbcGeom_Xform_v3.
class AlembicXform {
 public:
  // kInvalidArgument when an operation is unknown or has no numbers, or there are too many samples.
  static absl::StatusOr<AlembicXform> Read(int object, int64_t max_samples,
                                           AlembicArchive* archive);

  bool changes() const { return values_.changes() || inherits_.changes(); }
  // False when it is never relative to the transforms above it.
  bool may_inherit() const { return may_inherit_; }
  // When its samples are.
  const AlembicTimes& times() const { return values_.changes() ? times_ : inherits_times_; }

  // Where it stands at a time, and the samples that this comes from: equal ones give equal numbers.
  struct State {
    TimePlace place;
    OgawaRef before, after;  // the samples of its numbers
    bool inherits = true;    // whether it is relative to the transforms above it
  };
  absl::StatusOr<State> At(double seconds, AlembicArchive* archive) const;

  // Its matrix, for row vectors: p' = p * matrix, with the translation in the last row. The numbers
  // of two samples are interpolated linearly.
  absl::StatusOr<Eigen::Matrix4d> MatrixOf(const State& state, AlembicArchive* archive) const;

 private:
  absl::Status ReadOperations(const AlembicProperties& properties, AlembicArchive* archive);
  absl::Status ReadInherits(const AlembicProperties& properties, int64_t max_samples,
                            AlembicArchive* archive);
  absl::Status ReadNumbers(const AlembicProperties& properties, int64_t max_samples,
                           AlembicArchive* archive);
  absl::StatusOr<std::vector<double>> NumbersOf(OgawaRef sample, AlembicArchive* archive) const;

  std::vector<uint8_t> operations_;
  int num_numbers_ = 0;  // that the operations need
  AlembicProperty values_, inherits_;
  AlembicTimes times_, inherits_times_;  // without a sampling where there is no property
  bool may_inherit_ = true;
};

// a * b for row vectors: a is applied first. The sums are taken in the order of the reference
// library, so that the last bits are the same.
Eigen::Matrix4d MultiplyRows(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b);

}  // namespace pleat
