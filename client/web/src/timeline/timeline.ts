// The timeline: scrubbing, keys, the error and the confidence of each frame.
import {byId, element} from '../panels/dom';

export interface TimelineState {
  frame: number; numFrames: number; numLoaded: number; fps: number; playing: boolean; loop: boolean; showCurves: boolean; posable: boolean;
  keys: ReadonlySet<number>; otherKeys: ReadonlySet<number>;
  errorsMm: readonly (number | undefined)[]; confidences: readonly (number | undefined)[]; scaleMm: number;
}
export interface TimelineActions { seek(frame: number): void; play(): void; loop(on: boolean): void; curves(on: boolean): void; step(by: number): void }

const kTop = 14, kBottom = 14;

export class Timeline {
  private readonly canvas = element('canvas', {tabindex: 0, role: 'slider', 'aria-label': 'Frame', 'aria-valuemin': 0});
  private readonly playButton = element('button', {type: 'button', id: 'play', 'aria-label': 'Play or stop'}, '▶');
  private readonly frameInput = element('input', {type: 'number', min: 0, 'aria-label': 'Frame number', id: 'frame'});
  private readonly count = element('span', {class: 'soft', id: 'frame-count'});
  private readonly loopBox = element('input', {type: 'checkbox', id: 'loop'});
  private readonly curvesButton = element('button', {type: 'button', id: 'toggle-curves', title: 'V'}, 'Curves');
  private state: TimelineState | null = null;

  constructor(actions: TimelineActions) {
    byId('timeline').append(
      element('div', {class: 'transport'},
        element('button', {type: 'button', class: 'icon', 'aria-label': 'Previous frame', click: () => actions.step(-1)}, '◂'),
        this.playButton,
        element('button', {type: 'button', class: 'icon', 'aria-label': 'Next frame', click: () => actions.step(1)}, '▸'),
        this.frameInput, this.count, element('label', {for: 'loop'}, ' '), this.loopBox, element('label', {for: 'loop'}, 'loop'), this.curvesButton),
      element('div', {class: 'right'}, this.canvas));
    this.playButton.addEventListener('click', () => actions.play());
    this.curvesButton.addEventListener('click', () => actions.curves(!this.state?.showCurves));
    this.frameInput.addEventListener('change', () => actions.seek(Number(this.frameInput.value)));
    this.loopBox.addEventListener('change', () => actions.loop(this.loopBox.checked));
    const scrub = (event: PointerEvent): void => {
      const {left, width} = this.canvas.getBoundingClientRect();
      actions.seek(Math.round((event.clientX - left - 8) / Math.max(1, width - 16) * ((this.state?.numFrames ?? 1) - 1)));
    };
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      scrub(event);
    });
    this.canvas.addEventListener('pointermove', (event) => { if (event.buttons & 1) scrub(event); });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  show(state: TimelineState): void {
    this.state = state;
    byId('timeline').hidden = state.numFrames < 2;
    this.playButton.textContent = state.playing ? '❚❚' : '▶';
    this.playButton.setAttribute('aria-pressed', String(state.playing));
    if (document.activeElement !== this.frameInput) this.frameInput.value = String(state.frame);
    this.frameInput.max = String(state.numFrames - 1);
    this.count.textContent = `of ${state.numFrames} · ${Number(state.fps.toFixed(2))} fps`;
    this.loopBox.checked = state.loop;
    this.curvesButton.hidden = !state.posable;
    this.curvesButton.setAttribute('aria-pressed', String(state.showCurves));
    this.canvas.setAttribute('aria-valuemax', String(state.numFrames - 1));
    this.canvas.setAttribute('aria-valuenow', String(state.frame));
    this.draw();
  }

  private draw(): void {
    const state = this.state, {clientWidth: width, clientHeight: height} = this.canvas;
    if (!state || width === 0) return;
    const ratio = devicePixelRatio;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const pen = this.canvas.getContext('2d')!;
    pen.scale(ratio, ratio);
    const style = getComputedStyle(document.body), color = (name: string): string => style.getPropertyValue(name);
    const x = (frame: number): number => 8 + frame / Math.max(1, state.numFrames - 1) * (width - 16);
    pen.fillStyle = color('--line');
    pen.fillRect(8, kTop - 4, (width - 16) * Math.min(1, state.numLoaded / state.numFrames), 2);
    this.ticks(pen, x, color('--soft'), color('--line'), height);
    const plot = height - kTop - kBottom;
    this.curve(pen, x, state.confidences, (value) => kTop + plot * (1 - value), color('--good'));
    this.curve(pen, x, state.errorsMm, (value) => kTop + plot * (1 - Math.min(1, value / state.scaleMm)), color('--accent'));
    for (const frame of state.otherKeys) this.diamond(pen, x(frame), height - 7, color('--line'));
    for (const frame of state.keys) this.diamond(pen, x(frame), height - 7, color('--accent'));
    pen.fillStyle = color('--text');
    pen.fillRect(Math.round(x(state.frame)), 0, 1.5, height);
  }
  private ticks(pen: CanvasRenderingContext2D, x: (frame: number) => number, text: string, line: string, height: number): void {
    const numFrames = this.state!.numFrames, room = Math.max(1, (x(numFrames - 1) - x(0)) / 60);
    const step = [1, 2, 5, 10, 20, 25, 50, 100, 200, 500, 1000, 2000, 5000].find((size) => numFrames / size <= room) ?? 10000;
    pen.font = '10px system-ui, sans-serif';
    for (let frame = 0; frame < numFrames; frame += step) {
      pen.fillStyle = line;
      pen.fillRect(Math.round(x(frame)), kTop, 1, height - kTop - kBottom);
      pen.fillStyle = text;
      pen.fillText(String(frame), x(frame) + 2, 9);
    }
  }
  private curve(pen: CanvasRenderingContext2D, x: (frame: number) => number, values: readonly (number | undefined)[],
                y: (value: number) => number, color: string): void {
    pen.strokeStyle = color;
    pen.lineWidth = 1.5;
    pen.beginPath();
    let drawing = false;
    for (let frame = 0; frame < values.length; ++frame) {
      const value = values[frame];
      if (value === undefined) drawing = false;
      else if (drawing) pen.lineTo(x(frame), y(value));
      else {
        pen.moveTo(x(frame), y(value));
        drawing = true;
      }
    }
    pen.stroke();
  }
  private diamond(pen: CanvasRenderingContext2D, x: number, y: number, color: string): void {
    pen.fillStyle = color;
    pen.beginPath();
    pen.moveTo(x, y - 5);
    pen.lineTo(x + 5, y);
    pen.lineTo(x, y + 5);
    pen.lineTo(x - 5, y);
    pen.fill();
  }
}
