// The frames of takes that the page has downloaded, as many as memory is meant for.
import {readSequence, type Shape} from '../api/sequence_stream';
import {CompressedTake} from './compressed_take';

export interface LoadedTake { id: string; shape: Shape; frames: (Float32Array | undefined)[]; numLoaded: number; done: boolean }
const kMaxBytes = 1.5e9;

export class Takes {
  private compressed: CompressedTake | null = null;
  private loading: AbortController | null = null;
  current: LoadedTake | null = null;

  // changed: the shape or the first frame has come, or all have.
  async load(id: string, changed: (take: LoadedTake) => void): Promise<void> {
    if (this.current?.id === id) return;
    this.forget();
    const controller = this.loading = new AbortController();
    let take: LoadedTake | undefined;
    try {
      await readSequence(id, controller.signal, (shape) => {
        if (12 * shape.numVertices * shape.numFrames > kMaxBytes) {
          throw new Error('This take is larger than a page can hold. Train it, and look at the character instead.');
        }
        take = this.current = {id, shape, frames: new Array<undefined>(shape.numFrames), numLoaded: 0, done: false};
      }, (frame, positions) => {
        take!.frames[frame] = positions;
        ++take!.numLoaded;
        if (frame === 0) changed(take!);
      });
      take!.done = true;
      changed(take!);
    } catch (error) {
      if (!controller.signal.aborted) throw error;
    }
  }
  // Plays a compressed sequence without having all of it.
  play(id: string, numFrames: number, arrived: (frame: number) => void, failed: (error: unknown) => void): void {
    this.forget();
    this.current = {id, shape: {numVertices: 0, numFrames, triangles: new Uint32Array()}, frames: new Array<undefined>(numFrames), numLoaded: numFrames, done: true};
    this.compressed = new CompressedTake(this.current, arrived, failed);
  }
  want(frame: number): void { this.compressed?.want(frame); }
  forget(): void {
    this.loading?.abort();
    this.compressed?.stop();
    this.compressed = null;
    this.current = null;
  }
}
