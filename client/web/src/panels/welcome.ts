// What the stage says when nothing is open.
import {byId, element} from './dom';

export function showWelcome(visible: boolean, hasAny: boolean, actions: {choose(): void; example(): void}): void {
  const host = byId('empty');
  host.hidden = !visible;
  if (!visible || host.childElementCount) return;
  host.append(element('div', {class: 'target'},
    element('h3', {}, 'Drop a mesh animation here'),
    element('p', {}, 'Pleat finds its skeleton, learns how its surface folds, and lets you pose it.'),
    element('div', {class: 'buttons'},
      element('button', {type: 'button', class: 'main', id: 'example', click: () => actions.example()}, 'Try with a made-up dancer'), ' ',
      element('button', {type: 'button', click: () => actions.choose()}, 'Choose files…')),
    element('p', {class: 'formats'}, 'A folder of .obj or .ply frames, .pc2 or .mdd beside its .obj, .abc, .glb, .npz or .pseq. Meters, Y up.')));
  if (hasAny) host.append(element('p', {class: 'soft'}, 'Or open a take or a model on the left.'));
}
