// Draco's decoder for what a stream of frames holds (docs/formats/frame_stream.md).
import createDecoder, {type Decoder, type DecoderModule, type PointCloud} from 'draco3d/draco_decoder_nodejs.js';

let module: DecoderModule | undefined;
export async function loadDraco(): Promise<void> {
  if (module) return;
  const response = await fetch('/draco_decoder.wasm');
  if (!response.ok) throw new Error('the decoder of frames cannot be loaded; reload the page');
  module = await createDecoder({wasmBinary: await response.arrayBuffer()});
}

// Runs `use` with the geometry that the bytes hold and frees everything.
function decode<T>(bytes: Uint8Array, isMesh: boolean, use: (decoder: Decoder, geometry: PointCloud) => T): T {
  const draco = module!;
  const buffer = new draco.DecoderBuffer();
  const decoder = new draco.Decoder();
  const geometry = isMesh ? new draco.Mesh() : new draco.PointCloud();
  try {
    buffer.Init(new Int8Array(bytes.buffer, bytes.byteOffset, bytes.byteLength), bytes.byteLength);
    const status = isMesh ? decoder.DecodeBufferToMesh(buffer, geometry) : decoder.DecodeBufferToPointCloud(buffer, geometry);
    if (!status.ok()) throw new Error(`a frame cannot be decoded: ${status.error_msg()}`);
    return use(decoder, geometry);
  } finally {
    for (const object of [geometry, decoder, buffer]) draco.destroy(object);
  }
}

// Copies what Draco has written to its memory.
function fromHeap<T extends Float32Array | Int32Array | Uint32Array>(
  type: new (buffer: ArrayBufferLike, offset: number, length: number) => T, count: number, fill: (pointer: number, bytes: number) => void): T {
  const draco = module!;
  const pointer = draco._malloc(4 * count);
  fill(pointer, 4 * count);
  const copy = new type(draco.HEAPU8.buffer, pointer, count).slice() as T;
  draco._free(pointer);
  return copy;
}

// The values of attribute `index` of a point cloud or mesh, for every point.
function floats(decoder: Decoder, geometry: PointCloud, index: number, components: number): Float32Array {
  return fromHeap(Float32Array, components * geometry.num_points(), (pointer, bytes) =>
    decoder.GetAttributeDataArrayForAllPoints(geometry, decoder.GetAttribute(geometry, index), module!.DT_FLOAT32, bytes, pointer));
}
function integers(decoder: Decoder, geometry: PointCloud, index: number): Int32Array {
  return fromHeap(Int32Array, geometry.num_points(), (pointer, bytes) =>
    decoder.GetAttributeDataArrayForAllPoints(geometry, decoder.GetAttribute(geometry, index), module!.DT_INT32, bytes, pointer));
}

export interface Topology { triangles: Uint32Array; positions: Float32Array }

// The topology mesh: triangles of vertices of the sequence, and the rest positions of each vertex.
export function decodeTopology(bytes: Uint8Array, numVertices: number): Topology {
  return decode(bytes, true, (decoder, geometry) => {
    const draco = module!;
    const position = decoder.GetAttributeId(geometry, draco.POSITION);
    const generic = decoder.GetAttributeId(geometry, draco.GENERIC);
    const vertexOf = integers(decoder, geometry, generic);
    const points = floats(decoder, geometry, position, 3);
    const triangles = fromHeap(Uint32Array, 3 * geometry.num_faces(), (pointer, size) =>
      decoder.GetTrianglesUInt32Array(geometry, size, pointer));
    const positions = new Float32Array(3 * numVertices);
    for (let point = 0; point < vertexOf.length; ++point) {
      for (let c = 0; c < 3; ++c) positions[3 * vertexOf[point]! + c] = points[3 * point + c]!;
    }
    return {triangles: triangles.map((point) => vertexOf[point]!), positions};
  });
}

// The positions of a key frame in the order of the stream.
export const decodeCloud = (bytes: Uint8Array): Float32Array =>
  decode(bytes, false, (decoder, geometry) => floats(decoder, geometry, 0, 3));

// The residuals x, y, z of a difference, in the order of the stream.
export const decodeResiduals = (bytes: Uint8Array): [Int32Array, Int32Array, Int32Array] =>
  decode(bytes, false, (decoder, geometry) =>
    [integers(decoder, geometry, 0), integers(decoder, geometry, 1), integers(decoder, geometry, 2)]);
