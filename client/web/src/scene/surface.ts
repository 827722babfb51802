// A character as it is drawn: positions and normals that change, colors of vertices when something is
// shown by color.
import {BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Mesh, MeshStandardMaterial} from 'three';
import {computeNormals} from '../worker/normals';
import {jointColor, toLinear, turbo, type Rgb} from './colors';

export class Surface {
  readonly mesh: Mesh<BufferGeometry, MeshStandardMaterial>;
  positions = new Float32Array();
  private triangles = new Uint32Array();

  constructor(color: number) {
    this.mesh = new Mesh(new BufferGeometry(), new MeshStandardMaterial({color, roughness: .82, metalness: 0, side: DoubleSide}));
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  // A mesh that has the same shape already keeps what it shows.
  setShape(numVertices: number, triangles: Uint32Array): void {
    if (numVertices === this.numVertices && triangles.length === this.triangles.length
      && triangles.every((corner, i) => corner === this.triangles[i])) return;
    this.triangles = triangles as Uint32Array<ArrayBuffer>;
    this.mesh.geometry.dispose();
    const geometry = new BufferGeometry();
    for (const name of ['position', 'normal', 'color']) {
      geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * numVertices), 3).setUsage(DynamicDrawUsage));
    }
    geometry.setIndex(new BufferAttribute(triangles, 1));
    this.mesh.geometry = geometry;
    this.mesh.visible = false;
    this.positions = new Float32Array();
  }
  get numVertices(): number { return this.mesh.geometry.getAttribute('position')?.count ?? 0; }

  show(positions: Float32Array, normals?: Float32Array): void {
    if (positions.length !== 3 * this.numVertices) return;
    this.positions = positions as Float32Array<ArrayBuffer>;
    this.write('position', positions);
    this.write('normal', normals ?? computeNormals(positions, this.triangles));
    this.mesh.visible = true;
  }
  hide(): void { this.mesh.visible = false; }

  // Colors of vertices, or of the material with null.
  color(colorOf: ((vertex: number) => Rgb) | null): void {
    const material = this.mesh.material;
    if (material.vertexColors !== (colorOf !== null)) {
      material.vertexColors = colorOf !== null;
      material.needsUpdate = true;
    }
    if (!colorOf) return;
    const attribute = this.mesh.geometry.getAttribute('color') as BufferAttribute | undefined;
    if (!attribute) return;
    const colors = attribute.array as Float32Array;
    for (let v = 0; v < attribute.count; ++v) colors.set(colorOf(v), 3 * v);
    attribute.needsUpdate = true;
  }

  private write(name: string, values: Float32Array): void {
    const attribute = this.mesh.geometry.getAttribute(name) as BufferAttribute;
    (attribute.array as Float32Array).set(values);
    attribute.needsUpdate = true;
  }
}

const linear = (color: Rgb): Rgb => color.map(toLinear) as Rgb;
const kSteps = 255;
const kTurbo = Array.from({length: kSteps + 1}, (_, i) => linear(turbo(i / kSteps)));
export const turboLinear = (fraction: number): Rgb => kTurbo[Math.round(kSteps * Math.min(1, Math.max(0, fraction)))]!;
export const jointColorLinear = (joint: number): Rgb => linear(jointColor(joint));

// Distances of corresponding vertices, mm.
export function distancesMm(a: Float32Array, b: Float32Array): Float32Array {
  const distances = new Float32Array(a.length / 3);
  for (let v = 0; v < distances.length; ++v) {
    distances[v] = 1e3 * Math.hypot(a[3 * v]! - b[3 * v]!, a[3 * v + 1]! - b[3 * v + 1]!, a[3 * v + 2]! - b[3 * v + 2]!);
  }
  return distances;
}
export const mean = (values: Float32Array): number => values.reduce((sum, x) => sum + x, 0) / Math.max(1, values.length);
