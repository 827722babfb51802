// The panel on the right: what is shown, the joint that is selected, and how good the character is.
import type {Model, StoredTake} from '../api/types';
import {toDegrees, type Vector3} from '../math/quaternion';
import {readableName, type Joint, type Pose} from '../math/skeleton';
import {kMaxStrength} from '../store/motion';
import {kViewNames, type ViewName} from '../scene/viewport';
import type {Coloring} from './coloring';
import {byId, element} from './dom';

export interface SideState {
  views: readonly ViewName[]; available: ReadonlySet<ViewName>; coloring: Coloring; showBones: boolean; showNames: boolean;
  joints: readonly Joint[]; joint: number; pose: Pose | null; change: Vector3; keyed: boolean; edited: boolean; gizmo: 'rotate' | 'translate';
  strengths: readonly number[];  // of the learned detail, by joint
  model: Model | null; report: StoredTake | null; worst: readonly {frame: number; mm: number}[]; measured: string;
  undo: string | undefined; redo: string | undefined;
}
export interface SideActions {
  toggleView(view: ViewName): void; color(by: Coloring): void; bones(on: boolean): void; names(on: boolean): void;
  select(joint: number): void; turn(joint: number, degrees: Vector3, gesture: string): void; key(): void; unkey(): void; reset(): void;
  strength(value: number, all: boolean, gesture: string): void; gizmo(mode: 'rotate' | 'translate'): void; seek(frame: number): void; undo(): void; redo(): void;
}

const kViewTitles: Record<ViewName, string> = {input: 'Input', skinned: 'Skinned', hybrid: 'Hybrid', edited: 'Edited'};
const button = (text: string, act: () => void, more: Record<string, string | boolean> = {}): HTMLButtonElement =>
  element('button', {type: 'button', click: act, ...more}, text);

// A slider of the strength of the folds, 0 (skinning alone) to twice what was learned.
class StrengthRow {
  readonly row: HTMLElement;
  private readonly slider: HTMLInputElement;
  private readonly text = element('output', {class: 'soft'});
  private gesture = 0;

  constructor(label: string, id: string, set: (value: number, gesture: string) => void) {
    this.slider = element('input', {type: 'range', id, min: 0, max: kMaxStrength, step: .05});
    this.slider.addEventListener('pointerdown', () => { ++this.gesture; });
    this.slider.addEventListener('input', () => set(Number(this.slider.value), `${id}${this.gesture}`));
    this.row = element('div', {class: 'row'}, element('label', {for: id}, label), this.slider, this.text);
  }
  // strength: undefined where joints have different ones.
  show(strength: number | undefined, enabled = true): void {
    this.slider.disabled = !enabled;
    if (document.activeElement !== this.slider && strength !== undefined) this.slider.value = String(strength);
    this.text.textContent = strength === undefined ? enabled ? 'mixed' : '–' : `${Math.round(100 * strength)} %`;
  }
}

// Elements are kept while they are used, so that a slider that is dragged is not replaced.
export class SidePanel {
  private readonly views = element('section');
  private readonly joint = element('section');
  private readonly quality = element('section');
  private readonly angles: {slider: HTMLInputElement; number: HTMLInputElement}[] = [];
  private readonly jointSelect = element('select', {id: 'joint', 'aria-label': 'Joint'});
  private readonly folds = element('section');
  private readonly foldsOfAll: StrengthRow;
  private readonly foldsOfJoint: StrengthRow;
  private readonly jointButtons = element('div', {class: 'buttons'});
  private readonly place = element('p', {class: 'soft', id: 'place'});
  private joints: readonly Joint[] = [];
  private gesture = 0;
  private readonly shown = new Map<HTMLElement, string>();

  constructor(private readonly actions: SideActions) {
    const rows = ['x', 'y', 'z'].flatMap((axis, i) => {
      const slider = element('input', {type: 'range', min: -180, max: 180, step: .5, 'aria-label': `Turn about ${axis}, degrees`});
      const number = element('input', {type: 'number', step: .5, 'aria-label': `Turn about ${axis}, degrees, as a number`});
      const turn = (from: HTMLInputElement): void => {
        const degrees = this.angles.map((row, j) => Number(j === i ? from.value : row.number.value)) as unknown as Vector3;
        actions.turn(Number(this.jointSelect.value), degrees, `slider${this.gesture}`);
      };
      slider.addEventListener('pointerdown', () => { ++this.gesture; });
      slider.addEventListener('input', () => turn(slider));
      number.addEventListener('change', () => {
        ++this.gesture;
        turn(number);
      });
      this.angles.push({slider, number});
      return [element('span', {}, axis), slider, number];
    });
    this.jointSelect.addEventListener('change', () => actions.select(Number(this.jointSelect.value)));
    this.joint.append(element('h2', {}, 'Joint'), this.jointSelect, element('div', {class: 'angles'}, ...rows), this.place, this.jointButtons);
    this.foldsOfAll = new StrengthRow('everywhere', 'folds-all', (value, gesture) => actions.strength(value, true, gesture));
    this.foldsOfJoint = new StrengthRow('at the joint', 'folds-joint', (value, gesture) => actions.strength(value, false, gesture));
    this.folds.append(element('h2', {}, 'Folds'), this.foldsOfAll.row, this.foldsOfJoint.row);
    byId('side').append(this.views, this.joint, this.folds, this.quality);
  }

  show(state: SideState): void {
    this.showViews(state);
    this.joint.hidden = this.folds.hidden = state.joints.length === 0;
    const strengths = state.strengths.slice(1);  // that of the root is not used
    const all = strengths.every((strength) => strength === strengths[0]) ? strengths[0] : undefined;
    this.foldsOfAll.show(all);
    this.foldsOfJoint.show(state.joint > 0 ? state.strengths[state.joint] : undefined, state.joint > 0);
    if (state.joints !== this.joints) {
      this.joints = state.joints;
      this.jointSelect.replaceChildren(...state.joints.map((joint, b) => element('option', {value: b}, readableName(joint.name))));
    }
    this.jointSelect.value = String(Math.max(0, state.joint));
    const degrees = toDegrees(state.pose?.rotations[Math.max(0, state.joint)] ?? [1, 0, 0, 0]);
    this.angles.forEach(({slider, number}, i) => {
      const text = degrees[i]!.toFixed(1);
      if (document.activeElement !== slider) slider.value = text;
      if (document.activeElement !== number) number.value = text;
    });
    this.place.textContent = state.edited ? `Changed here by ${Math.hypot(...state.change).toFixed(0)}°.` : 'As in the take.';
    const {keyed, edited, gizmo, undo, redo} = state;
    if (this.isNew(this.jointButtons, {keyed, edited, gizmo, undo, redo})) this.jointButtons.replaceChildren(
      button('Turn', () => this.actions.gizmo('rotate'), {'aria-pressed': String(state.gizmo === 'rotate'), title: 'R'}),
      button('Move', () => this.actions.gizmo('translate'), {'aria-pressed': String(state.gizmo === 'translate'), title: 'G'}),
      button(state.keyed ? 'Remove key' : 'Set key', () => state.keyed ? this.actions.unkey() : this.actions.key(), {title: 'K'}),
      button('Reset', () => this.actions.reset(), {disabled: !state.edited}),
      button('Undo', () => this.actions.undo(), {disabled: !state.undo, title: state.undo ?? ''}),
      button('Redo', () => this.actions.redo(), {disabled: !state.redo, title: state.redo ?? ''}));
    this.showQuality(state);
  }

  // Whether a part looks different from before; elements that stay keep their focus.
  private isNew(part: HTMLElement, state: unknown): boolean {
    const text = JSON.stringify(state);
    if (this.shown.get(part) === text) return false;
    this.shown.set(part, text);
    return true;
  }

  private showViews(state: SideState): void {
    if (!this.isNew(this.views, [state.views, [...state.available], state.coloring, state.showBones, state.showNames])) return;
    const focused = document.activeElement?.id;
    const select = element('select', {id: 'coloring', 'aria-label': 'Colors'}, ...([['none', 'Plain'], ['error', 'Error against the input'],
      ['confidence', 'Confidence'], ['weights', 'Skinning weights']] as const).map(([value, text]) => element('option', {value}, text)));
    select.value = state.coloring;
    select.addEventListener('change', () => this.actions.color(select.value as Coloring));
    const box = (id: string, text: string, on: boolean, act: (on: boolean) => void): Node => {
      const input = element('input', {type: 'checkbox', id, ...(on ? {checked: true} : {})});
      input.addEventListener('change', () => act(input.checked));
      return element('div', {class: 'row'}, input, element('label', {for: id}, text));
    };
    this.views.replaceChildren(element('h2', {}, 'Views'),
      element('div', {class: 'group', role: 'group', 'aria-label': 'Views'}, ...kViewNames.map((view, i) => button(kViewTitles[view],
        () => this.actions.toggleView(view), {id: `view-${view}`, 'aria-pressed': String(state.views.includes(view)), disabled: !state.available.has(view), title: String(i + 1)}))),
      element('div', {class: 'row'}, element('label', {for: 'coloring'}, 'Colors'), select),
      box('bones', 'Skeleton', state.showBones, this.actions.bones), box('names', 'Names of joints', state.showNames, this.actions.names));
    if (focused && this.views.querySelector(`#${CSS.escape(focused)}`)) byId(focused).focus();
  }

  private showQuality(state: SideState): void {
    const {model, report} = state, rows: [string, string][] = [];
    if (!this.isNew(this.quality, [model?.id, report?.sequence.id, state.worst, state.measured])) return;
    if (model?.record.fit) rows.push(['Skinned only', `${model.record.fit.meanMm.toFixed(2)} mm`]);
    if (model?.record.reconstruction) rows.push(['With folds', `${model.record.reconstruction.meanMm.toFixed(2)} mm`]);
    if (model) rows.push(['Learner', model.record.learner], ['Training frames', String(model.record.numFrames)]);
    const notes = [...(report?.notes ?? []).map((note) => ({severity: note.severity, text: note.text})),
      ...(report?.faults ?? []).map((text) => ({severity: 'note', text})),
      ...(model?.record.warnings ?? []).map((text) => ({severity: 'warning', text}))];
    this.quality.hidden = !model && !report;
    this.quality.replaceChildren(element('h2', {}, model ? 'Quality' : 'The take'),
      rows.length ? element('table', {}, element('tbody', {}, ...rows.map(([name, value]) => element('tr', {}, element('td', {class: 'soft'}, name), element('td', {}, value))))) : '',
      ...(state.worst.length ? [element('h2', {}, 'Worst frames'), element('div', {class: 'buttons'}, ...state.worst.map(({frame, mm}) =>
        button(`${frame}: ${mm.toFixed(1)} mm`, () => this.actions.seek(frame))))] : []),
      state.measured ? element('p', {class: 'soft'}, state.measured) : '',
      report && !notes.length ? element('p', {class: 'good'}, '✓ Nothing is unclean about this take.') : '',
      notes.length ? element('ul', {class: 'notes'}, ...notes.map((note) => element('li', {class: note.severity}, note.text))) : '');
  }
}
