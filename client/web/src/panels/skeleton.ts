// The part of the panel in which the joints of the rest skeleton are moved.
import {byId, element} from './dom';

export interface SkeletonState { open: boolean; why: string; frame: number; numPlaced: number; sided: boolean; placedHere: boolean }
export interface SkeletonActions { open(): void; mirror(): void; reset(): void; train(): void; done(): void }

export class SkeletonPanel {
  private readonly section = element('section', {id: 'skeleton'});
  private shown = '';

  constructor(private readonly actions: SkeletonActions) { byId('side').append(this.section); }

  // why: that the joints cannot be moved, or empty; state: null without a character.
  show(state: SkeletonState | null): void {
    this.section.hidden = state === null;
    const text = JSON.stringify(state);
    if (!state || text === this.shown) return;
    this.shown = text;
    const focused = document.activeElement?.id;
    const button = (id: string, title: string, act: () => void, more: Record<string, string | boolean> = {}): HTMLButtonElement =>
      element('button', {type: 'button', id, click: act, ...more}, title);
    const {actions} = this;
    this.section.replaceChildren(element('h2', {}, 'Rest skeleton'), ...(state.open ? [
      element('p', {class: 'soft', role: 'status'}, `Drag the joints of frame ${state.frame} to where they sit in the body. ${
        state.numPlaced === 0 ? 'None is moved yet.' : state.numPlaced === 1 ? 'One joint is moved.' : `${state.numPlaced} joints are moved.`}`),
      element('div', {class: 'buttons'},
        button('skeleton-mirror', 'Mirror', actions.mirror, {disabled: !state.sided || state.numPlaced === 0, title: 'Puts the other side where the side of the selected joint was moved to'}),
        button('skeleton-reset', 'Reset joint', actions.reset, {disabled: !state.placedHere}),
        button('skeleton-train', 'Train with it…', actions.train, {class: 'main', disabled: state.numPlaced === 0}),
        button('skeleton-done', 'Done', actions.done))] : [
      element('div', {class: 'buttons'}, button('skeleton-open', 'Move its joints…', actions.open, {disabled: state.why !== ''})),
      state.why ? element('p', {class: 'soft'}, state.why) : '']));
    if (focused && this.section.querySelector(`#${CSS.escape(focused)}`)) byId(focused).focus();
  }
}
