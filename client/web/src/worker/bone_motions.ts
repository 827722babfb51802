// How bones move, as a shader reads it: four texels of four numbers for each bone, the rows of the matrix
// [linear | translation], and the quaternion (x, y, z, w) of the axes of its details. lib/skeleton has the
// same (ComputeBoneTransforms), and lib/skinning (FrameSkinning::SetMotions).
import {add, dot, kIdentity, multiply, rotate, scale, subtract, type Quaternion, type Vector3} from '../math/quaternion';
import type {Pose} from '../math/skeleton';
import type {PageCharacter} from './page_character';

export const kMotionNumbers = 16;

// withRoot: all bones move with the root, as those of models that learn all deformation.
export function boneMotions({head}: PageCharacter, pose: Pose, boneScales: readonly number[], detailed: boolean): Float32Array {
  const {joints} = head, motions = new Float32Array(kMotionNumbers * joints.length);
  const withRoot = detailed && head.deformation === 'full';
  const turns: Quaternion[] = [pose.rotations[0]!], positions: Vector3[] = [pose.root];
  joints.forEach(({parent, rest}, b) => {
    if (b > 0) turns[b] = multiply(turns[parent]!, pose.rotations[b]!);
    const pivotRest = b === 0 ? rest : joints[parent]!.rest, pivot = b === 0 ? pose.root : positions[parent]!;
    const bone = subtract(rest, pivotRest), along = dot(bone, bone);
    const stretch = b > 0 && boneScales.length && along > 0 ? (boneScales[b]! - 1) / along : 0;
    const linear = (v: Vector3): Vector3 => rotate(turns[b]!, add(v, scale(bone, stretch * dot(bone, v))));
    if (b > 0) positions[b] = add(pivot, linear(bone));
    const axes: Quaternion = head.detail_axes === 'world' ? kIdentity : head.detail_axes === 'root' ? turns[0]! : turns[b]!;
    const columns = [linear([1, 0, 0]), linear([0, 1, 0]), linear([0, 0, 1]), subtract(pivot, linear(pivotRest))];
    const at = kMotionNumbers * b;
    columns.forEach((column, c) => column.forEach((value, r) => { motions[at + 4 * r + c] = value; }));
    if (withRoot) motions.copyWithin(at, 0, 12);
    motions.set([axes[1], axes[2], axes[3], axes[0]], at + 12);
  });
  return motions;
}
