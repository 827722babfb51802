// The order in which differences are sent and the neighbors that predict each vertex: the surface
// hierarchy of lib/geometry/src/surface_hierarchy.cpp, built from whole numbers alone, so that both
// sides get the same bit for bit (docs/formats/frame_stream.md).

const kMaxNeighbors = 12;
const kNumCoarsest = 24;

export interface Hierarchy {
  order: Int32Array;             // from coarse to fine
  starts: Int32Array;            // of the neighbors of order[i]; one more entry than vertices
  neighbors: Int32Array;
}

function adjacencyOf(numVertices: number, triangles: Uint32Array): number[][] {
  const sets = Array.from({length: numVertices}, () => new Set<number>());
  for (let t = 0; t < triangles.length; t += 3) {
    for (let c = 0; c < 3; ++c) {
      const a = triangles[t + c]!, b = triangles[t + (c + 1) % 3]!;
      if (a === b) continue;
      sets[a]!.add(b);
      sets[b]!.add(a);
    }
  }
  return sets.map((set) => [...set].sort((a, b) => a - b));
}

// Vertices with few edges first, none beside another one.
function chooseRemoved(active: number[], adjacency: number[][]): number[] {
  const candidates = [...active].sort((a, b) => adjacency[a]!.length - adjacency[b]!.length);  // stable
  const most = active.length - kNumCoarsest;
  const kept = new Uint8Array(adjacency.length);
  const removed: number[] = [];
  for (const v of candidates) {
    if (removed.length >= most) break;
    const size = adjacency[v]!.length;
    if (kept[v] || size === 0 || size > kMaxNeighbors) continue;
    removed.push(v);
    for (const n of adjacency[v]!) kept[n] = 1;
  }
  return removed;
}

// Joins v to its nearest neighbor, which inherits its edges.
function collapse(v: number, grid: Int32Array, adjacency: number[][]): void {
  let nearest = -1, least = 0;
  for (const n of adjacency[v]!) {
    const cost = squaredDistance(grid, n, v);
    if (nearest < 0 || cost < least) [nearest, least] = [n, cost];
  }
  for (const n of adjacency[v]!) {
    const near = adjacency[n]!;
    near.splice(near.indexOf(v), 1);
    if (n === nearest || near.includes(nearest)) continue;
    near.push(nearest);
    adjacency[nearest]!.push(n);
  }
  adjacency[v] = [];
}

export function squaredDistance(grid: Int32Array, a: number, b: number): number {
  let sum = 0;
  for (let c = 0; c < 3; ++c) sum += (grid[3 * a + c]! - grid[3 * b + c]!) ** 2;
  return sum;
}

// grid: 3 V whole numbers, the rest positions.
export function buildHierarchy(triangles: Uint32Array, grid: Int32Array): Hierarchy {
  const numVertices = grid.length / 3;
  const adjacency = adjacencyOf(numVertices, triangles);
  const predictors: number[][] = Array.from({length: numVertices}, () => []);
  const levels: number[][] = [];
  let active = Array.from({length: numVertices}, (_, v) => v);
  while (active.length > kNumCoarsest) {
    const removed = chooseRemoved(active, adjacency);
    if (removed.length === 0) break;
    for (const v of removed) predictors[v] = [...adjacency[v]!];
    for (const v of removed) collapse(v, grid, adjacency);
    active = active.filter((v) => predictors[v]!.length === 0);
    levels.push(removed);
  }
  const order = [...active, ...levels.reverse().flat()];
  const starts = new Int32Array(numVertices + 1);
  order.forEach((v, i) => { starts[i + 1] = starts[i]! + predictors[v]!.length; });
  return {order: Int32Array.from(order), starts, neighbors: Int32Array.from(order.flatMap((v) => predictors[v]!))};
}
