// The studio as a whole: it joins the document, the server, the views and the panels.
import {call, request, save} from './api/calls';
import {Live} from './api/live';
import type {About, Job, Model, Sequence} from './api/types';
import {Dragging} from './scene/dragging';
import {Bones} from './scene/bones';
import {Viewport, type ViewName} from './scene/viewport';
import {distancesMm, jointColorLinear, turboLinear} from './scene/surface';
import {Document} from './store/document';
import {insertKey, keyedFrames, removeKeys, resetJoint} from './store/motion';
import {Measuring} from './store/measuring';
import {loadSettings, saveSettings} from './store/settings';
import {SidePanel, type Coloring} from './panels/side';
import {askExport} from './panels/exporting';
import {showLegend} from './panels/legend';
import {byId, say, sayError} from './panels/dom';
import {Timeline} from './timeline/timeline';
import {fromDegrees, type Vector3} from './math/quaternion';
import {readableName, type Joint} from './math/skeleton';

const kLiveViews: readonly ViewName[] = ['skinned', 'hybrid', 'edited'];

export class Studio {
  readonly settings = loadSettings();
  readonly document = new Document(() => this.changed());
  readonly viewport = new Viewport(byId<HTMLCanvasElement>('canvas'), byId('editor'));
  readonly live: Live;
  readonly measuring: Measuring;
  about: About = {version: '', formats: ['glb'], maxUploadBytes: 0, maxVertices: 0, maxFrames: 0};
  takes: Sequence[] = [];
  models: Model[] = [];
  jobs: Job[] = [];
  playing = false;
  listsChanged: () => void = () => {};
  readonly statistics = {roundTripsMs: [] as number[], decodeUs: [] as number[], bytes: [] as number[], frames: 0};
  private readonly bones: Bones;
  private readonly dragging: Dragging;
  private readonly side: SidePanel;
  private readonly timeline: Timeline;
  private readonly shownFrames = new Map<number, number>();  // frame of each number that was asked for
  private readonly frameOf: Partial<Record<ViewName, number>> = {};
  private confidence: Partial<Record<ViewName, number>> = {};
  private weights: Uint16Array | null = null;  // the strongest bone of each vertex
  private playStart = {time: 0, frame: 0};
  private framed = false;
  private boned: readonly Joint[] = [];  // whose balls are in the view

  constructor() {
    this.live = new Live({
      ready: (view, message) => {
        if (view === 'measure') return;
        this.viewport.surfaces[view as ViewName].setShape(message.numVertices, message.triangles);
        if (view === this.viewport.editView) this.hint('');
        this.recolor(view as ViewName);
      },
      frame: (view, message, roundTripMs) => {
        if (view === 'measure') return this.measuring.take(message.positions, message.confidence);
        const name = view as ViewName;
        this.frameOf[name] = this.shownFrames.get(message.number) ?? this.document.frame;
        for (const number of this.shownFrames.keys()) if (number < message.number - 200) this.shownFrames.delete(number);
        this.confidence[name] = message.confidence;
        this.viewport.surfaces[name].show(message.positions, message.normals);
        this.statistics.frames++;
        for (const [list, value] of [[this.statistics.roundTripsMs, roundTripMs], [this.statistics.decodeUs, message.decodeUs], [this.statistics.bytes, message.bytes]] as const) {
          list.push(value);
          if (list.length > 2000) list.shift();
        }
        this.frameOnce(message.positions);
        this.recolor(name);
        this.captions();
        this.viewport.redraw();
      },
      refused: (_, message) => say(message, 'error'),
      lost: (view, code, message, retrySeconds) => {
        if (view === 'measure') return this.measuring.stop();
        if (retrySeconds === null) say(`${message} (${code})`, 'error');
        else this.hint(`${message} The last picture stays; next try in ${Math.ceil(retrySeconds)} s.`);
      },
    });
    this.measuring = new Measuring(this.live, this.document, () => this.refresh());
    this.bones = new Bones(byId('labels'));
    this.viewport.overlay.add(this.bones.group);
    this.dragging = new Dragging(this.viewport, this.bones, byId('editor'), this.document, () => this.changed());
    this.side = new SidePanel({
      toggleView: (view) => this.toggleView(view), color: (by) => void this.color(by).catch(sayError),
      bones: (on) => this.set({showBones: on}), names: (on) => this.set({showNames: on}),
      select: (joint) => this.select(joint), turn: (joint, degrees, gesture) => this.turn(joint, degrees, gesture),
      key: () => this.setKey(), unkey: () => this.removeKey(), reset: () => this.resetJoint(),
      gizmo: (mode) => this.setGizmo(mode), seek: (frame) => this.seek(frame), undo: () => this.undo(), redo: () => this.redo(),
    });
    this.timeline = new Timeline({seek: (frame) => this.seek(frame), play: () => this.togglePlay(),
      loop: (on) => this.set({loop: on}), step: (by) => this.seek(this.document.frame + by)});
    this.viewport.drawn = (left, width, height) =>
      this.bones.placeLabels(this.settings.showNames && this.document.motion !== null, this.viewport.camera, left, width, height);
    this.applyColors();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.applyColors());
  }

  // --- what is open ---------------------------------------------------------------------------
  async openTake(id: string, report = this.document.report): Promise<void> {
    const info = this.takes.find((take) => take.id === id);
    if (!info) return;
    this.stop();
    this.live.dropAll();
    this.measuring.stop();
    this.document.openTake(info, report?.sequence.id === id ? report : null);
    this.set({takeId: id, modelId: ''});
    this.setViews(['input']);
    this.framed = false;
    await this.loadTake(id);
  }
  private async loadTake(id: string): Promise<void> {
    this.hint('Loading the take…');
    const surface = this.viewport.surfaces.input;
    await this.document.takes.load(id, (take) => {
      if (surface.numVertices !== take.shape.numVertices || take.numLoaded === 1) surface.setShape(take.shape.numVertices, take.shape.triangles);
      this.showFrame();
      this.frameOnce(take.frames[0]!);
      if (take.done) {
        this.hint('');
        this.measuring.start();
      }
      this.refresh();
    });
  }
  async openModel(id: string): Promise<void> {
    const model = this.models.find((other) => other.id === id);
    if (!model) return say('This model is not on the server any more.', 'error');
    this.stop();
    this.measuring.stop();
    this.live.dropAll();
    this.hint('Fitting the motion of the take…');
    await this.document.openModel(model, this.jobs, this.takes);
    this.weights = null;
    this.set({modelId: id, takeId: this.document.takeInfo?.id ?? ''});
    this.framed = false;
    this.setViews(['edited']);
    if (this.document.takeInfo) {
      await this.loadTake(this.document.takeInfo.id);
      this.measuring.start();
    }
    this.hint('');
    this.refresh();
  }
  closeAll(): void {
    this.stop();
    this.live.dropAll();
    this.measuring.stop();
    this.document.closeModel();
    this.document.takeInfo = null;
    this.document.takes.forget();
    Object.values(this.viewport.surfaces).forEach((surface) => surface.hide());
    this.set({modelId: '', takeId: ''});
    this.changed();
  }

  // --- time -----------------------------------------------------------------------------------
  seek(frame: number): void {
    this.document.frame = Math.min(Math.max(0, Math.round(frame) || 0), Math.max(0, this.document.numFrames - 1));
    this.playStart = {time: performance.now(), frame: this.document.frame};
    this.changed();
  }
  togglePlay(): void {
    if (this.playing) return this.stop();
    if (this.document.numFrames < 2) return;
    if (this.document.frame === this.document.numFrames - 1) this.document.frame = 0;
    this.playing = true;
    this.playStart = {time: performance.now(), frame: this.document.frame};
    const tick = (): void => {
      if (!this.playing) return;
      const {numFrames, fps} = this.document;
      let frame = this.playStart.frame + Math.floor((performance.now() - this.playStart.time) / 1e3 * fps);
      if (frame >= numFrames && !this.settings.loop) {
        this.seek(numFrames - 1);
        return this.stop();
      }
      frame %= numFrames;
      if (frame !== this.document.frame) {
        this.document.frame = frame;
        this.changed();
      }
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.refresh();
  }
  stop(): void {
    this.playing = false;
    this.refresh();
  }

  // --- editing --------------------------------------------------------------------------------
  select(joint: number): void {
    this.document.joint = Math.min(Math.max(joint, 0), this.document.joints.length - 1);
    this.changed();
  }
  turn(joint: number, degrees: Vector3, gesture: string): void {
    const pose = this.document.pose(true);
    if (!pose) return;
    const rotations = [...pose.rotations];
    rotations[joint] = fromDegrees(degrees);
    this.document.setPose({root: pose.root, rotations}, `turn ${this.jointName(joint)}`, gesture);
  }
  setKey(): void { this.edit(insertKey(this.document.edits.value, this.document.frame, this.document.joint), 'set a key'); }
  removeKey(): void { this.edit(removeKeys(this.document.edits.value, this.document.frame, this.document.joint), 'remove a key'); }
  resetJoint(): void { this.edit(resetJoint(this.document.edits.value, this.document.joint), `reset ${this.jointName(this.document.joint)}`); }
  undo(): void { if (!this.document.edits.undo()) say('There is nothing to undo.'); }
  redo(): void { if (!this.document.edits.redo()) say('There is nothing to redo.'); }
  setGizmo(mode: 'rotate' | 'translate'): void {
    this.dragging.mode = mode;
    this.changed();
  }
  private edit(edits: Parameters<typeof this.document.edits.change>[0], label: string): void {
    if (this.document.motion && this.document.joint >= 0) this.document.edits.change(edits, label);
  }
  private jointName(joint: number): string { return readableName(this.document.joints[joint]?.name ?? ''); }

  // --- views ----------------------------------------------------------------------------------
  get available(): Set<ViewName> {
    const views = new Set<ViewName>(this.document.takeInfo ? ['input'] : []);
    if (this.document.model) kLiveViews.forEach((view) => views.add(view));
    return views;
  }
  setViews(views: ViewName[]): void {
    const shown = views.filter((view) => this.available.has(view));
    this.viewport.setViews(shown.length ? shown : ['input']);
    this.set({views: this.viewport.shownViews.join(',')});
    for (const view of kLiveViews) {
      if (this.document.model && shown.includes(view)) this.live.want(view, this.document.model.id, view === 'skinned');
      else this.live.drop(view);
    }
    this.changed();
  }
  toggleView(view: ViewName): void {
    const views = this.viewport.shownViews;
    const order: ViewName[] = ['input', 'skinned', 'hybrid', 'edited'];
    const wanted = views.includes(view) ? views.filter((other) => other !== view) : [...views, view];
    if (wanted.length) this.setViews(order.filter((other) => wanted.includes(other)));
  }
  frameView(): void {
    const surface = this.viewport.surfaces[this.viewport.editView];
    this.viewport.frame(surface.positions.length ? surface.positions : this.document.takes.current?.frames[0] ?? new Float32Array());
  }
  async color(by: Coloring): Promise<void> {
    if (by === 'weights' && this.document.model && !this.weights) {
      this.weights = strongestBones(await (await request(`/studio/models/${this.document.model.id}/rig`)).json() as RigFile);
    }
    this.set({coloring: by});
    Object.keys(this.viewport.surfaces).forEach((view) => this.recolor(view as ViewName));
  }
  setScale(mm: number): void {
    if (mm > 0) this.set({scaleMm: mm});
    Object.keys(this.viewport.surfaces).forEach((view) => this.recolor(view as ViewName));
  }
  private recolor(view: ViewName): void {
    const surface = this.viewport.surfaces[view], by = this.settings.coloring as Coloring;
    const truth = this.document.takes.current?.frames[this.frameOf[view] ?? this.document.frame];
    if (by === 'error' && view !== 'input' && truth && truth.length === surface.positions.length) {
      const distances = distancesMm(surface.positions, truth);
      surface.color((v) => turboLinear(distances[v]! / this.settings.scaleMm));
    } else if (by === 'confidence' && view !== 'input' && this.confidence[view] !== undefined) {
      const color = turboLinear(this.confidence[view]!);
      surface.color(() => color);
    } else if (by === 'weights' && this.weights && this.weights.length === surface.numVertices) {
      surface.color((v) => jointColorLinear(this.weights![v]!));
    } else {
      surface.color(null);
    }
    this.viewport.redraw();
  }

  // --- taking away ----------------------------------------------------------------------------
  async exportAnimation(): Promise<void> {
    const {model} = this.document;
    if (!model || !this.document.motion) return;
    const choice = await askExport(this.about.formats, model.name);
    if (!choice) return;
    if (choice.format === 'png') return save(await this.viewport.picture(), `${choice.name}.png`);
    const motion = JSON.stringify(this.document.motionFile());
    if (choice.format === 'json') return save(new Blob([motion], {type: 'application/json'}), `${choice.name}.json`);
    say(`Writing ${choice.name}.${choice.format}…`);
    save(await this.exported(choice.format, motion), `${choice.name}.${choice.format}`);
  }
  async exported(format: string, motion = JSON.stringify(this.document.motionFile())): Promise<Blob> {
    return (await request(`/studio/models/${this.document.model!.id}/export?format=${format}`,
      {method: 'POST', headers: {'Content-Type': 'application/json'}, body: motion})).blob();
  }
  async download(method: string, id: string, name: string): Promise<void> {
    const response = await request(`/rpc/${method}`, {method: 'POST', headers: {'Content-Type': 'application/json'}, body: JSON.stringify({id})});
    save(await response.blob(), name);
  }
  remove(method: string, id: string): Promise<unknown> { return call(method, {id}); }

  // --- drawing what has changed ---------------------------------------------------------------
  set(change: Partial<typeof this.settings>): void {
    Object.assign(this.settings, change);
    saveSettings(this.settings);
    this.refresh();
  }
  changed(): void {
    this.showFrame();
    if (this.boned !== this.document.joints) this.bones.setJoints(this.boned = this.document.joints);
    const placed = this.document.placed();
    if (placed) this.bones.place(placed);
    this.dragging.place();
    this.refresh();
  }
  private showFrame(): void {
    const {document} = this, input = document.takes.current?.frames[document.frame];
    if (input && this.viewport.shownViews.includes('input')) {
      this.viewport.surfaces.input.show(input);
      this.frameOf.input = document.frame;
      this.viewport.redraw();
    }
    if (!document.model || !document.motion) return;
    for (const view of kLiveViews) {
      if (!this.viewport.shownViews.includes(view)) continue;
      this.shownFrames.set(this.live.show(view, document.posesFor(view === 'edited')), document.frame);
    }
  }
  private frameOnce(positions: Float32Array): void {
    if (this.framed || positions.length === 0) return;
    this.framed = true;
    this.viewport.frame(positions);
  }
  refresh(): void {
    const {document, settings} = this, edits = document.edits.value;
    const joint = document.joint, allKeys = keyedFrames(edits, -1), keys = joint >= 0 ? keyedFrames(edits, joint) : new Set<number>();
    this.bones.group.visible = settings.showBones && document.motion !== null;
    this.viewport.gizmo.getHelper().visible = this.bones.group.visible && joint >= 0;
    this.viewport.gizmo.enabled = this.bones.group.visible;
    this.bones.mark(joint, new Set([...edits.turns.keys(), ...(edits.moves.length ? [0] : [])]));
    this.timeline.show({frame: document.frame, numFrames: document.numFrames, numLoaded: document.takes.current?.numLoaded ?? document.numFrames,
      fps: document.fps, playing: this.playing, loop: settings.loop, keys, otherKeys: allKeys, errorsMm: this.measuring.errorsMm,
      confidences: this.measuring.confidences, scaleMm: settings.scaleMm});
    this.side.show({views: this.viewport.shownViews, available: this.available, coloring: settings.coloring as Coloring,
      showBones: settings.showBones, showNames: settings.showNames, joints: document.joints, joint, pose: document.pose(true),
      change: document.changeOf(joint), keyed: keys.has(document.frame), edited: edits.turns.has(joint) || (joint === 0 && edits.moves.length > 0),
      gizmo: this.dragging.mode, model: document.model, report: document.report, worst: this.measuring.worst(5), measured: this.measuring.text,
      undo: document.edits.undoLabel, redo: document.edits.redoLabel});
    byId('title').textContent = document.model ? `${document.model.name}${document.isEdited ? ' · edited' : ''}` : document.takeInfo?.name ?? '';
    byId<HTMLButtonElement>('train').disabled = !document.takeInfo;
    byId<HTMLButtonElement>('export').disabled = !document.model;
    showLegend(settings.coloring as Coloring, settings.scaleMm, (mm) => this.setScale(mm));
    this.captions();
    this.listsChanged();
    this.viewport.redraw();
  }
  private captions(): void {
    const titles: Record<ViewName, string> = {input: 'Input', skinned: 'Skinned only', hybrid: 'Hybrid', edited: 'Edited'};
    byId('captions').replaceChildren(...(this.document.numFrames ? this.viewport.shownViews : []).map((view) => {
      const caption = globalThis.document.createElement('span'), title = globalThis.document.createElement('b');
      title.textContent = titles[view];
      const confidence = this.confidence[view];
      caption.append(title, view !== 'input' && confidence !== undefined ? `  confidence ${confidence.toFixed(2)}` : '');
      return caption;
    }));
  }
  hint(text: string): void { byId('hint').textContent = text; }
  private applyColors(): void {
    const style = getComputedStyle(globalThis.document.body);
    this.viewport.setColors(style.getPropertyValue('--view').trim(), style.getPropertyValue('--grid').trim());
    this.refresh();
  }
}

// The strongest bone of each vertex, of a rig file with the weights of bones (docs/formats/rig.md): each
// list is joint, weight, joint, weight, and so on.
interface RigFile { weights: {vertices: number[][]} }
function strongestBones(rig: RigFile): Uint16Array {
  return Uint16Array.from(rig.weights.vertices, (row) => {
    let best = 0;
    for (let i = 2; i < row.length; i += 2) if (row[i + 1]! > row[best + 1]!) best = i;
    return row[best]!;
  });
}
