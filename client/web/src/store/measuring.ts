// The error of every frame: the character's frames of the take's own poses against the take, one after
// the other, while nothing else is asked for. Errors are mean distances of vertices, mm.
import type {Live} from '../api/live';
import {distancesMm, mean} from '../scene/surface';
import type {Document} from './document';
import {kPlainLook} from './motion';

export class Measuring {
  errorsMm: (number | undefined)[] = [];
  confidences: (number | undefined)[] = [];
  running = false;
  private next = 0;

  constructor(private readonly live: Live, private readonly document: Document, private readonly changed: () => void) {}

  start(): void {
    const {document} = this;
    this.errorsMm = [];
    this.confidences = [];
    this.next = 0;
    this.running = Boolean(document.model && document.motion && document.takes.current?.done
      && document.takes.current.shape.numVertices === document.model.numVertices
      && document.takes.current.shape.numFrames === document.motion.frames.length);
    this.live.drop('measure');
    if (!this.running) return;
    this.live.want('measure', document.model!.id, kPlainLook);
    this.ask();
  }
  stop(): void {
    this.running = false;
    this.live.drop('measure');
  }
  take(positions: Float32Array, confidence: number): void {
    const truth = this.document.takes.current?.frames[this.next];
    if (!this.running || !truth) return;
    this.errorsMm[this.next] = mean(distancesMm(positions, truth));
    this.confidences[this.next] = confidence;
    if (++this.next >= this.document.numFrames) this.stop();
    else this.ask();
    if (this.next % 8 === 0 || !this.running) this.changed();
  }
  worst(count: number): {frame: number; mm: number}[] {
    const all = this.errorsMm.flatMap((mm, frame) => mm === undefined ? [] : [{frame, mm}]).sort((a, b) => b.mm - a.mm);
    const chosen: {frame: number; mm: number}[] = [];  // not all beside each other
    for (const entry of all) {
      if (chosen.length < count && chosen.every((other) => Math.abs(other.frame - entry.frame) > 3)) chosen.push(entry);
    }
    return chosen;
  }
  get text(): string {
    const known = this.errorsMm.filter((mm) => mm !== undefined);
    if (known.length === 0) return '';
    const average = known.reduce((sum, mm) => sum + mm, 0) / known.length;
    return this.running ? `Measuring: ${known.length} of ${this.document.numFrames} frames` : `${average.toFixed(2)} mm on average over all frames, measured here.`;
  }

  private ask(): void {
    const {document} = this, shown = document.frame;
    document.frame = this.next;  // the poses of another frame than the one that is shown
    const poses = document.posesFor(false);
    document.frame = shown;
    this.live.show('measure', poses);
  }
}
