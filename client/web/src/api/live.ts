// The live sessions of the page: which views have one, what they were asked for last, and how soon they
// answered. A session that is lost is opened again, later each time it fails.
import type {Pose} from '../math/skeleton';
import type {Look} from '../store/motion';
import type {FrameArrived, FramesChoice, FromWorker, SessionReady, ToWorker} from '../worker/messages';
import {currentToken} from './calls';

export interface LiveEvents {
  ready(view: string, message: SessionReady): void;
  frame(view: string, message: FrameArrived, roundTripMs: number): void;
  refused(view: string, message: string): void;
  lost(view: string, code: string, message: string, retrySeconds: number | null): void;
}
interface Open {
  view: string; modelId: string; look: Look; started: Look; session: number; ready: boolean; last: Pose[] | null;
  asked: Map<number, number>; failures: number; timer: number;
}
const kFinal = new Set(['NOT_FOUND', 'PERMISSION_DENIED', 'INVALID_ARGUMENT', 'UNAUTHENTICATED', 'UNIMPLEMENTED']);
const kMaxInFlight = 3;

export class Live {
  private readonly worker = new Worker('/worker.js', {type: 'module'});
  private readonly open = new Map<string, Open>();
  private nextSession = 1;
  private nextNumber = 1;

  constructor(private readonly events: LiveEvents, private readonly frames: FramesChoice) {
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => this.take(event.data);
  }

  // Opens a session for a view unless it has the same one already. A look that changes while its session
  // opens waits for that, so that a slider which is dragged opens no more than one at a time.
  want(view: string, modelId: string, look: Look): void {
    const old = this.open.get(view);
    if (old?.modelId === modelId) {
      if (old.look === look) return;
      old.look = look;
      if (old.ready || old.timer) this.restart(old);
      return;
    }
    this.drop(view);
    const entry: Open = {view, modelId, look, started: look, session: 0, ready: false, last: null, asked: new Map(), failures: 0, timer: 0};
    this.open.set(view, entry);
    this.start(entry);
  }
  private restart(entry: Open): void {
    clearTimeout(entry.timer);
    this.post({kind: 'close', session: entry.session});
    this.start(entry);
  }
  drop(view: string): void {
    const entry = this.open.get(view);
    if (!entry) return;
    clearTimeout(entry.timer);
    this.post({kind: 'close', session: entry.session});
    this.open.delete(view);
  }
  dropAll(): void { [...this.open.keys()].forEach((view) => this.drop(view)); }
  // Tries again at once whatever waits, after the server has come back.
  retryNow(): void {
    for (const entry of this.open.values()) {
      if (!entry.timer) continue;
      clearTimeout(entry.timer);
      this.start(entry);
    }
  }

  // Asks for a frame and returns its number, which the answer has.
  show(view: string, poses: Pose[]): number {
    const entry = this.open.get(view);
    if (!entry) return 0;
    entry.last = poses;
    const number = this.nextNumber++;
    entry.asked.set(number, performance.now());
    this.post({kind: 'show', session: entry.session, number, poses});
    return number;
  }

  private post(message: ToWorker): void { this.worker.postMessage(message); }
  private start(entry: Open): void {
    entry.timer = 0;
    entry.session = this.nextSession++;
    entry.ready = false;
    entry.started = entry.look;
    entry.asked.clear();
    const url = `${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/live`;
    this.post({kind: 'open', session: entry.session, modelId: entry.modelId, look: entry.look, frames: this.frames,
      token: currentToken(), url, maxInFlight: kMaxInFlight});
    if (entry.last) this.show(entry.view, entry.last);
  }

  private take(message: FromWorker): void {
    const entry = [...this.open.values()].find((other) => other.session === message.session);
    if (!entry) return;
    if (message.kind === 'ready') {
      entry.ready = true;
      entry.failures = 0;
      if (entry.started !== entry.look) return this.restart(entry);
      this.events.ready(entry.view, message);
    } else if (message.kind === 'frame') {
      const asked = entry.asked.get(message.number) ?? performance.now();
      for (const number of entry.asked.keys()) if (number <= message.number) entry.asked.delete(number);
      this.events.frame(entry.view, message, performance.now() - asked);
    } else if (message.kind === 'refused') {
      this.events.refused(entry.view, message.message);
    } else {
      const final = kFinal.has(message.code);
      const seconds = Math.min(15, 2 ** entry.failures++ / 2);
      if (!final) entry.timer = window.setTimeout(() => this.start(entry), 1e3 * seconds);
      this.events.lost(entry.view, message.code, message.message, final ? null : seconds);
    }
  }
}
