// Reads a sequence file (docs/formats/sequence_file.md) while it arrives: the connectivity first, then
// frame after frame, so that the first ones can be shown at once.
import {request, stream} from './calls';

export interface Shape { numVertices: number; numFrames: number; triangles: Uint32Array }

// Bytes in the order in which they come. next: the next piece, or null at the end.
class ByteSource {
  private pieces: Uint8Array[] = [];
  private length = 0;
  constructor(private readonly next: () => Promise<Uint8Array | null>) {}
  async take(count: number): Promise<Uint8Array> {
    while (this.length < count) {
      const value = await this.next();
      if (!value) throw new Error('the sequence file is cut off');
      this.pieces.push(value);
      this.length += value.length;
    }
    const bytes = new Uint8Array(count);
    for (let filled = 0; filled < count;) {
      const piece = this.pieces[0]!;
      const used = Math.min(piece.length, count - filled);
      bytes.set(piece.subarray(0, used), filled);
      filled += used;
      if (used === piece.length) this.pieces.shift();
      else this.pieces[0] = piece.subarray(used);
    }
    this.length -= count;
    return bytes;
  }
  async text(): Promise<string> {
    const size = new DataView((await this.take(4)).buffer).getUint32(0, true);
    return new TextDecoder().decode(await this.take(size));
  }
}

// Faces as triangles: each is a fan around its first corner.
export function fan(sizes: Int32Array, corners: Int32Array): Uint32Array {
  const triangles: number[] = [];
  let first = 0;
  for (const size of sizes) {
    for (let k = 2; k < size; ++k) triangles.push(corners[first]!, corners[first + k - 1]!, corners[first + k]!);
    first += size;
  }
  return Uint32Array.from(triangles);
}

// What comes before the frames.
async function readShape(source: ByteSource): Promise<Shape> {
  const head = new DataView((await source.take(48)).buffer);
  if (head.getUint32(8, true) !== 1) throw new Error('the sequence file is of another version; reload the page');
  const count = (at: number): number => head.getUint32(at, true);
  const [numVertices, numFaces, numCorners, numFrames] = [count(12), count(16), count(20), count(24)];
  const [numTexcoords, numMaterials, flags] = [count(36), count(40), count(44)];
  for (let i = 0; i < 2 + numMaterials; ++i) await source.text();
  const sizes = new Int32Array((await source.take(4 * numFaces)).buffer);
  const corners = new Int32Array((await source.take(4 * numCorners)).buffer);
  await source.take(8 * numTexcoords);
  if (flags & 1) await source.take(4 * numCorners);
  if (flags & 2) await source.take(4 * numFaces);
  return {numVertices, numFrames, triangles: fan(sizes, corners)};
}

export async function readSequence(id: string, signal: AbortSignal, onShape: (shape: Shape) => void,
                                   onFrame: (frame: number, positions: Float32Array) => void): Promise<void> {
  const response = await request('/rpc/SequenceService/DownloadSequence', {
    method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({id}), signal,
  });
  const reader = response.body!.getReader();
  const source = new ByteSource(async () => (await reader.read()).value ?? null);
  const shape = await readShape(source);
  onShape(shape);
  for (let t = 0; t < shape.numFrames; ++t) {
    onFrame(t, new Float32Array((await source.take(12 * shape.numVertices)).buffer));
  }
}

interface DecodedPart { shape?: string; positions?: {frame?: number; firstVertex?: number; xyz: string} }
const bytesOf = (base64: string): Uint8Array => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

// Frames begin to end - 1 of a compressed sequence, which the server decodes.
export async function decodeFrames(id: string, begin: number, end: number, signal: AbortSignal, onShape: (shape: Shape) => void,
                                   onFrame: (frame: number, positions: Float32Array) => void): Promise<void> {
  const shapeParts: Uint8Array[] = [];
  let shape: Shape | null = null, positions = new Float32Array(), filled = 0;
  for await (const part of stream<DecodedPart>('CompressedSequenceService/DecodeFrames', {id, beginFrame: begin, endFrame: end}, signal)) {
    if (part.shape) shapeParts.push(bytesOf(part.shape));
    if (!part.positions) continue;
    if (!shape) {
      shape = await readShape(new ByteSource(async () => shapeParts.shift() ?? null));
      onShape(shape);
    }
    const {frame = 0, firstVertex = 0, xyz} = part.positions, values = new Float32Array(bytesOf(xyz).buffer);
    if (firstVertex === 0) [positions, filled] = [new Float32Array(3 * shape.numVertices), 0];
    positions.set(values, 3 * firstVertex);
    filled += values.length;
    if (filled === positions.length) onFrame(frame, positions);
  }
}
