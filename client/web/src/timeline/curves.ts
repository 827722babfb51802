// The curves of one joint: how its keys change the take over time, one curve for each axis. A key is
// dragged up and down to change its angle, and sideways to move it in time.
import {byId, element} from '../panels/dom';
import {fromDegrees, toDegrees, type Vector3} from '../math/quaternion';
import {changeKey, moveAt, turnAt, type Edits} from '../store/motion';

export interface CurvesState { frame: number; numFrames: number; joint: number; jointName: string; edits: Edits }
export interface CurvesActions { change(edits: Edits, label: string, gesture: string): void; ease(): void; seek(frame: number): void }
type Channel = 'turn' | 'move';

const kAxes = ['x', 'y', 'z'], kColors = ['--axis-x', '--axis-y', '--axis-z'];
const kReach = 9;  // pixels around a key
const kMargin = 8, kPad = 10;

export class Curves {
  readonly row: HTMLElement;
  private readonly canvas = element('canvas', {id: 'curves', role: 'img'});
  private readonly title = element('b', {});
  private readonly channel = element('select', {id: 'curve-channel', 'aria-label': 'What the curves show'},
    element('option', {value: 'turn'}, 'Turn, °'), element('option', {value: 'move'}, 'Move, cm'));
  private readonly easeButton: HTMLButtonElement;
  private state: CurvesState | null = null;
  private drag: {frame: number; axis: number; from: Edits; low: number; high: number} | null = null;
  private gesture = 0;

  constructor(private readonly actions: CurvesActions) {
    this.easeButton = element('button', {type: 'button', id: 'ease', title: 'The change after this key starts and ends at rest'}, 'Ease');
    this.easeButton.addEventListener('click', () => actions.ease());
    this.channel.addEventListener('change', () => this.draw());
    this.row = element('div', {class: 'curves', hidden: true},
      element('div', {class: 'transport'}, this.title, this.channel, this.easeButton), element('div', {class: 'right'}, this.canvas));
    byId('timeline').append(this.row);
    this.canvas.addEventListener('pointerdown', (event) => this.press(event));
    this.canvas.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) this.canvas.addEventListener(end, () => { this.drag = null; });
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  show(state: CurvesState, open: boolean): void {
    this.state = state;
    this.row.hidden = !open || state.numFrames < 2 || state.joint < 0;
    if (this.row.hidden) return;
    this.title.textContent = state.jointName;
    this.channel.hidden = state.joint !== 0;  // only the root is moved
    const before = this.keys().findLast((key) => key.frame <= state.frame);
    this.easeButton.disabled = !before;
    this.easeButton.setAttribute('aria-pressed', String(before?.ease === true));
    this.canvas.setAttribute('aria-label', `Curves of ${state.jointName}: ${this.keys().length} keys; the angles of the panel change the key at this frame`);
    this.draw();
  }

  private get kind(): Channel { return this.state?.joint === 0 ? this.channel.value as Channel : 'turn'; }
  private keys(): readonly {frame: number; ease?: boolean}[] {
    const {edits, joint} = this.state!;
    return this.kind === 'move' ? edits.moves : edits.turns.get(joint) ?? [];
  }
  // Degrees, or centimeters.
  private values(frame: number, edits = this.state!.edits): Vector3 {
    if (this.kind === 'move') return moveAt(edits.moves, frame).map((x) => 100 * x) as unknown as Vector3;
    return toDegrees(turnAt(edits.turns.get(this.state!.joint), frame));
  }
  private range(): [number, number] {
    if (this.drag) return [this.drag.low, this.drag.high];
    const all = Array.from({length: this.state!.numFrames}, (_, frame) => this.values(frame)).flat();
    const low = Math.min(-10, ...all), high = Math.max(10, ...all), more = .15 * (high - low);
    return [low - more, high + more];
  }
  private x(frame: number): number { return kMargin + frame / Math.max(1, this.state!.numFrames - 1) * (this.canvas.clientWidth - 2 * kMargin); }
  private y(value: number, [low, high]: [number, number]): number {
    return kPad + (high - value) / (high - low) * (this.canvas.clientHeight - 2 * kPad);
  }
  private at(event: PointerEvent): {frame: number; value: number; px: number; py: number} {
    const box = this.canvas.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
    const [low, high] = this.range();
    return {px, py, frame: Math.round((px - kMargin) / Math.max(1, box.width - 2 * kMargin) * (this.state!.numFrames - 1)),
      value: high - (py - kPad) / Math.max(1, box.height - 2 * kPad) * (high - low)};
  }

  private press(event: PointerEvent): void {
    if (!this.state) return;
    const {px, py, frame} = this.at(event), range = this.range();
    let least = kReach, found: {frame: number; axis: number} | null = null;
    for (const key of this.keys()) {
      this.values(key.frame).forEach((value, axis) => {
        const distance = Math.hypot(this.x(key.frame) - px, this.y(value, range) - py);
        if (distance < least) [least, found] = [distance, {frame: key.frame, axis}];
      });
    }
    this.canvas.setPointerCapture(event.pointerId);
    if (!found) return this.actions.seek(frame);
    ++this.gesture;
    this.drag = {...found as {frame: number; axis: number}, from: this.state.edits, low: range[0], high: range[1]};
  }
  private move(event: PointerEvent): void {
    if (!this.drag || !this.state) return;
    const {frame, value} = this.at(event), {drag} = this, {joint, numFrames, jointName} = this.state;
    const values = [...this.values(drag.frame, drag.from)];
    values[drag.axis] = value;
    const to = Math.min(numFrames - 1, Math.max(0, frame));
    const change = this.kind === 'move' ? {move: values.map((x) => x / 100) as unknown as Vector3} : {turn: fromDegrees(values as unknown as Vector3)};
    this.actions.change(changeKey(drag.from, joint, drag.frame, to, change), `key of ${jointName}`, `curve${this.gesture}`);
  }

  private draw(): void {
    const {state} = this, {clientWidth: width, clientHeight: height} = this.canvas;
    if (!state || width === 0 || this.row.hidden) return;
    this.canvas.width = width * devicePixelRatio;
    this.canvas.height = height * devicePixelRatio;
    const pen = this.canvas.getContext('2d')!, style = getComputedStyle(document.body), range = this.range();
    const color = (name: string): string => style.getPropertyValue(name);
    pen.scale(devicePixelRatio, devicePixelRatio);
    pen.font = '10px system-ui, sans-serif';
    const step = [5, 10, 20, 45, 90, 180].find((size) => (range[1] - range[0]) / size <= 5) ?? 360;
    for (let value = step * Math.ceil(range[0] / step); value <= range[1]; value += step) {
      pen.fillStyle = color('--line');
      pen.fillRect(kMargin, Math.round(this.y(value, range)), width - 2 * kMargin, 1);
      pen.fillStyle = color('--soft');
      pen.fillText(String(value), kMargin + 2, this.y(value, range) - 2);
    }
    const frames = Array.from({length: state.numFrames}, (_, frame) => this.values(frame));
    kAxes.forEach((name, axis) => {
      pen.strokeStyle = pen.fillStyle = color(kColors[axis]!);
      pen.lineWidth = 1.5;
      pen.beginPath();
      frames.forEach((values, frame) => pen.lineTo(this.x(frame), this.y(values[axis]!, range)));
      pen.stroke();
      pen.fillText(name, width - kMargin - 8, this.y(frames.at(-1)![axis]!, range) - 3);
      for (const key of this.keys()) pen.fillRect(this.x(key.frame) - 3.5, this.y(frames[key.frame]![axis]!, range) - 3.5, 7, 7);
    });
    pen.fillStyle = color('--text');
    pen.fillRect(Math.round(this.x(state.frame)), 0, 1.5, height);
  }
}
