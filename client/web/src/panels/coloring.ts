// What the colors of the vertices show.
import {request} from '../api/calls';
import {distancesMm, jointColorLinear, turboLinear, type Surface} from '../scene/surface';

export type Coloring = 'none' | 'error' | 'confidence' | 'weights';
export interface Colored { truth: Float32Array | undefined; confidence: number | undefined; scaleMm: number }

export class Colors {
  private strongest: Uint16Array | null = null;  // the bone that moves each vertex most

  forget(): void { this.strongest = null; }
  async loadWeights(modelId: string): Promise<void> {
    this.strongest ??= strongestBones(await (await request(`/studio/models/${modelId}/rig`)).json() as RigFile);
  }
  // truth and confidence: undefined where there is none.
  paint(surface: Surface, by: Coloring, {truth, confidence, scaleMm}: Colored): void {
    if (by === 'error' && truth && truth.length === surface.positions.length) {
      const distances = distancesMm(surface.positions, truth);
      surface.color((v) => turboLinear(distances[v]! / scaleMm));
    } else if (by === 'confidence' && confidence !== undefined) {
      const color = turboLinear(confidence);
      surface.color(() => color);
    } else if (by === 'weights' && this.strongest?.length === surface.numVertices) {
      surface.color((v) => jointColorLinear(this.strongest![v]!));
    } else {
      surface.color(null);
    }
  }
}

// The strongest bone of each vertex, of a rig file with the weights of bones (docs/formats/rig.md): each
// list is joint, weight, joint, weight, and so on.
interface RigFile { weights: {vertices: number[][]} }
function strongestBones(rig: RigFile): Uint16Array {
  return Uint16Array.from(rig.weights.vertices, (row) => {
    let best = 0;
    for (let i = 2; i < row.length; i += 2) if (row[i + 1]! > row[best + 1]!) best = i;
    return row[best]!;
  });
}
