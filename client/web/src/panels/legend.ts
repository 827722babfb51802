// The scale of the colors, with an end that can be typed.
import {turbo} from '../scene/colors';
import {byId, element} from './dom';
import type {Coloring} from './coloring';

let shown = '';
export function showLegend(coloring: Coloring, scaleMm: number, setScale: (mm: number) => void): void {
  const host = byId('legend'), state = `${coloring} ${scaleMm}`;
  host.hidden = coloring !== 'error' && coloring !== 'confidence';
  if (host.hidden || state === shown) return;
  shown = state;
  const bar = element('canvas', {width: 120, height: 1, 'aria-hidden': 'true'}), pen = bar.getContext('2d')!;
  for (let x = 0; x < 120; ++x) {
    pen.fillStyle = `rgb(${turbo(x / 119).map((c) => Math.round(255 * c)).join()})`;
    pen.fillRect(x, 0, 1, 1);
  }
  if (coloring === 'confidence') return host.replaceChildren('unknown 0', bar, '1 as trained');
  const end = element('input', {type: 'number', min: .1, step: 1, value: scaleMm, 'aria-label': 'End of the scale, millimeters'});
  end.addEventListener('change', () => setScale(Number(end.value)));
  host.replaceChildren('0', bar, end, 'mm');
}
