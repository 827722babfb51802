// Dragging a joint: two-bone inverse kinematics for the ends of limbs, a swing of one bone for all
// other joints, and a move of the whole body for the root.
import {add, between, cross, dot, inverse, length, multiply, normalize, rotate, scale, subtract, unit, type Quaternion,
  type Vector3} from './quaternion';
import {childrenOf, placeJoints, type Joint, type Pose} from './skeleton';

// Whether a joint is the end of two bones that bend: hands and feet.
export function isLimbEnd(joints: readonly Joint[], joint: number): boolean {
  if (!/hand|foot|wrist|ankle/i.test(joints[joint]!.name)) return false;
  const middle = joints[joint]!.parent;
  return middle > 0 && joints[middle]!.parent > 0;
}

// The pose in which `joint` comes as near to `target` (world, meters) as its bones allow.
export function dragJoint(joints: readonly Joint[], pose: Pose, joint: number, target: Vector3): Pose {
  if (joint === 0) return {root: target, rotations: pose.rotations};
  return isLimbEnd(joints, joint) ? bendLimb(joints, pose, joint, target) : swingBone(joints, pose, joint, target);
}

function swingBone(joints: readonly Joint[], pose: Pose, joint: number, target: Vector3): Pose {
  const {positions, turns} = placeJoints(joints, pose);
  const pivot = positions[joints[joint]!.parent]!;
  const swing = between(subtract(positions[joint]!, pivot), subtract(target, pivot));
  return withTurns(joints, pose, new Map([[joint, multiply(swing, turns[joint]!)]]), turns);
}

// The middle joint stays in the plane in which the limb bends now; what hangs at the end (hand to
// fingers, foot to toes) keeps its direction in the world.
function bendLimb(joints: readonly Joint[], pose: Pose, end: number, target: Vector3): Pose {
  const middle = joints[end]!.parent, start = joints[middle]!.parent;
  const {positions, turns} = placeJoints(joints, pose);
  const a = positions[start]!, b = positions[middle]!, c = positions[end]!;
  const upper = length(subtract(b, a)), lower = length(subtract(c, b));
  const along = unit(subtract(target, a));
  // Never quite straight, so that the plane of the bend is not lost.
  const reach = Math.max(Math.abs(upper - lower) * 1.001 + 1e-6,
    Math.min(length(subtract(target, a)), (upper + lower) * .9995));
  const cosine = Math.max(-1, Math.min(1, (upper * upper + reach * reach - lower * lower) / (2 * upper * reach)));
  // Where the middle joint is beside the line to the end, carried over to the new line.
  const carry = between(subtract(c, a), along);
  let side = rotate(carry, subtract(subtract(b, a), scale(unit(subtract(c, a)), dot(subtract(b, a), unit(subtract(c, a))))));
  if (length(side) < 1e-4) side = cross(along, Math.abs(along[1]) < .9 ? [0, 1, 0] : [1, 0, 0]);
  side = unit(subtract(side, scale(along, dot(side, along))));
  const newB = add(a, add(scale(along, upper * cosine), scale(side, upper * Math.sqrt(1 - cosine * cosine))));
  const newC = add(a, scale(along, reach));
  const turnUpper = multiply(between(subtract(b, a), subtract(newB, a)), turns[middle]!);
  const carried = rotate(multiply(turnUpper, inverse(turns[middle]!)), subtract(c, b));
  const turnLower = multiply(between(carried, subtract(newC, newB)),
    multiply(multiply(turnUpper, inverse(turns[middle]!)), turns[end]!));
  const wanted = new Map<number, Quaternion>([[middle, turnUpper], [end, turnLower]]);
  for (const child of childrenOf(joints, end)) wanted.set(child, turns[child]!);
  return withTurns(joints, pose, wanted, turns);
}

// The pose in which the bones of `wanted` have these turns in the world, and all others keep theirs
// relative to their parents.
function withTurns(joints: readonly Joint[], pose: Pose, wanted: Map<number, Quaternion>,
                   before: readonly Quaternion[]): Pose {
  const rotations = [...pose.rotations];
  for (const [bone, turn] of wanted) {
    const parent = joints[bone]!.parent;
    rotations[bone] = normalize(multiply(inverse(wanted.get(parent) ?? before[parent]!), turn));
  }
  return {root: pose.root, rotations};
}
