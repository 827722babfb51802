// Posing in the view: the balls of joints are dragged in the plane that faces the camera, and the gizmo
// turns or moves the selected one along its axes.
import {Object3D, Plane, Quaternion as ThreeQuaternion, Raycaster, Vector2, Vector3} from 'three';
import {inverse, multiply, normalize, type Quaternion, type Vector3 as Point} from '../math/quaternion';
import type {Document} from '../store/document';
import type {Bones} from './bones';
import type {Viewport} from './viewport';
import {readableName} from '../math/skeleton';

export class Dragging {
  private readonly handle = new Object3D();
  private readonly plane = new Plane();
  private dragged = -1;
  private gesture = 0;
  private offset = new Vector3();
  mode: 'rotate' | 'translate' = 'rotate';

  constructor(private readonly viewport: Viewport, private readonly bones: Bones, private readonly host: HTMLElement,
              private readonly document: Document, private readonly selected: () => void) {
    viewport.overlay.add(this.handle);
    host.addEventListener('pointerdown', (event) => this.press(event));
    host.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) host.addEventListener(end, () => this.release());
    viewport.gizmo.addEventListener('mouseDown', () => { ++this.gesture; });
    viewport.gizmo.addEventListener('objectChange', () => this.turnByGizmo());
  }

  // Puts the gizmo where the selected joint is; nothing while it is dragged.
  place(): void {
    const {gizmo} = this.viewport, placed = this.document.placed(), joint = this.document.joint;
    if (!placed || joint < 0) {
      gizmo.detach();
      return;
    }
    if (!gizmo.dragging) {
      const parent = this.document.joints[joint]!.parent;
      const pivot = this.mode === 'rotate' && parent >= 0 ? placed.positions[parent]! : placed.positions[joint]!;
      this.handle.position.set(...pivot as [number, number, number]);
      const [w, x, y, z] = placed.turns[joint]!;
      this.handle.quaternion.copy(this.mode === 'rotate' ? new ThreeQuaternion(x, y, z, w) : new ThreeQuaternion());
      gizmo.setMode(this.mode);
      gizmo.setSpace(this.mode === 'rotate' ? 'local' : 'world');
      if (gizmo.object !== this.handle) gizmo.attach(this.handle);
    }
    this.viewport.redraw();
  }

  private turnByGizmo(): void {
    const document = this.document, pose = document.pose(true), placed = document.placed(), joint = document.joint;
    if (!pose || !placed || joint < 0) return;
    const label = `${this.mode === 'rotate' ? 'turn' : 'move'} ${readableName(document.joints[joint]!.name)}`;
    if (this.mode === 'translate') return document.dragTo(joint, this.handle.position.toArray() as Point, label, `gizmo${this.gesture}`);
    if (document.rest) return;
    const {x, y, z, w} = this.handle.quaternion, parent = document.joints[joint]!.parent;
    const wanted: Quaternion = [w, x, y, z];
    const rotations = [...pose.rotations];
    rotations[joint] = normalize(parent < 0 ? wanted : multiply(inverse(placed.turns[parent]!), wanted));
    document.setPose({root: pose.root, rotations}, label, `gizmo${this.gesture}`);
  }

  private press(event: PointerEvent): void {
    const placed = this.document.placed();
    if (event.button !== 0 || !placed || this.viewport.gizmo.axis !== null) return;
    const {left, top, width, height} = this.host.getBoundingClientRect();
    const joint = this.bones.pick(event.clientX - left, event.clientY - top, this.viewport.camera, width, height);
    if (joint < 0) return;
    event.stopPropagation();  // the camera stays
    event.preventDefault();
    this.host.setPointerCapture(event.pointerId);
    this.document.joint = joint;
    this.dragged = joint;
    ++this.gesture;
    const position = new Vector3(...placed.positions[joint] as [number, number, number]);
    this.plane.setFromNormalAndCoplanarPoint(this.viewport.camera.getWorldDirection(new Vector3()), position);
    this.offset = position.sub(this.pointAt(event) ?? position);
    this.selected();
  }
  private move(event: PointerEvent): void {
    if (this.dragged < 0) return;
    event.stopPropagation();
    const point = this.pointAt(event);
    if (point) this.document.dragTo(this.dragged, point.add(this.offset).toArray() as Point, `move ${readableName(this.document.joints[this.dragged]!.name)}`, `drag${this.gesture}`);
  }
  private release(): void { this.dragged = -1; }

  private pointAt(event: PointerEvent): Vector3 | null {
    const {left, top, width, height} = this.host.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(2 * (event.clientX - left) / width - 1, 1 - 2 * (event.clientY - top) / height), this.viewport.camera);
    return ray.ray.intersectPlane(this.plane, new Vector3());
  }
}
