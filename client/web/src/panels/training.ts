// Starting a training, and how the one that runs is doing.
import {createTraining} from '../api/upload';
import type {Job, Sequence} from '../api/types';
import {byId, dialog, durationText, element} from './dom';
import {jobFacts} from './library';

const kPresets: [string, string, string, object][] = [
  ['balanced', 'Balanced', 'The defaults: skeleton, weights and rest shape are refined; the learner is chosen on held-out frames.', {}],
  ['quick', 'Quick look', 'A fifth of the vertices learn and the skeleton is not refined: seconds instead of minutes, rougher folds.',
    {resolutionPercent: 20, refine: 'none', learner: 'ridge'}],
  ['paper', 'As in the paper', 'de Aguiar and Ukita 2012: walk fit, GP latent variables, no refinement. For comparisons.',
    {fit: 'walk', detailAxes: 'world', refine: 'none', learner: 'sgplvm', historyForm: 'poses', upsampling: 'rbf'}],
];

// Asks for a preset and further clips, and starts the job. Its id, or null. skeleton: joints that were
// placed by hand in a rest frame, or null.
export async function askTraining(take: Sequence, takes: readonly Sequence[], skeleton: {frame: number; text: string} | null): Promise<string | null> {
  const name = element('input', {value: take.name, id: 'model-name', maxlength: 200});
  const presets = kPresets.map(([value, title, text]) => element('label', {},
    element('input', {type: 'radio', name: 'preset', value, ...(value === 'balanced' ? {checked: true} : {})}),
    element('b', {}, title), element('small', {}, text)));
  const others = takes.filter((other) => other.id !== take.id && other.numVertices === take.numVertices && other.numFaces === take.numFaces);
  const clips = others.map((other) => element('input', {type: 'checkbox', value: other.id}));
  const form = [...(skeleton ? [element('p', {class: 'soft'}, `With the joints as you placed them in frame ${skeleton.frame}.`)] : []),
    element('label', {}, 'Name of the character', name), element('div', {class: 'presets'}, ...presets),
    ...(others.length ? [element('p', {class: 'soft'}, 'Further clips of the same mesh:'),
      ...others.map((other, i) => element('div', {}, element('label', {}, clips[i]!, ` ${other.name} (${other.numFrames} frames)`)))] : [])];
  if (!await dialog(`Train ${take.name}`, form, 'Train')) return null;
  const chosen = presets.map((label) => label.querySelector('input')!).find((input) => input.checked)?.value;
  const options = {...kPresets.find(([value]) => value === chosen)?.[3], ...(skeleton ? {restFrame: skeleton.frame, placedJoints: skeleton.text} : {})};
  const ids = [take.id, ...clips.filter((box) => box.checked).map((box) => box.value)];
  return (await createTraining(ids, name.value.trim() || take.name, options)).job.id;
}

const kStages: Record<string, string> = {
  read: 'Reading the take', rig: 'Finding the skeleton', fit: 'Fitting the poses', refine: 'Refining the skeleton',
  detail: 'Measuring the folds', learn: 'Learning the folds', validate: 'Choosing the learner', evaluate: 'Measuring the errors',
};
export const stageText = (stage: string): string => kStages[stage] ?? (stage ? stage[0]!.toUpperCase() + stage.slice(1) : 'Waiting for a worker');

// The objective of the optimizer so far, for each job that is watched.
const objectives = new Map<string, number[]>();
export function noteObjective(job: Job): void {
  if (job.objective === undefined) return;
  const values = objectives.get(job.id) ?? [];
  if (values.at(-1) !== job.objective) values.push(job.objective);
  objectives.set(job.id, values.slice(-200));
}
function curve(values: readonly number[]): Node | null {
  if (values.length < 3) return null;
  const low = Math.min(...values), high = Math.max(...values), range = high - low || 1;
  const points = values.map((value, i) => `${(100 * i / (values.length - 1)).toFixed(2)},${(38 - 36 * (value - low) / range).toFixed(2)}`).join(' ');
  const space = 'http://www.w3.org/2000/svg';
  const svg = document.createElementNS(space, 'svg'), line = document.createElementNS(space, 'polyline');
  svg.setAttribute('viewBox', '0 0 100 40');
  svg.setAttribute('preserveAspectRatio', 'none');
  svg.setAttribute('role', 'img');
  svg.setAttribute('aria-label', 'The objective of the optimizer over its steps');
  for (const [name, value] of [['points', points], ['fill', 'none'], ['stroke', 'currentColor'], ['vector-effect', 'non-scaling-stroke']]) {
    line.setAttribute(name!, value!);
  }
  svg.append(line);
  return svg;
}

// The card of the job that belongs to what is shown; null hides it.
export function showWork(job: Job | null, actions: {cancel(job: Job): void; close(): void}): void {
  const card = byId('work');
  card.hidden = job === null;
  if (!job) return;
  const failed = job.state === 'JOB_STATE_FAILED';
  card.replaceChildren(
    element('div', {class: 'row'}, element('b', {}, failed ? 'Training failed' : stageText(job.stage)),
      failed ? element('button', {type: 'button', class: 'icon', 'aria-label': 'Close', click: () => actions.close()}, '×')
        : element('button', {type: 'button', click: () => actions.cancel(job)}, 'Cancel')),
    failed ? element('p', {class: 'bad'}, job.error?.message ?? 'No reason was given.')
      : element('progress', {max: 1, value: job.fraction, 'aria-label': 'Progress of the training'}),
    element('p', {class: 'soft', role: 'status'}, failed ? 'Change the take or the options, and train again.'
      : `${job.name} · ${Math.round(100 * job.fraction)} %${job.etaSeconds ? ` · about ${durationText(job.etaSeconds)} left` : ''}`));
  const objective = curve(objectives.get(job.id) ?? []);
  if (objective && !failed) card.append(objective);
  card.setAttribute('aria-label', jobFacts(job));
}
