// The rest skeleton while its joints are moved by hand: where they are put in the rest frame of the take,
// for a training that starts from there (option placed_joints).
import {add, dot, scale, subtract, type Vector3} from '../math/quaternion';
import type {Joint} from '../math/skeleton';
import {History} from './history';

export type Placed = ReadonlyMap<number, Vector3>;  // the joints that were moved

export class RestSkeleton {
  readonly placed: History<Placed>;

  // frame: of the take, in which the skeleton rests.
  constructor(readonly joints: readonly Joint[], readonly frame: number, changed: () => void) {
    this.placed = new History<Placed>(new Map(), changed);
  }
  get positions(): Vector3[] { return this.joints.map((joint, b) => this.placed.value.get(b) ?? joint.rest); }
  move(joint: number, to: Vector3, label: string, gesture: string | null): void {
    this.placed.change(new Map([...this.placed.value, [joint, to]]), label, gesture);
  }
  reset(joint: number): void {
    const placed = new Map(this.placed.value);
    if (placed.delete(joint)) this.placed.change(placed, 'reset a joint');
  }
  // Puts the other side where the side of `joint` was moved to. False: nothing of this side was moved.
  mirror(joint: number): boolean {
    const side = sideOf(this.joints[joint]?.name ?? ''), moved = [...this.placed.value].filter(([b]) => side && sideOf(this.joints[b]!.name) === side);
    if (moved.length === 0) return false;
    const {normal, point} = symmetryPlane(this.joints), placed = new Map(this.placed.value);
    for (const [b, position] of moved) {
      const other = this.joints.findIndex(({name}) => name === otherSide(this.joints[b]!.name));
      if (other >= 0) placed.set(other, subtract(position, scale(normal, 2 * dot(normal, subtract(position, point)))));
    }
    this.placed.change(placed, 'mirror the skeleton');
    return true;
  }
  // As the option has them: "leftHand=.7,1.4,0 head=0,1.7,0".
  get text(): string {
    return [...this.placed.value].map(([b, position]) => `${this.joints[b]!.name}=${position.map((x) => x.toFixed(5)).join(',')}`).join(' ');
  }
}

const sideOf = (name: string): 'left' | 'right' | null => /^left/.test(name) ? 'left' : /^right/.test(name) ? 'right' : null;
const otherSide = (name: string): string => name.replace(/^(left|right)/, (side) => side === 'left' ? 'right' : 'left');

// The plane between the left and the right joints of the rest pose.
export function symmetryPlane(joints: readonly Joint[]): {normal: Vector3; point: Vector3} {
  let across: Vector3 = [0, 0, 0], sum: Vector3 = [0, 0, 0], pairs = 0;
  for (const left of joints) {
    const right = sideOf(left.name) === 'left' ? joints.find(({name}) => name === otherSide(left.name)) : undefined;
    if (!right) continue;
    across = add(across, subtract(left.rest, right.rest));
    sum = add(sum, scale(add(left.rest, right.rest), .5));
    ++pairs;
  }
  const length = Math.hypot(...across);
  return length > 0 ? {normal: scale(across, 1 / length), point: scale(sum, 1 / pairs)} : {normal: [1, 0, 0], point: [0, 0, 0]};
}
