// Frames as differences on the grid of the stream (docs/formats/frame_stream.md, "Differences").
import {buildHierarchy, squaredDistance, type Hierarchy} from './hierarchy';

export interface Box { origin: [number, number, number]; step: number }

const kWeightSum = 4096;

export function snapToGrid(positions: Float32Array, box: Box, integers: Int32Array): void {
  const scale = 1 / box.step;
  for (let i = 0; i < positions.length; ++i) {
    integers[i] = Math.floor((positions[i]! - box.origin[i % 3]!) * scale + .5);
  }
}

export function gridChecksum(integers: Int32Array): number {
  let hash = 0x811c9dc5;
  for (const k of integers) hash = Math.imul(hash ^ k, 0x01000193);
  return hash >>> 0;
}

// floor(a / b) of whole numbers below 2^53, which the division of doubles may miss by one.
function floorQuotient(a: number, b: number): number {
  const q = Math.floor(a / b);
  return q * b > a ? q - 1 : (q + 1) * b <= a ? q + 1 : q;
}

export class DeltaDecoder {
  private readonly hierarchy: Hierarchy;
  private readonly weights: Int32Array;
  private readonly movement: Int32Array;
  private readonly last: Int32Array;
  private ready = false;  // a key frame has come, and no frame was missed since

  constructor(triangles: Uint32Array, rest: Float32Array, private readonly box: Box) {
    const grid = new Int32Array(rest.length);
    snapToGrid(rest, box, grid);
    this.hierarchy = buildHierarchy(triangles, grid);
    this.weights = weightsOf(this.hierarchy, grid);
    this.movement = new Int32Array(rest.length);
    this.last = new Int32Array(rest.length);
  }

  get needsKeyFrame(): boolean { return !this.ready; }

  // Takes a key frame. False: its checksum is another one.
  setKeyFrame(positions: Float32Array, checksum: number): boolean {
    snapToGrid(positions, this.box, this.last);
    this.ready = gridChecksum(this.last) === checksum >>> 0;
    return this.ready;
  }

  // Takes a difference. False: a frame was missed, and a key frame is needed.
  addResiduals(residuals: [Int32Array, Int32Array, Int32Array], checksum: number): boolean {
    if (!this.ready) return false;
    const {order, starts, neighbors} = this.hierarchy;
    const {movement, weights, last} = this;
    for (let i = 0; i < order.length; ++i) {
      const v = 3 * order[i]!, begin = starts[i]!, end = starts[i + 1]!;
      for (let c = 0; c < 3; ++c) {
        let predicted = i > 0 ? movement[3 * order[i - 1]! + c]! : 0;
        if (end > begin) {
          let sum = kWeightSum / 2;
          for (let e = begin; e < end; ++e) sum += weights[e]! * movement[3 * neighbors[e]! + c]!;
          predicted = Math.floor(sum / kWeightSum);
        }
        movement[v + c] = predicted + residuals[c]![i]!;
        last[v + c] = last[v + c]! + movement[v + c]!;
      }
    }
    this.ready = gridChecksum(last) === checksum >>> 0;
    return this.ready;
  }

  positions(): Float32Array {
    const {last, box} = this;
    const positions = new Float32Array(last.length);
    for (let i = 0; i < last.length; ++i) positions[i] = box.origin[i % 3]! + last[i]! * box.step;
    return positions;
  }
}

function weightsOf({order, starts, neighbors}: Hierarchy, grid: Int32Array): Int32Array {
  const weights = new Int32Array(neighbors.length);
  for (let i = 0; i < order.length; ++i) {
    const begin = starts[i]!, end = starts[i + 1]!;
    const inverse: number[] = [];
    for (let e = begin; e < end; ++e) {
      inverse.push(floorQuotient(2 ** 40, 1 + squaredDistance(grid, neighbors[e]!, order[i]!)) + 1);
    }
    const sum = inverse.reduce((a, b) => a + b, 0);
    let left = kWeightSum;
    for (let e = begin; e < end; ++e) {
      weights[e] = e + 1 === end ? left : floorQuotient(inverse[e - begin]! * kWeightSum, sum);
      left -= weights[e]!;
    }
  }
  return weights;
}
