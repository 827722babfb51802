// Poses and forward kinematics, as lib/skeleton has them: bone b ends in joint b and turns about the
// parent of b; rotations are relative to the bone before, in the axes of the rest pose.
import {add, kIdentity, multiply, rotate, scale, subtract, type Quaternion, type Vector3} from './quaternion';

export interface Joint { name: string; parent: number; rest: Vector3 }
export interface Pose { root: Vector3; rotations: readonly Quaternion[] }

export const restPose = (joints: readonly Joint[]): Pose => ({root: joints[0]!.rest, rotations: joints.map(() => kIdentity)});

export interface PlacedPose { positions: Vector3[]; turns: Quaternion[] }  // in the world, one for each joint and bone

export function placeJoints(joints: readonly Joint[], pose: Pose): PlacedPose {
  const turns: Quaternion[] = [pose.rotations[0]!];
  const positions: Vector3[] = [pose.root];
  for (let b = 1; b < joints.length; ++b) {
    const parent = joints[b]!.parent;
    turns[b] = multiply(turns[parent]!, pose.rotations[b]!);
    positions[b] = add(positions[parent]!, rotate(turns[b]!, subtract(joints[b]!.rest, joints[parent]!.rest)));
  }
  return {positions, turns};
}

// The skeleton with other lengths of bones. factors: one for each joint, or none.
export function scaledJoints(joints: readonly Joint[], factors: readonly number[]): readonly Joint[] {
  if (factors.length === 0) return joints;
  const scaled: Joint[] = [];
  joints.forEach((joint, b) => scaled.push(joint.parent < 0 ? joint : {...joint,
    rest: add(scaled[joint.parent]!.rest, scale(subtract(joint.rest, joints[joint.parent]!.rest), factors[b]!))}));
  return scaled;
}

export function childrenOf(joints: readonly Joint[], joint: number): number[] {
  return joints.flatMap((other, index) => other.parent === joint ? [index] : []);
}

// "leftHand" -> "left hand"
export const readableName = (name: string): string =>
  name.replace(/([a-z])([A-Z])/g, (_, a: string, b: string) => `${a} ${b.toLowerCase()}`).replace(/_/g, ' ');
