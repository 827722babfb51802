// Takes, models and jobs of the server, and what can be done with each.
import type {CompressedSequence, Job, Model, Sequence} from '../api/types';
import {fpsOf, isFinal} from '../api/types';
import {byId, bytesText, durationText, element} from './dom';

export interface LibraryState { takes: Sequence[]; models: Model[]; jobs: Job[]; compressed: CompressedSequence[]; takeId: string; modelId: string }
export interface LibraryActions {
  openTake(id: string): void; openModel(id: string): void; deleteTake(take: Sequence): void; deleteModel(model: Model): void;
  cancelJob(job: Job): void; deleteJob(job: Job): void; downloadModel(model: Model): void; downloadTake(take: Sequence): void;
  openCompressed(id: string): void; deleteCompressed(take: CompressedSequence): void; downloadCompressed(take: CompressedSequence): void; compress(take: Sequence): void;
}

const kStates: Record<string, string> = {
  JOB_STATE_QUEUED: 'waits', JOB_STATE_RUNNING: 'runs', JOB_STATE_SUCCEEDED: 'done', JOB_STATE_FAILED: 'failed',
  JOB_STATE_CANCELLED: 'cancelled',
};

const newestFirst = <T extends {created?: string}>(items: T[]): T[] =>
  [...items].sort((a, b) => (b.created ?? '').localeCompare(a.created ?? ''));

function row(name: string, facts: string, current: boolean, open: (() => void) | null, actions: [string, string, () => void][],
             extra: Node | null = null): HTMLLIElement {
  const main = element('button', {type: 'button', ...(current ? {'aria-current': 'true'} : {}), ...(open ? {click: open} : {disabled: true})},
    element('b', {}, name || 'without a name'), element('small', {}, facts), extra);
  return element('li', current ? {class: 'current'} : {}, main, element('span', {}, ...actions.map(([sign, label, act]) =>
    element('button', {type: 'button', class: 'icon', 'aria-label': `${label} ${name}`, title: label, click: act}, sign))));
}

export function jobFacts(job: Job): string {
  const state = kStates[job.state] ?? job.state;
  if (job.state === 'JOB_STATE_RUNNING') {
    const left = job.etaSeconds ? `, ${durationText(job.etaSeconds)} left` : '';
    return `${job.stage || state} ${Math.round(100 * job.fraction)} %${left}`;
  }
  if (job.state === 'JOB_STATE_FAILED') return `failed: ${job.error?.message ?? ''}`;
  return state;
}

let shown: LibraryState | null = null;

// The lists are made again only when something in them has changed, so that the focus stays.
export function showLibrary(state: LibraryState, actions: LibraryActions): void {
  const old = shown;
  if (old && (Object.keys(state) as (keyof LibraryState)[]).every((name) => old[name] === state[name])) return;
  shown = state;
  const none = (text: string): Node => element('li', {class: 'none'}, text);
  byId('takes').replaceChildren(...(state.takes.length ? newestFirst(state.takes).map((take) => row(
    take.name, `${take.numFrames} frames · ${take.numVertices.toLocaleString('en')} vertices · ${Math.round(fpsOf(take.frameRate))} fps`,
    take.id === state.takeId, () => actions.openTake(take.id),
    [['⇣', 'Compress', () => actions.compress(take)], ['↓', `Download (${bytesText(Number(take.sizeBytes))})`, () => actions.downloadTake(take)], ['×', 'Delete', () => actions.deleteTake(take)]]))
    : [none('Drop files anywhere.')]));
  byId('compressed-section').hidden = state.compressed.length === 0;
  byId('compressed').replaceChildren(...newestFirst(state.compressed).map((take) => row(
    take.name, `${take.numFrames} frames · ${bytesText(Number(take.sizeBytes))}${take.record ? ` · within ${take.record.maxErrorMm.toFixed(2)} mm` : ''}`,
    take.id === state.takeId, () => actions.openCompressed(take.id),
    [['↓', 'Download', () => actions.downloadCompressed(take)], ['×', 'Delete', () => actions.deleteCompressed(take)]])));
  byId('models').replaceChildren(...(state.models.length ? newestFirst(state.models).map((model) => row(
    model.name, model.record.reconstruction ? `error ${model.record.reconstruction.meanMm.toFixed(2)} mm · ${model.record.learner}` : model.record.learner,
    model.id === state.modelId, () => actions.openModel(model.id),
    [['↓', `Download (${bytesText(Number(model.sizeBytes))})`, () => actions.downloadModel(model)], ['×', 'Delete', () => actions.deleteModel(model)]]))
    : [none('Train a take to get one.')]));
  byId('jobs').replaceChildren(...(state.jobs.length ? newestFirst(state.jobs).slice(0, 30).map((job) => {
    const bar = job.state === 'JOB_STATE_RUNNING' ? element('progress', {max: 1, value: job.fraction, 'aria-label': `Progress of ${job.name}`}) : null;
    const open = job.resultId ? (): void => job.training ? actions.openModel(job.resultId) : actions.openCompressed(job.resultId) : null;
    return row(job.name, jobFacts(job), false, open,
      [isFinal(job.state) ? ['×', 'Forget', () => actions.deleteJob(job)] : ['■', 'Cancel', () => actions.cancelJob(job)]], bar);
  }) : [none('None yet.')]));
}
