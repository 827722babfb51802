// A motion and what was changed of it: keys on a layer above the take. A key holds how a joint differs
// from the take at its frame; between keys the difference is interpolated, beyond them it stays.
import type {MotionFile} from '../api/types';
import {add, inverse, kIdentity, multiply, normalize, slerp, subtract, type Quaternion, type Vector3} from '../math/quaternion';
import {restPose, type Joint, type Pose} from '../math/skeleton';

export interface Motion { fps: number; frames: readonly Pose[] }
export interface TurnKey { frame: number; turn: Quaternion }
export interface MoveKey { frame: number; move: Vector3 }
// Never changed: an edit makes a new one, so that undo keeps the old.
export interface Edits { turns: ReadonlyMap<number, readonly TurnKey[]>; moves: readonly MoveKey[] }
export const kNoEdits: Edits = {turns: new Map(), moves: []};

// The two keys around a frame and how far it lies between them.
function around<K extends {frame: number}>(keys: readonly K[], frame: number): [K, K, number] {
  const next = keys.findIndex((key) => key.frame >= frame);
  if (next < 0) return [keys[keys.length - 1]!, keys[keys.length - 1]!, 0];
  if (next === 0) return [keys[0]!, keys[0]!, 0];
  const a = keys[next - 1]!, b = keys[next]!;
  return [a, b, (frame - a.frame) / (b.frame - a.frame)];
}

const turnAt = (keys: readonly TurnKey[] | undefined, frame: number): Quaternion => {
  if (!keys?.length) return kIdentity;
  const [a, b, fraction] = around(keys, frame);
  return slerp(a.turn, b.turn, fraction);
};
const moveAt = (keys: readonly MoveKey[], frame: number): Vector3 => {
  if (!keys.length) return [0, 0, 0];
  const [a, b, fraction] = around(keys, frame);
  return [0, 1, 2].map((i) => a.move[i]! + fraction * (b.move[i]! - a.move[i]!)) as unknown as Vector3;
};

export function poseAt(motion: Motion, edits: Edits, frame: number): Pose {
  const base = motion.frames[frame]!;
  if (edits === kNoEdits) return base;
  return {
    root: add(base.root, moveAt(edits.moves, frame)),
    rotations: base.rotations.map((turn, b) => {
      const keys = edits.turns.get(b);
      return keys ? normalize(multiply(turn, turnAt(keys, frame))) : turn;
    }),
  };
}

function withKey<K extends {frame: number}>(keys: readonly K[], key: K): K[] {
  return [...keys.filter((other) => other.frame !== key.frame), key].sort((a, b) => a.frame - b.frame);
}

const kSame = 1e-7;

// Keys at `frame` for every joint that `pose` changes.
export function keyPose(motion: Motion, edits: Edits, frame: number, pose: Pose): Edits {
  const base = motion.frames[frame]!, now = poseAt(motion, edits, frame);
  const turns = new Map(edits.turns);
  pose.rotations.forEach((turn, b) => {
    const change = multiply(inverse(now.rotations[b]!), turn);
    if (1 - Math.abs(change[0]) < kSame * kSame) return;
    turns.set(b, withKey(turns.get(b) ?? [], {frame, turn: normalize(multiply(inverse(base.rotations[b]!), turn))}));
  });
  const moved = subtract(pose.root, now.root);
  const moves = Math.hypot(...moved) < kSame ? edits.moves
    : withKey(edits.moves, {frame, move: subtract(pose.root, base.root)});
  return {turns, moves};
}

// A key at `frame` that holds what the joint does there now.
export function insertKey(edits: Edits, frame: number, joint: number): Edits {
  const turns = new Map(edits.turns);
  turns.set(joint, withKey(turns.get(joint) ?? [], {frame, turn: turnAt(turns.get(joint), frame)}));
  return {turns, moves: joint === 0 ? withKey(edits.moves, {frame, move: moveAt(edits.moves, frame)}) : edits.moves};
}

// Without the keys at `frame`: of one joint, or of all with -1.
export function removeKeys(edits: Edits, frame: number, joint: number): Edits {
  const turns = new Map<number, readonly TurnKey[]>();
  for (const [b, keys] of edits.turns) {
    const left = joint < 0 || joint === b ? keys.filter((key) => key.frame !== frame) : keys;
    if (left.length) turns.set(b, left);
  }
  return {turns, moves: joint <= 0 ? edits.moves.filter((key) => key.frame !== frame) : edits.moves};
}

// Without any edit of one joint.
export function resetJoint(edits: Edits, joint: number): Edits {
  const turns = new Map(edits.turns);
  turns.delete(joint);
  return {turns, moves: joint === 0 ? [] : edits.moves};
}

export const keyedFrames = (edits: Edits, joint: number): Set<number> => new Set([
  ...[...edits.turns].flatMap(([b, keys]) => joint < 0 || joint === b ? keys.map((key) => key.frame) : []),
  ...(joint <= 0 ? edits.moves.map((key) => key.frame) : []),
]);
export const isEdited = (edits: Edits): boolean => edits.turns.size > 0 || edits.moves.length > 0;

// Files have the joints in any order, and may leave some at rest.
export function motionFromFile(file: MotionFile, joints: readonly Joint[]): Motion {
  const places = joints.map((joint) => file.joints.indexOf(joint.name));
  const rest = restPose(joints);
  return {
    fps: file.fps,
    frames: file.frames.map((frame) => ({
      root: frame.root_translation as unknown as Vector3,
      rotations: places.map((place, b) => place < 0 ? rest.rotations[b]!
        : normalize(frame.rotations[place] as unknown as Quaternion)),
    })),
  };
}
export function motionToFile(motion: Motion, edits: Edits, joints: readonly Joint[]): MotionFile {
  return {
    schema: 'pleat.motion/1', fps: motion.fps, joints: joints.map((joint) => joint.name),
    frames: motion.frames.map((_, frame) => {
      const pose = poseAt(motion, edits, frame);
      return {root_translation: [...pose.root], rotations: pose.rotations.map((turn) => [...turn])};
    }),
  };
}
export const restMotion = (joints: readonly Joint[], numFrames: number, fps: number): Motion =>
  ({fps, frames: Array.from({length: numFrames}, () => restPose(joints))});

// As text, for what a reload must not lose.
export const editsToJson = (edits: Edits): string => JSON.stringify({turns: [...edits.turns], moves: edits.moves});
export function editsFromJson(text: string): Edits {
  const {turns, moves} = JSON.parse(text) as {turns: [number, TurnKey[]][]; moves: MoveKey[]};
  return {turns: new Map(turns), moves};
}
