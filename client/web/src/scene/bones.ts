// The skeleton over the mesh: a line for each bone, a ball for each joint, and the names.
import {BufferAttribute, BufferGeometry, Camera, Color, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  SphereGeometry, Vector3} from 'three';
import type {PlacedPose, Joint} from '../math/skeleton';
import {readableName} from '../math/skeleton';

const kPlain = new Color(0xf2b84b), kSelected = new Color(0xffffff), kEdited = new Color(0x4bc4f2);

export class Bones {
  readonly group = new Group();
  private lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({color: 0xf2b84b, depthTest: false, transparent: true, opacity: .75}));
  private balls: Mesh<SphereGeometry, MeshBasicMaterial>[] = [];
  private labels: HTMLElement[] = [];
  private joints: readonly Joint[] = [];

  constructor(private readonly labelHost: HTMLElement) {
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 5;
    this.group.add(this.lines);
  }

  setJoints(joints: readonly Joint[]): void {
    this.joints = joints;
    for (const ball of this.balls) this.group.remove(ball);
    const sphere = new SphereGeometry(.017, 12, 8);
    this.balls = joints.map(() => {
      const ball = new Mesh(sphere, new MeshBasicMaterial({depthTest: false, transparent: true, opacity: .95}));
      ball.renderOrder = 6;
      this.group.add(ball);
      return ball;
    });
    this.lines.geometry.dispose();
    this.lines.geometry = new BufferGeometry();
    this.lines.geometry.setAttribute('position', new BufferAttribute(new Float32Array(6 * Math.max(0, joints.length - 1)), 3));
    this.labelHost.replaceChildren();
    this.labels = joints.map((joint) => {
      const label = document.createElement('span');
      label.textContent = readableName(joint.name);
      this.labelHost.append(label);
      return label;
    });
  }

  place(placed: PlacedPose): void {
    const attribute = this.lines.geometry.getAttribute('position') as BufferAttribute | undefined;
    this.joints.forEach((joint, b) => {
      this.balls[b]!.position.set(...placed.positions[b] as [number, number, number]);
      if (b === 0 || !attribute) return;
      attribute.setXYZ(2 * (b - 1), ...placed.positions[joint.parent] as [number, number, number]);
      attribute.setXYZ(2 * (b - 1) + 1, ...placed.positions[b] as [number, number, number]);
    });
    if (attribute) attribute.needsUpdate = true;
  }

  mark(selected: number, edited: ReadonlySet<number>): void {
    this.balls.forEach((ball, b) => {
      ball.material.color = b === selected ? kSelected : edited.has(b) ? kEdited : kPlain;
      ball.scale.setScalar(b === selected ? 1.5 : 1);
    });
    this.labels.forEach((label, b) => label.classList.toggle('selected', b === selected));
  }

  // The joint nearest to a place of the view, within some pixels; -1: none.
  pick(x: number, y: number, camera: Camera, width: number, height: number): number {
    let best = -1, least = 18;
    this.balls.forEach((ball, b) => {
      const [px, py] = project(ball.position, camera, width, height);
      const distance = Math.hypot(px - x, py - y);
      if (distance < least) [best, least] = [b, distance];
    });
    return best;
  }

  placeLabels(show: boolean, camera: Camera, left: number, width: number, height: number): void {
    this.labelHost.hidden = !show;
    if (!show) return;
    this.balls.forEach((ball, b) => {
      const [x, y] = project(ball.position, camera, width, height);
      this.labels[b]!.style.transform = `translate(${Math.round(left + x + 8)}px, ${Math.round(y - 8)}px)`;
    });
  }
}

function project(point: Vector3, camera: Camera, width: number, height: number): [number, number] {
  const p = point.clone().project(camera);
  return [(p.x + 1) / 2 * width, (1 - p.y) / 2 * height];
}
