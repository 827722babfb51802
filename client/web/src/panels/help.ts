// Every key of the studio: the list under "?" and what each does.
import {dialog, element} from './dom';

export interface KeyAction { keys: string; text: string; matches(event: KeyboardEvent): boolean; run(): void }

const plain = (event: KeyboardEvent): boolean => !event.ctrlKey && !event.metaKey && !event.altKey;
export const key = (name: string, keys: string, text: string, run: () => void): KeyAction =>
  ({keys, text, run, matches: (event) => plain(event) && event.key.toLowerCase() === name && (name === '?' || !event.shiftKey)});
export const shifted = (name: string, keys: string, text: string, run: () => void): KeyAction =>
  ({keys, text, run, matches: (event) => plain(event) && event.shiftKey && event.key.toLowerCase() === name});
// With Control or Command, as other programs have it.
export const command = (name: string, shift: boolean, keys: string, text: string, run: () => void): KeyAction =>
  ({keys, text, run, matches: (event) => (event.ctrlKey || event.metaKey) && event.shiftKey === shift && event.key.toLowerCase() === name});

export function listenToKeys(actions: readonly KeyAction[]): void {
  document.addEventListener('keydown', (event) => {
    if (document.querySelector('dialog[open]')) return;
    const target = event.target as HTMLElement;
    const typing = target instanceof HTMLInputElement && !['checkbox', 'radio', 'range'].includes(target.type);
    if (typing || target instanceof HTMLSelectElement) return;
    // Space and Enter press the button that has the focus.
    if (target instanceof HTMLButtonElement && (event.key === ' ' || event.key === 'Enter')) return;
    if (target instanceof HTMLInputElement && target.type === 'range' && event.key.startsWith('Arrow')) return;
    const action = actions.find((candidate) => candidate.matches(event));
    if (!action) return;
    event.preventDefault();
    action.run();
  });
}

export function showHelp(actions: readonly KeyAction[], version: string): void {
  const list = element('div', {class: 'keys'}, ...actions.filter((action) => action.text).map((action) =>
    element('div', {}, element('span', {}, action.text), element('kbd', {}, action.keys))));
  void dialog('Keyboard', [
    list,
    element('p', {}, element('br'), 'Drag a ball to pose the character: hands and feet bend the whole limb, other joints swing one bone, '
      + 'and the hips carry the body. Drag beside it to turn the camera, with the right button to move it, and scroll to come closer.'),
    element('p', {class: 'soft'}, `Pleat ${version}`)], null);
  document.querySelector('dialog[open]')?.classList.add('wide');
}
