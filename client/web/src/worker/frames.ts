// What turns the frames of a session into meshes: Draco differences, or parameters and a shader.
import type {Frame, FrameParameters, StreamHeader} from '../generated/pleat/v1/pose_service_pb';
import type {Quaternion} from '../math/quaternion';
import type {Pose} from '../math/skeleton';
import type {Look} from '../store/motion';
import {DeltaDecoder, type Box} from './delta';
import {decodeCloud, decodeResiduals, decodeTopology} from './draco';
import {vertexStrengths} from './page_character';
import type {ShaderCharacter} from './shader_character';

export interface Frames {
  readonly numVertices: number;
  readonly triangles: Uint32Array;
  readonly gridStep: number;  // meters; 0: positions are not on a grid
  readonly needsKeyFrame: boolean;
  // Null: the frame cannot be shown, and the next pose asks for a key frame.
  decode(frame: Frame): Promise<Float32Array | null>;
}

export class MeshFrames implements Frames {
  readonly numVertices: number;
  readonly triangles: Uint32Array;
  readonly gridStep: number;
  private readonly order: Int32Array;
  private readonly decoder: DeltaDecoder;

  constructor(header: StreamHeader) {
    const {originX, originY, originZ, range, bits} = header.box!;
    const box: Box = {origin: [originX, originY, originZ], step: range / (2 ** bits - 1)};
    const topology = decodeTopology(header.topologyDraco, header.numVertices);
    this.numVertices = header.numVertices;
    this.triangles = topology.triangles;
    this.gridStep = box.step;
    this.order = Int32Array.from(header.vertexOrder);
    this.decoder = new DeltaDecoder(topology.triangles, topology.positions, box);
  }
  get needsKeyFrame(): boolean { return this.decoder.needsKeyFrame; }
  async decode(frame: Frame): Promise<Float32Array | null> {
    const good = frame.difference ? this.decoder.addResiduals(decodeResiduals(frame.draco), frame.checksum)
      : this.decoder.setKeyFrame(this.inVertexOrder(decodeCloud(frame.draco)), frame.checksum);
    return good ? this.decoder.positions() : null;
  }
  private inVertexOrder(points: Float32Array): Float32Array {
    const positions = new Float32Array(points.length);
    for (let k = 0; k < this.order.length; ++k) {
      for (let c = 0; c < 3; ++c) positions[3 * this.order[k]! + c] = points[3 * k + c]!;
    }
    return positions;
  }
}

export class ParameterFrames implements Frames {
  readonly numVertices: number;
  readonly triangles: Uint32Array;
  readonly gridStep = 0;
  readonly needsKeyFrame = false;
  private readonly strengths: Float32Array | null;

  constructor(private readonly shader: ShaderCharacter, private readonly look: Look) {
    this.numVertices = shader.character.head.num_vertices;
    this.triangles = shader.character.triangles;
    this.strengths = vertexStrengths(shader.character, look.jointStrengths, look.vertexStrengths);
  }
  async decode(frame: Frame): Promise<Float32Array | null> {
    const parameters = frame.parameters!;
    const coefficients = parameters.packedCoefficients.length ? await unpackCoefficients(parameters.packedCoefficients) : parameters.coefficients;
    if (coefficients.length && coefficients.length !== this.shader.character.head.num_coefficients) throw new Error('the frame is of another model');
    return this.shader.evaluate(poseOf(parameters), this.look.boneScales, coefficients, this.strengths);
  }
}

function poseOf({rootPosition, rotations}: FrameParameters): Pose {
  const turns: Quaternion[] = [];
  for (let i = 0; i + 3 < rotations.length; i += 4) turns.push([rotations[i]!, rotations[i + 1]!, rotations[i + 2]!, rotations[i + 3]!]);
  return {root: [rootPosition!.x, rootPosition!.y, rootPosition!.z], rotations: turns};
}

const kStep_m = .0005;  // of packed coefficients
// Zigzag varints, deflated (pose_service.proto).
export async function unpackCoefficients(packed: Uint8Array): Promise<number[]> {
  const inflated = new Blob([packed as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new DecompressionStream('deflate'));
  const bytes = new Uint8Array(await new Response(inflated).arrayBuffer()), coefficients: number[] = [];
  for (let at = 0; at < bytes.length;) {
    let zigzag = 0;
    for (let factor = 1; ; factor *= 128) {
      const byte = bytes[at++];
      if (byte === undefined) throw new Error('packed coefficients are cut off');
      zigzag += (byte & 127) * factor;
      if (byte < 128) break;
    }
    coefficients.push(kStep_m * (zigzag % 2 ? -(zigzag + 1) / 2 : zigzag / 2));
  }
  return coefficients;
}
