// What is open: a take, a model, the motion and its edits, and the moment that is shown. Whoever
// changes it calls changed(); it knows nothing of elements.
import {readMotion} from '../api/upload';
import {fpsOf, type CompressedSequence, type Job, type Model, type Sequence, type StoredTake} from '../api/types';
import {dragJoint} from '../math/inverse_kinematics';
import {inverse, kIdentity, multiply, toDegrees, type Vector3} from '../math/quaternion';
import {placeJoints, scaledJoints, type Joint, type PlacedPose, type Pose} from '../math/skeleton';
import {slerp} from '../math/quaternion';
import {History} from './history';
import {editsFromJson, editsToJson, isEdited, keyPose, kNoEdits, lookWith, motionFromFile, motionToFile, poseAt, restMotion, type Edits,
  type Look, type Motion} from './motion';
import {RestSkeleton} from './rest_skeleton';
import {loadEdits, saveEdits} from './settings';
import {Takes} from './takes';

const kRestFrames = 60;

export class Document {
  model: Model | null = null;
  joints: readonly Joint[] = [];
  private bones: readonly Joint[] = [];  // the same with the proportions of the motion
  motion: Motion | null = null;
  readonly takes = new Takes();
  takeInfo: Sequence | null = null;
  compressed: CompressedSequence | null = null;  // in place of a take
  report: StoredTake | null = null;
  frame = 0;
  joint = -1;
  readonly edits: History<Edits>;
  rest: RestSkeleton | null = null;  // while its joints are moved

  constructor(private readonly changed: () => void) {
    this.edits = new History<Edits>(kNoEdits, () => {
      if (this.model) saveEdits(this.model.id, isEdited(this.edits.value) ? editsToJson(this.edits.value) : null);
      this.changed();
    });
  }

  // What undo and redo go through now.
  get history(): History<unknown> { return (this.rest?.placed ?? this.edits) as History<unknown>; }
  get numFrames(): number { return this.motion?.frames.length ?? this.takes.current?.shape.numFrames ?? 0; }
  get fps(): number {
    const shown = this.takeInfo ?? this.compressed;
    return this.motion?.fps ?? (shown ? fpsOf(shown.frameRate) : 30);
  }
  get isEdited(): boolean { return isEdited(this.edits.value); }

  openCompressed(info: CompressedSequence): void {
    this.closeModel();
    this.takeInfo = this.report = null;
    this.compressed = info;
    this.frame = 0;
  }
  openTake(info: Sequence, report: StoredTake | null): void {
    this.takeInfo = info;
    this.compressed = null;
    this.report = report;
    this.closeModel();
    this.frame = 0;
  }
  closeModel(): void {
    this.model = null;
    this.joints = [];
    this.motion = null;
    this.joint = -1;
    this.rest = null;
  }
  // False where the take does not have the frame in which the skeleton rests.
  openRest(): boolean {
    const frame = this.model?.record.restFrame ?? -1;
    if (!this.takes.current?.frames[frame]) return false;
    this.rest = new RestSkeleton(this.joints, frame, this.changed);
    this.frame = frame;
    return true;
  }

  // Opens a model with the motion of its take, when the server still has that.
  async openModel(model: Model, jobs: readonly Job[], takes: readonly Sequence[]): Promise<void> {
    const job = jobs.find((other) => other.resultId === model.id && other.training);
    const take = takes.find((other) => other.id === job?.sequenceIds[0])
      ?? takes.find((other) => other.name === model.name && other.numVertices === model.numVertices) ?? null;
    const joints = model.skeleton.joints.map(({name, parent, restPosition: {x, y, z}}) =>
      ({name, parent, rest: [x, y, z] as Vector3}));
    const motion = take ? motionFromFile(await readMotion(model.id, {sequence: take.id}), joints)
      : restMotion(joints, kRestFrames, fpsOf(model.frameRate));
    this.model = model;
    this.compressed = null;
    this.rest = null;
    this.joints = this.bones = joints;
    this.motion = motion;
    if (take?.id !== this.takeInfo?.id) this.report = null;
    this.takeInfo = take;
    this.frame = Math.min(this.frame, motion.frames.length - 1);
    this.joint = Math.max(0, joints.findIndex((joint) => /leftHand/.test(joint.name)));
    const kept = loadEdits(model.id);
    try {
      this.edits.reset(kept ? editsFromJson(kept) : kNoEdits);
    } catch {  // of an older page
      this.edits.reset(kNoEdits);
    }
  }
  setMotion(motion: Motion): void {
    this.motion = motion;
    this.bones = scaledJoints(this.joints, motion.look.boneScales);
    this.frame = 0;
    this.edits.reset(kNoEdits);
  }
  look(edited: boolean): Look { return lookWith(this.motion!, edited ? this.edits.value : kNoEdits); }
  motionFile(): object { return motionToFile(this.motion!, this.edits.value, this.joints); }

  pose(edited: boolean, frame = this.frame): Pose | null {
    return this.motion ? poseAt(this.motion, edited ? this.edits.value : kNoEdits, frame) : null;
  }
  placed(): PlacedPose | null {
    if (this.rest) return {positions: this.rest.positions, turns: this.joints.map(() => kIdentity)};
    const pose = this.pose(true);
    return pose ? placeJoints(this.bones, pose) : null;
  }
  // How the joint differs from the take, degrees about x, y and z.
  changeOf(joint: number): Vector3 {
    const base = this.pose(false), now = this.pose(true);
    if (!base || !now || joint < 0) return [0, 0, 0];
    return toDegrees(multiply(inverse(base.rotations[joint]!), now.rotations[joint]!));
  }
  // The joint with its bone dragged to a place: of the pose, or of the rest skeleton while that is open.
  dragTo(joint: number, target: Vector3, label: string, gesture: string): void {
    const pose = this.pose(true);
    if (this.rest) this.rest.move(joint, target, label, gesture);
    else if (pose) this.setPose(dragJoint(this.bones, pose, joint, target), label, gesture);
  }
  setPose(pose: Pose, label: string, gesture: string | null): void {
    if (!this.motion) return;
    this.edits.change(keyPose(this.motion, this.edits.value, this.frame, pose), label, gesture);
  }

  // The pose of a frame and those before it, training-frame intervals apart, as far as the motion goes.
  posesFor(edited: boolean): Pose[] {
    const poses = [this.pose(edited)!];
    const step = this.motion!.fps / fpsOf(this.model!.frameRate);
    for (let h = 1; h < (this.model!.options.history ?? 2); ++h) {
      const at = this.frame - h * step;
      if (at < -1e-6) break;
      const before = Math.max(0, Math.floor(at + 1e-6)), fraction = at - before;
      const a = this.pose(edited, before)!;
      poses.push(fraction < 1e-6 ? a : mix(a, this.pose(edited, before + 1)!, fraction));
    }
    return poses;
  }
}

const mix = (a: Pose, b: Pose, fraction: number): Pose => ({
  root: [0, 1, 2].map((i) => a.root[i]! + fraction * (b.root[i]! - a.root[i]!)) as unknown as Vector3,
  rotations: a.rotations.map((turn, i) => slerp(turn, b.rotations[i]!, fraction)),
});
