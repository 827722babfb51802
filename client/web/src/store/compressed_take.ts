// The frames of a compressed sequence around the moment that is shown: the server decodes what is needed
// next, and what is far away is forgotten, so the sequence may be longer than memory.
import {decodeFrames} from '../api/sequence_stream';
import type {LoadedTake} from './takes';

const kMostBytes = 3e8;
const kAhead = 64;  // frames that are asked for at once

// Which frames to ask for next when `frame` is shown: from the first one that is missing soon, or none.
export function nextRange(frames: readonly (Float32Array | undefined)[], frame: number, ahead = kAhead): [number, number] | null {
  for (let t = frame; t < Math.min(frames.length, frame + ahead / 2); ++t) {
    if (!frames[t]) return [t, Math.min(frames.length, t + ahead)];
  }
  return null;
}
// Forgets the frames that are farthest from `frame` until `most` are left.
export function forgetFar(frames: (Float32Array | undefined)[], frame: number, most: number): void {
  const kept = frames.flatMap((positions, t) => positions ? [t] : []);
  kept.sort((a, b) => Math.abs(b - frame) - Math.abs(a - frame));
  for (const t of kept.slice(0, Math.max(0, kept.length - most))) frames[t] = undefined;
}

export class CompressedTake {
  private decoding: AbortController | null = null;
  private range: [number, number] = [0, 0];  // what is being decoded
  private frame = 0;

  constructor(readonly take: LoadedTake, private readonly arrived: (frame: number) => void, private readonly failed: (error: unknown) => void) {}

  // Brings the frame that is shown and those after it.
  want(frame: number): void {
    this.frame = frame;
    const next = nextRange(this.take.frames, frame);
    if (!next || (this.decoding && next[0] >= this.range[0] && next[0] < this.range[1])) return;
    this.decoding?.abort();
    const controller = this.decoding = new AbortController();
    this.range = next;
    decodeFrames(this.take.id, next[0], next[1], controller.signal, (shape) => {
      this.take.shape = {...shape, numFrames: this.take.frames.length};
    }, (t, positions) => {
      this.take.frames[t] = positions;
      this.range = [t + 1, next[1]];
      forgetFar(this.take.frames, this.frame, Math.max(2 * kAhead, Math.floor(kMostBytes / positions.byteLength)));
      this.arrived(t);
    }).catch((error: unknown) => { if (!controller.signal.aborted) this.failed(error); }).finally(() => {
      if (this.decoding === controller) this.decoding = null;
    });
  }
  stop(): void { this.decoding?.abort(); }
}
