// What is done to the joint that is selected, as steps of undo.
import {say} from '../panels/dom';
import {fromDegrees, type Vector3} from '../math/quaternion';
import {readableName} from '../math/skeleton';
import type {Document} from './document';
import {insertKey, removeKeys, resetJoint, toggleEase, withStrength, type Edits} from './motion';

export class Editing {
  constructor(private readonly document: Document) {}

  turn(joint: number, degrees: Vector3, gesture: string): void {
    const pose = this.document.pose(true);
    if (!pose) return;
    const rotations = [...pose.rotations];
    rotations[joint] = fromDegrees(degrees);
    this.document.setPose({root: pose.root, rotations}, `turn ${readableName(this.document.joints[joint]!.name)}`, gesture);
  }
  setKey(): void { this.edit(insertKey(this.edits, this.document.frame, this.document.joint), 'set a key'); }
  removeKey(): void { this.edit(removeKeys(this.edits, this.document.frame, this.document.joint), 'remove a key'); }
  resetJoint(): void { this.edit(resetJoint(this.edits, this.document.joint), `reset ${this.jointName}`); }
  toggleEase(): void { this.edit(toggleEase(this.edits, this.document.joint, this.document.frame), 'ease a key'); }
  // all: of the whole character, otherwise where the selected joint's bone moves the mesh.
  setStrength(strength: number, all: boolean, gesture: string): void {
    const {edits, joints, joint, motion} = this.document;
    if (!motion) return;
    const which = all ? joints.map((_, b) => b) : [joint];
    edits.change(withStrength(edits.value, which, strength), all ? 'strength of the folds' : `strength of the folds at ${this.jointName}`, gesture);
  }
  undo(): void { if (!this.document.history.undo()) say('There is nothing to undo.'); }
  redo(): void { if (!this.document.history.redo()) say('There is nothing to redo.'); }

  private get edits(): Edits { return this.document.edits.value; }
  private get jointName(): string { return readableName(this.document.joints[this.document.joint]?.name ?? ''); }
  private edit(edits: Edits, label: string): void {
    if (this.document.motion && this.document.joint >= 0) this.document.edits.change(edits, label);
  }
}
