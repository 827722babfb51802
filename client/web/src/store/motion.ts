// A motion and what was changed of it: keys on a layer above the take. A key holds how a joint differs
// from the take at its frame; between keys the difference is interpolated, beyond them it stays.
import type {MotionFile} from '../api/types';
import {add, inverse, kIdentity, multiply, normalize, slerp, subtract, type Quaternion, type Vector3} from '../math/quaternion';
import {restPose, type Joint, type Pose} from '../math/skeleton';

// How a character is shown: factors on the lengths of bones, and on the learned detail by bones and by
// vertices, each as long as there are joints or vertices, or empty for 1.
export interface Look { skinnedOnly: boolean; boneScales: readonly number[]; jointStrengths: readonly number[]; vertexStrengths: readonly number[] }
export const kPlainLook: Look = {skinnedOnly: false, boneScales: [], jointStrengths: [], vertexStrengths: []};
export const kMaxStrength = 2;

export interface Motion { fps: number; frames: readonly Pose[]; look: Look }
// ease: between this key and the next, the change starts and ends at rest.
export interface TurnKey { frame: number; turn: Quaternion; ease?: boolean }
export interface MoveKey { frame: number; move: Vector3; ease?: boolean }
// Never changed: an edit makes a new one, so that undo keeps the old.
// strengths: of the learned detail by joint, in place of what the motion has.
export interface Edits {
  turns: ReadonlyMap<number, readonly TurnKey[]>; moves: readonly MoveKey[]; strengths: ReadonlyMap<number, number>;
}
export const kNoEdits: Edits = {turns: new Map(), moves: [], strengths: new Map()};

// The two keys around a frame and how far the change between them has gone.
function around<K extends {frame: number; ease?: boolean}>(keys: readonly K[], frame: number): [K, K, number] {
  const next = keys.findIndex((key) => key.frame >= frame);
  if (next < 0) return [keys[keys.length - 1]!, keys[keys.length - 1]!, 0];
  if (next === 0) return [keys[0]!, keys[0]!, 0];
  const a = keys[next - 1]!, b = keys[next]!;
  const fraction = (frame - a.frame) / (b.frame - a.frame);
  return [a, b, a.ease ? fraction * fraction * (3 - 2 * fraction) : fraction];
}

export const turnAt = (keys: readonly TurnKey[] | undefined, frame: number): Quaternion => {
  if (!keys?.length) return kIdentity;
  const [a, b, fraction] = around(keys, frame);
  return slerp(a.turn, b.turn, fraction);
};
export const moveAt = (keys: readonly MoveKey[], frame: number): Vector3 => {
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

// A key that replaces another keeps how that one eases.
function withKey<K extends {frame: number; ease?: boolean}>(keys: readonly K[], key: K): K[] {
  const ease = key.ease ?? keys.find((other) => other.frame === key.frame)?.ease;
  return [...keys.filter((other) => other.frame !== key.frame), {...key, ...(ease ? {ease} : {})}].sort((a, b) => a.frame - b.frame);
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
  return {...edits, turns, moves};
}

// A key at `frame` that holds what the joint does there now.
export function insertKey(edits: Edits, frame: number, joint: number): Edits {
  const turns = new Map(edits.turns);
  turns.set(joint, withKey(turns.get(joint) ?? [], {frame, turn: turnAt(turns.get(joint), frame)}));
  return {...edits, turns, moves: joint === 0 ? withKey(edits.moves, {frame, move: moveAt(edits.moves, frame)}) : edits.moves};
}

// Without the keys at `frame`: of one joint, or of all with -1.
export function removeKeys(edits: Edits, frame: number, joint: number): Edits {
  const turns = new Map<number, readonly TurnKey[]>();
  for (const [b, keys] of edits.turns) {
    const left = joint < 0 || joint === b ? keys.filter((key) => key.frame !== frame) : keys;
    if (left.length) turns.set(b, left);
  }
  return {...edits, turns, moves: joint <= 0 ? edits.moves.filter((key) => key.frame !== frame) : edits.moves};
}

// A key moved in time, as far as its neighbors let it go, and changed. turn or move: what it holds then.
export function changeKey(edits: Edits, joint: number, from: number, to: number, change: {turn: Quaternion} | {move: Vector3}): Edits {
  const place = <K extends {frame: number}>(keys: readonly K[], what: Partial<K>): K[] => {
    const at = keys.findIndex((key) => key.frame === from);
    if (at < 0) return [...keys];
    const low = at > 0 ? keys[at - 1]!.frame + 1 : 0, high = at + 1 < keys.length ? keys[at + 1]!.frame - 1 : Infinity;
    return keys.map((key, i) => i === at ? {...key, ...what, frame: Math.min(high, Math.max(low, to))} : key);
  };
  if ('move' in change) return {...edits, moves: place<MoveKey>(edits.moves, change)};
  const turns = new Map(edits.turns);
  turns.set(joint, place<TurnKey>(turns.get(joint) ?? [], change));
  return {...edits, turns};
}
// The key at or before `frame` eases, or does so no more.
export function toggleEase(edits: Edits, joint: number, frame: number): Edits {
  const turned = <K extends {frame: number; ease?: boolean}>(keys: readonly K[]): K[] => {
    const at = keys.findLastIndex((key) => key.frame <= frame);
    return keys.map((key, i) => i === at ? {...key, ease: !key.ease} : key);
  };
  const turns = new Map(edits.turns);
  if (turns.has(joint)) turns.set(joint, turned(turns.get(joint)!));
  return {...edits, turns, moves: joint === 0 ? turned(edits.moves) : edits.moves};
}

// Without any edit of one joint.
export function resetJoint(edits: Edits, joint: number): Edits {
  const turns = new Map(edits.turns), strengths = new Map(edits.strengths);
  turns.delete(joint);
  strengths.delete(joint);
  return {turns, strengths, moves: joint === 0 ? [] : edits.moves};
}

// The strength of the learned detail where the bone moves the mesh.
export const strengthOf = (motion: Motion, edits: Edits, joint: number): number =>
  edits.strengths.get(joint) ?? motion.look.jointStrengths[joint] ?? 1;
export function withStrength(edits: Edits, joints: readonly number[], strength: number): Edits {
  return {...edits, strengths: new Map([...edits.strengths, ...joints.map((joint) => [joint, strength] as const)])};
}
// How the character is shown with the edits. The same object as long as nothing of it changes.
export function lookWith(motion: Motion, edits: Edits): Look {
  if (edits.strengths.size === 0) return motion.look;
  let look = looks.get(edits.strengths);
  if (!look || look.boneScales !== motion.look.boneScales) {
    look = {...motion.look, jointStrengths: motion.frames[0]!.rotations.map((_, b) => strengthOf(motion, edits, b))};
    looks.set(edits.strengths, look);
  }
  return look;
}
const looks = new WeakMap<Edits['strengths'], Look>();

export const keyedFrames = (edits: Edits, joint: number): Set<number> => new Set([
  ...[...edits.turns].flatMap(([b, keys]) => joint < 0 || joint === b ? keys.map((key) => key.frame) : []),
  ...(joint <= 0 ? edits.moves.map((key) => key.frame) : []),
]);
export const isEdited = (edits: Edits): boolean => edits.turns.size > 0 || edits.moves.length > 0 || edits.strengths.size > 0;

// Files have the joints in any order, and may leave some at rest.
export function motionFromFile(file: MotionFile, joints: readonly Joint[]): Motion {
  const places = joints.map((joint) => file.joints.indexOf(joint.name));
  const rest = restPose(joints);
  const factors = (named?: Record<string, number>): number[] => named ? joints.map(({name}) => named[name] ?? 1) : [];
  return {
    fps: file.fps,
    look: {skinnedOnly: false, boneScales: factors(file.bone_scales), jointStrengths: factors(file.detail_strengths),
      vertexStrengths: file.vertex_strengths ?? []},
    frames: file.frames.map((frame) => ({
      root: frame.root_translation as unknown as Vector3,
      rotations: places.map((place, b) => place < 0 ? rest.rotations[b]!
        : normalize(frame.rotations[place] as unknown as Quaternion)),
    })),
  };
}
export function motionToFile(motion: Motion, edits: Edits, joints: readonly Joint[]): MotionFile {
  const {boneScales, jointStrengths, vertexStrengths} = lookWith(motion, edits);
  const named = (factors: readonly number[]): Record<string, number> =>
    Object.fromEntries(factors.map((factor, b) => [joints[b]!.name, factor]));
  return {
    ...(boneScales.length ? {bone_scales: named(boneScales)} : {}),
    ...(jointStrengths.length ? {detail_strengths: named(jointStrengths)} : {}),
    ...(vertexStrengths.length ? {vertex_strengths: [...vertexStrengths]} : {}),
    schema: 'pleat.motion/1', fps: motion.fps, joints: joints.map((joint) => joint.name),
    frames: motion.frames.map((_, frame) => {
      const pose = poseAt(motion, edits, frame);
      return {root_translation: [...pose.root], rotations: pose.rotations.map((turn) => [...turn])};
    }),
  };
}
export const restMotion = (joints: readonly Joint[], numFrames: number, fps: number): Motion =>
  ({fps, frames: Array.from({length: numFrames}, () => restPose(joints)), look: kPlainLook});

// As text, for what a reload must not lose.
export const editsToJson = ({turns, moves, strengths}: Edits): string =>
  JSON.stringify({turns: [...turns], moves, strengths: [...strengths]});
export function editsFromJson(text: string): Edits {
  const {turns, moves, strengths} = JSON.parse(text) as {turns: [number, TurnKey[]][]; moves: MoveKey[]; strengths?: [number, number][]};
  return {turns: new Map(turns), moves, strengths: new Map(strengths ?? [])};
}
