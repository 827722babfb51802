// Starts the page.
import {call, request, setToken} from './api/calls';
import {filesOf, isMotion, readMotion, readTake, sendFiles, type NamedFile} from './api/upload';
import {isFinal, type Job, type Sequence, type StoredTake} from './api/types';
import {ask, byId, confirmed, say, sayError} from './panels/dom';
import {command, key, listenToKeys, shifted, showHelp, type KeyAction} from './panels/help';
import {showLibrary} from './panels/library';
import {askCompression} from './panels/compressing';
import {askTraining, showWork} from './panels/training';
import {showWelcome} from './panels/welcome';
import {ServerState} from './server_state';
import {motionFromFile} from './store/motion';
import {Studio} from './studio';
import {TakingAway} from './taking_away';

const studio = new Studio();
const takingAway = new TakingAway(studio);
let dismissed = '';  // the failed job whose card was closed
let trainedHere = '';  // the job that this page has started last
let busy = false;

const server = new ServerState(studio, (job) => {
  if (job.state === 'JOB_STATE_SUCCEEDED' && job.id === trainedHere) {
    say(`${job.name} is trained. Drag a hand.`);
    attempt(() => studio.openModel(job.resultId));
  } else if (job.state === 'JOB_STATE_SUCCEEDED' && job.compression) {
    say(`${job.name} is compressed.`);
  } else if (job.state === 'JOB_STATE_FAILED') {
    say(`${job.compression ? 'Compressing' : 'Training'} ${job.name} failed: ${job.error?.message ?? ''}`, 'error');
  }
}, () => studio.refresh());

// Runs something that may fail, and says why when it does.
function attempt(work: () => Promise<unknown> | unknown): void {
  Promise.resolve().then(work).catch((error: unknown) => {
    studio.hint('');
    sayError(error);
  });
}

studio.listsChanged = () => {
  showLibrary({takes: studio.takes, models: studio.models, jobs: studio.jobs, compressed: studio.compressed,
    takeId: (studio.document.takeInfo ?? studio.document.compressed)?.id ?? '', modelId: studio.document.model?.id ?? ''}, {
    openTake: (id) => attempt(() => studio.openTake(id)),
    openModel: (id) => attempt(() => studio.openModel(id)),
    deleteTake: (take) => attempt(() => remove('SequenceService/DeleteSequence', take.id, `Delete the take ${take.name}?`, 'Models made from it stay, without their motion.')),
    deleteModel: (model) => attempt(() => remove('ModelService/DeleteModel', model.id, `Delete the model ${model.name}?`, 'It cannot be brought back; train the take again to have it.')),
    openCompressed: (id) => studio.openCompressed(id),
    deleteCompressed: (take) => attempt(() => remove('CompressedSequenceService/DeleteCompressedSequence', take.id, `Delete the compressed ${take.name}?`, 'It cannot be brought back; compress the take again to have it.')),
    downloadCompressed: (take) => attempt(() => takingAway.download('CompressedSequenceService/DownloadCompressedSequence', take.id, `${take.name}.plt`)),
    compress: (take) => attempt(() => compress(take)),
    cancelJob: (job) => attempt(() => server.cancel(job)),
    deleteJob: (job) => attempt(async () => {
      await call('JobService/DeleteJob', {id: job.id});
      await server.refresh();
    }),
    downloadModel: (model) => attempt(() => takingAway.download('ModelService/DownloadModel', model.id, `${model.name}.pleat`)),
    downloadTake: (take) => attempt(() => takingAway.download('SequenceService/DownloadSequence', take.id, `${take.name}.pseq`)),
  });
  const job = jobOnStage();
  showWork(job, {cancel: (running) => attempt(() => server.cancel(running)), close: () => {
    dismissed = job?.id ?? '';
    studio.refresh();
  }});
  showWelcome(!studio.document.takeInfo && !studio.document.compressed && !studio.document.model && !busy, studio.takes.length + studio.models.length > 0, {choose, example: () => attempt(example)});
};
// The newest job of the take that is shown, while it runs or when it has failed.
function jobOnStage(): Job | null {
  const takeId = studio.document.takeInfo?.id;
  const jobs = studio.jobs.filter((job) => job.training && takeId && job.sequenceIds.includes(takeId))
    .sort((a, b) => (a.created ?? '').localeCompare(b.created ?? ''));
  const job = jobs.at(-1);
  if (!job || job.id === dismissed) return null;
  return !isFinal(job.state) || (job.state === 'JOB_STATE_FAILED' && job.id === trainedHere) ? job : null;
}

async function remove(method: string, id: string, title: string, text: string): Promise<void> {
  if (!await confirmed(title, text, 'Delete')) return;
  await call(method, {id});
  const {takeInfo, compressed, model} = studio.document;
  if ([takeInfo?.id, compressed?.id, model?.id].includes(id)) studio.closeAll();
  await server.refresh();
}

// --- bringing takes and motions -----------------------------------------------------------------
async function bring(files: NamedFile[]): Promise<void> {
  if (files.length === 0) return;
  if (studio.isShared) return say('This link shows one character; sign in to bring takes and motions.');
  busy = true;
  studio.refresh();
  try {
    studio.hint('Sending the files…');
    const upload = await sendFiles(files, (fraction) => studio.hint(`Sending the files… ${Math.round(100 * fraction)} %`));
    studio.hint('Reading them…');
    if (isMotion(files)) {
      if (!studio.document.model) throw new Error('A motion needs a character: open a model first, then drop the motion.');
      studio.document.setMotion(motionFromFile(await readMotion(studio.document.model.id, {upload}), studio.document.joints));
      studio.measuring.stop();
      say(`${files[0]!.path}: ${studio.document.numFrames} frames.`);
    } else {
      await opened(await readTake(upload, nameOf(files)));
    }
  } finally {
    busy = false;
    studio.hint('');
    studio.refresh();
  }
}
// The folder that was dropped, or the cache, without its ending.
function nameOf(files: NamedFile[]): string {
  const first = files[0]!.path;
  if (first.includes('/')) return first.split('/')[0]!;
  const cache = files.find(({path}) => /\.(pc2|mdd|abc|npz|npy|pseq|glb|gltf)$/i.test(path));
  return (cache?.path ?? first).replace(/\.[^.]+$/, '');
}
async function opened(take: StoredTake): Promise<void> {
  await server.refresh();
  studio.document.report = take;
  await studio.openTake(take.sequence.id, take);
}
async function example(): Promise<void> {
  busy = true;
  studio.refresh();
  studio.hint('Making a dancer…');
  try {
    await opened(await (await request('/studio/example', {method: 'POST'})).json() as StoredTake);
  } finally {
    busy = false;
    studio.refresh();
  }
}
function choose(): void { byId<HTMLInputElement>('files').click(); }
byId<HTMLInputElement>('files').addEventListener('change', (event) => {
  const input = event.target as HTMLInputElement;
  const files = [...input.files ?? []].map((file) => ({path: file.webkitRelativePath || file.name, file}));
  input.value = '';
  attempt(() => bring(files));
});
let depth = 0;
document.addEventListener('dragenter', (event) => {
  if (!event.dataTransfer?.types.includes('Files')) return;
  ++depth;
  document.body.classList.add('dropping');
});
document.addEventListener('dragleave', () => { if (--depth <= 0) document.body.classList.remove('dropping'); });
document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  depth = 0;
  document.body.classList.remove('dropping');
  const transfer = event.dataTransfer;
  if (transfer) attempt(async () => bring(await filesOf(transfer)));
});

// --- buttons and keys -----------------------------------------------------------------------------
async function train(): Promise<void> {
  const take = studio.document.takeInfo;
  if (!take) return say('Open a take first.');
  const {rest} = studio.document;
  const id = await askTraining(take, studio.takes, rest && rest.placed.value.size > 0 ? rest : null);
  if (!id) return;
  if (rest) studio.closeSkeleton();
  trainedHere = id;
  await server.refresh();
}
async function compress(take: Sequence): Promise<void> {
  if (await askCompression(take)) await server.refresh();
}
function togglePanel(name: 'library' | 'side'): void {
  const open = document.body.classList.toggle(`no-${name}`) === false;
  byId(`toggle-${name}`).setAttribute('aria-expanded', String(open));
  studio.set(name === 'library' ? {libraryOpen: open} : {sideOpen: open});
}
const step = (joints: number): void => {
  const {joint, joints: all} = studio.document;
  if (all.length) studio.select((joint + joints + all.length) % all.length);
};
const actions: KeyAction[] = [
  key(' ', 'Space', 'Play and stop', () => studio.togglePlay()),
  key('arrowright', '→', 'Next frame', () => studio.seek(studio.document.frame + 1)),
  key('arrowleft', '←', 'Previous frame', () => studio.seek(studio.document.frame - 1)),
  shifted('arrowright', 'Shift →', 'Ten frames on', () => studio.seek(studio.document.frame + 10)),
  shifted('arrowleft', 'Shift ←', 'Ten frames back', () => studio.seek(studio.document.frame - 10)),
  key('home', 'Home', 'First frame', () => studio.seek(0)),
  key('end', 'End', 'Last frame', () => studio.seek(studio.document.numFrames - 1)),
  key('g', 'G', 'Move with the gizmo', () => studio.setGizmo('translate')),
  key('r', 'R', 'Turn with the gizmo', () => studio.setGizmo('rotate')),
  key('j', 'J', 'Next joint', () => step(1)),
  shifted('j', 'Shift J', 'Joint before', () => step(-1)),
  key('k', 'K', 'Set a key', () => studio.editing.setKey()),
  key('delete', 'Delete', 'Remove the key', () => studio.editing.removeKey()),
  key('z', 'Z', 'Undo', () => studio.editing.undo()),
  shifted('z', 'Shift Z', 'Redo', () => studio.editing.redo()),
  command('z', false, 'Ctrl Z', '', () => studio.editing.undo()),
  command('z', true, 'Ctrl Shift Z', '', () => studio.editing.redo()),
  command('y', false, 'Ctrl Y', '', () => studio.editing.redo()),
  key('1', '1', 'Show the input', () => studio.toggleView('input')),
  key('2', '2', 'Show skinning alone', () => studio.toggleView('skinned')),
  key('3', '3', 'Show the hybrid', () => studio.toggleView('hybrid')),
  key('4', '4', 'Show the edited character', () => studio.toggleView('edited')),
  key('e', 'E', 'Color by error', () => attempt(() => studio.color(studio.settings.coloring === 'error' ? 'none' : 'error'))),
  key('c', 'C', 'Color by confidence', () => attempt(() => studio.color(studio.settings.coloring === 'confidence' ? 'none' : 'confidence'))),
  key('w', 'W', 'Color by skinning weights', () => attempt(() => studio.color(studio.settings.coloring === 'weights' ? 'none' : 'weights'))),
  key('b', 'B', 'Show the skeleton', () => studio.set({showBones: !studio.settings.showBones})),
  key('n', 'N', 'Show the names of joints', () => studio.set({showNames: !studio.settings.showNames})),
  key('f', 'F', 'Look at all of it', () => studio.frameView()),
  key('v', 'V', 'Show the curves of the joint', () => studio.set({showCurves: !studio.settings.showCurves})),
  key('l', 'L', 'Loop', () => studio.set({loop: !studio.settings.loop})),
  key('t', 'T', 'Train the take', () => attempt(train)),
  key('x', 'X', 'Export', () => attempt(() => takingAway.ask())),
  key('[', '[', 'Takes, models and jobs', () => togglePanel('library')),
  key(']', ']', 'Joint and quality', () => togglePanel('side')),
  key('?', '?', 'This list', () => showHelp(actions, studio.about.version)),
];
listenToKeys(actions);
studio.trainAgain = () => attempt(train);
byId('help').addEventListener('click', () => showHelp(actions, studio.about.version));
byId('train').addEventListener('click', () => attempt(train));
byId('export').addEventListener('click', () => attempt(() => takingAway.ask()));
byId('add').addEventListener('click', choose);
byId('sign-in').addEventListener('click', () => attempt(async () => {
  const token = await ask('Sign in', 'Token of this server', '');
  if (!token) return;
  setToken(token);
  location.reload();
}));
byId('toggle-library').addEventListener('click', () => togglePanel('library'));
byId('toggle-side').addEventListener('click', () => togglePanel('side'));

// --- the start ------------------------------------------------------------------------------------
const narrow = matchMedia('(max-width: 860px)').matches;
if (narrow || !studio.settings.sideOpen) togglePanel('side');
// For the console and for tests: what the page shows, as numbers.
Object.assign(window, {studio, takingAway});
const {takeId, modelId} = studio.settings;
attempt(async () => {
  await server.refresh();
  server.keepLooking();
  if (narrow || studio.isShared || !studio.settings.libraryOpen) togglePanel('library');
  if (studio.models.some((model) => model.id === modelId)) await studio.openModel(modelId);
  else if (studio.isShared && studio.models.length > 0) await studio.openModel(studio.models[0]!.id);
  else if (studio.takes.some((take) => take.id === takeId)) await studio.openTake(takeId);
  else studio.refresh();
});
