#include "rest_shape.h"

#include "field_coder.h"
#include "pleat/base/status.h"
#include "pleat/geometry/surface_hierarchy.h"

namespace pleat {

absl::Status CodeRestShape(const Topology& topology, float step_m, BinaryCoder* coder,
                           Eigen::Matrix3Xf* rest) {
  const SurfaceHierarchy hierarchy(topology, nullptr);  // there are no positions yet
  FieldMatrix field(topology.num_vertices(), 3);
  if (!coder->decoding()) field = rest->transpose();
  PLEAT_RETURN_IF_ERROR(CodeFields(hierarchy, step_m, coder, &field));
  *rest = field.transpose();
  return absl::OkStatus();
}

}  // namespace pleat
