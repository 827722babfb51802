// The character of a page as the server sends it (docs/formats/page_character.md).
import type {Vector3} from '../math/quaternion';

export interface PagePart { num_vertices: number; coefficients: number[]; scales: number[] }
interface Head {
  num_vertices: number; num_joints: number; num_coefficients: number; detail_axes: 'local' | 'root' | 'world'; deformation: 'fine' | 'full';
  joints: {parent: number; rest: Vector3}[]; parts: PagePart[]; buffers: Record<string, [number, number]>;
}
export interface PageCharacter {
  head: Head; rest: Float32Array; bones: Uint8Array; weights: Float32Array; partVertices: Uint32Array; mean: Float32Array;
  planes: Int8Array; triangles: Uint32Array;
}
export const kInfluences = 8;
const kMagic = 0x43504c50, kVersion = 1;  // "PLPC"

export function readPageCharacter(bytes: ArrayBuffer): PageCharacter {
  const view = new DataView(bytes);
  if (bytes.byteLength < 12 || view.getUint32(0, true) !== kMagic || view.getUint32(4, true) !== kVersion) {
    throw new Error('the server sends characters of another version; reload the page');
  }
  const begin = 12 + view.getUint32(8, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 12, begin - 12))) as Head;
  const at = (name: string): [ArrayBuffer, number, number] => {
    const [first, size] = head.buffers[name]!;
    return [bytes, begin + first, size];
  };
  const floats = (name: string): Float32Array => { const [buffer, first, size] = at(name); return new Float32Array(buffer, first, size / 4); };
  const words = (name: string): Uint32Array => { const [buffer, first, size] = at(name); return new Uint32Array(buffer, first, size / 4); };
  return {head, rest: floats('rest'), bones: new Uint8Array(...at('bones')), weights: floats('weights'), partVertices: words('part_vertices'),
    mean: floats('mean'), planes: new Int8Array(...at('planes')), triangles: words('triangles')};
}

// The strength of the detail of each vertex: what is painted there, times the mean of its bones by their
// weights, as lib/character computes it. Null: 1 everywhere.
export function vertexStrengths({head, bones, weights}: PageCharacter, joints: readonly number[], painted: readonly number[]): Float32Array | null {
  if (joints.length === 0 && painted.length === 0) return null;
  const strengths = new Float32Array(head.num_vertices);
  for (let v = 0; v < strengths.length; ++v) {
    let mean = 0, sum = 0;
    for (let k = kInfluences * v; k < kInfluences * (v + 1); ++k) {
      mean += weights[k]! * (joints[bones[k]!] ?? 1);
      sum += weights[k]!;
    }
    strengths[v] = (painted[v] ?? 1) * (sum > 0 && joints.length > 0 ? mean / sum : 1);
  }
  return strengths;
}
