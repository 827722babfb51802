// The studio as a whole: it joins the document, the server, the views and the panels.
import {currentToken} from './api/calls';
import {Live} from './api/live';
import type {About, CompressedSequence, Job, Model, Sequence} from './api/types';
import {Dragging} from './scene/dragging';
import {Bones} from './scene/bones';
import {Viewport, type ViewName} from './scene/viewport';
import {Document} from './store/document';
import {Editing} from './store/editing';
import {keyedFrames, kPlainLook, strengthOf, type Look} from './store/motion';
import {Measuring} from './store/measuring';
import {loadSettings, saveSettings} from './store/settings';
import {Colors, type Coloring} from './panels/coloring';
import {SidePanel} from './panels/side';
import {SkeletonPanel} from './panels/skeleton';
import {showLegend} from './panels/legend';
import {byId, say, sayError} from './panels/dom';
import {Curves} from './timeline/curves';
import {Timeline} from './timeline/timeline';
import {readableName, type Joint} from './math/skeleton';

const kLiveViews: readonly ViewName[] = ['skinned', 'hybrid', 'edited'];

export class Studio {
  readonly settings = loadSettings();
  readonly document = new Document(() => this.changed());
  readonly viewport = new Viewport(byId<HTMLCanvasElement>('canvas'), byId('editor'));
  readonly editing = new Editing(this.document);
  readonly live: Live;
  readonly measuring: Measuring;
  about: About = {shared: [], version: '', formats: ['glb'], maxUploadBytes: 0, maxVertices: 0, maxFrames: 0};
  takes: Sequence[] = [];
  models: Model[] = [];
  jobs: Job[] = [];
  compressed: CompressedSequence[] = [];
  playing = false;
  listsChanged: () => void = () => {};
  trainAgain: () => void = () => {};  // with the rest skeleton as it was moved
  readonly statistics = {roundTripsMs: [] as number[], decodeUs: [] as number[], bytes: [] as number[], frames: 0};
  private readonly bones: Bones;
  private readonly dragging: Dragging;
  private readonly side: SidePanel;
  private readonly skeleton: SkeletonPanel;
  private readonly timeline: Timeline;
  private readonly curves: Curves;
  private readonly shownFrames = new Map<number, number>();  // frame of each number that was asked for
  private readonly frameOf: Partial<Record<ViewName, number>> = {};
  private confidence: Partial<Record<ViewName, number>> = {};
  private readonly colors = new Colors();
  private playStart = {time: 0, frame: 0};
  private framed = false;
  private skinned: Look | null = null;
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
    }, this.settings.frames);
    this.measuring = new Measuring(this.live, this.document, () => this.refresh());
    this.bones = new Bones(byId('labels'));
    this.viewport.overlay.add(this.bones.group);
    this.dragging = new Dragging(this.viewport, this.bones, byId('editor'), this.document, () => this.changed());
    this.side = new SidePanel({
      toggleView: (view) => this.toggleView(view), color: (by) => void this.color(by).catch(sayError),
      bones: (on) => this.set({showBones: on}), names: (on) => this.set({showNames: on}),
      select: (joint) => this.select(joint), turn: (joint, degrees, gesture) => this.editing.turn(joint, degrees, gesture),
      key: () => this.editing.setKey(), unkey: () => this.editing.removeKey(), reset: () => this.editing.resetJoint(),
      strength: (value, all, gesture) => this.editing.setStrength(value, all, gesture),
      gizmo: (mode) => this.setGizmo(mode), seek: (frame) => this.seek(frame), undo: () => this.editing.undo(), redo: () => this.editing.redo(),
    });
    this.skeleton = new SkeletonPanel({open: () => this.openSkeleton(), mirror: () => this.mirrorSkeleton(),
      reset: () => this.document.rest?.reset(this.document.joint), train: () => this.trainAgain(), done: () => this.closeSkeleton()});
    this.timeline = new Timeline({seek: (frame) => this.seek(frame), play: () => this.togglePlay(),
      loop: (on) => this.set({loop: on}), curves: (on) => this.set({showCurves: on}), step: (by) => this.seek(this.document.frame + by)});
    this.curves = new Curves({change: (edits, label, gesture) => this.document.edits.change(edits, label, gesture),
      ease: () => this.editing.toggleEase(),
      seek: (frame) => this.seek(frame)});
    this.viewport.drawn = (left, width, height) =>
      this.bones.placeLabels(this.settings.showNames && this.document.motion !== null, this.viewport.camera, left, width, height);
    this.applyColors();
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.applyColors());
  }

  // Whether the page is a link to one character, which nobody can change.
  get isShared(): boolean { return this.about.shared.length > 0 && currentToken() === ''; }

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
  openCompressed(id: string): void {
    const info = this.compressed.find((other) => other.id === id);
    if (!info) return;
    this.stop();
    this.live.dropAll();
    this.measuring.stop();
    this.document.openCompressed(info);
    this.set({modelId: '', takeId: ''});
    this.framed = false;
    const {takes} = this.document, surface = this.viewport.surfaces.input;
    surface.hide();
    takes.play(id, info.numFrames, (frame) => {
      const {shape, frames} = takes.current!;
      surface.setShape(shape.numVertices, shape.triangles);
      if (frame === this.document.frame) this.showFrame();
      this.frameOnce(frames[frame]!);
    }, sayError);
    this.setViews(['input']);
  }
  async openModel(id: string): Promise<void> {
    const model = this.models.find((other) => other.id === id);
    if (!model) return say('This model is not on the server any more.', 'error');
    this.stop();
    this.measuring.stop();
    this.live.dropAll();
    this.hint('Fitting the motion of the take…');
    await this.document.openModel(model, this.jobs, this.takes);
    this.colors.forget();
    kLiveViews.forEach((view) => this.viewport.surfaces[view].hide());
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
    this.document.takeInfo = this.document.compressed = null;
    this.document.takes.forget();
    Object.values(this.viewport.surfaces).forEach((surface) => surface.hide());
    this.set({modelId: '', takeId: ''});
    this.changed();
  }

  // --- time -----------------------------------------------------------------------------------
  seek(frame: number): void {
    if (this.document.rest) return this.hint('The skeleton is moved in its rest frame; Done goes back to the motion.');
    this.document.frame = Math.min(Math.max(0, Math.round(frame) || 0), Math.max(0, this.document.numFrames - 1));
    this.playStart = {time: performance.now(), frame: this.document.frame};
    this.changed();
  }
  togglePlay(): void {
    if (this.playing) return this.stop();
    if (this.document.numFrames < 2 || this.document.rest) return;
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
  setGizmo(mode: 'rotate' | 'translate'): void {
    this.dragging.mode = mode;
    this.changed();
  }

  // --- the rest skeleton ------------------------------------------------------------------------
  openSkeleton(): void {
    if (!this.document.takes.current || !this.document.openRest()) return;
    this.stop();
    this.setViews(['input']);
    this.setGizmo('translate');
  }
  closeSkeleton(): void {
    this.document.rest = null;
    this.setViews(['edited']);
  }
  private mirrorSkeleton(): void {
    if (!this.document.rest?.mirror(this.document.joint)) say('Select a joint of the side that you have moved.');
  }

  // --- views ----------------------------------------------------------------------------------
  get available(): Set<ViewName> {
    const views = new Set<ViewName>(this.document.takeInfo || this.document.compressed ? ['input'] : []);
    if (this.document.model) kLiveViews.forEach((view) => views.add(view));
    return views;
  }
  setViews(views: ViewName[]): void {
    const shown = views.filter((view) => this.available.has(view));
    this.viewport.setViews(shown.length ? shown : ['input']);
    this.set({views: this.viewport.shownViews.join(',')});
    for (const view of kLiveViews) {
      if (!this.document.model || !shown.includes(view)) this.live.drop(view);
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
    if (by === 'weights' && this.document.model) await this.colors.loadWeights(this.document.model.id);
    this.set({coloring: by});
    Object.keys(this.viewport.surfaces).forEach((view) => this.recolor(view as ViewName));
  }
  setScale(mm: number): void {
    if (mm > 0) this.set({scaleMm: mm});
    Object.keys(this.viewport.surfaces).forEach((view) => this.recolor(view as ViewName));
  }
  private recolor(view: ViewName): void {
    const truth = view === 'input' ? undefined : this.document.takes.current?.frames[this.frameOf[view] ?? this.document.frame];
    this.colors.paint(this.viewport.surfaces[view], this.settings.coloring as Coloring,
      {truth, confidence: view === 'input' ? undefined : this.confidence[view], scaleMm: this.settings.scaleMm});
    this.viewport.redraw();
  }

  // Whether every view shows the frame.
  isShown(frame: number): boolean { return this.viewport.shownViews.every((view) => this.frameOf[view] === frame); }

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
    const {document} = this;
    document.takes.want(document.frame);
    const input = document.takes.current?.frames[document.frame];
    if (input && this.viewport.shownViews.includes('input')) {
      this.viewport.surfaces.input.show(input);
      this.frameOf.input = document.frame;
      this.viewport.redraw();
    }
    if (!document.model || !document.motion || document.rest) return;
    for (const view of kLiveViews) {
      if (!this.viewport.shownViews.includes(view)) continue;
      const look = document.look(view === 'edited');
      this.live.want(view, document.model.id, view === 'skinned' ? this.skinnedLook(look) : look);
      this.shownFrames.set(this.live.show(view, document.posesFor(view === 'edited')), document.frame);
    }
  }
  private skinnedLook(look: Look): Look {
    if (this.skinned?.boneScales !== look.boneScales) this.skinned = {...kPlainLook, skinnedOnly: true, boneScales: look.boneScales};
    return this.skinned;
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
    this.bones.mark(joint, new Set(document.rest ? document.rest.placed.value.keys() : [...edits.turns.keys(), ...(edits.moves.length ? [0] : [])]));
    this.timeline.show({frame: document.frame, numFrames: document.numFrames, numLoaded: document.takes.current?.numLoaded ?? document.numFrames,
      fps: document.fps, playing: this.playing, loop: settings.loop, showCurves: settings.showCurves, posable: document.motion !== null, keys, otherKeys: allKeys, errorsMm: this.measuring.errorsMm,
      confidences: this.measuring.confidences, scaleMm: settings.scaleMm});
    this.curves.show({frame: document.frame, numFrames: document.motion ? document.numFrames : 0, joint, jointName: readableName(document.joints[joint]?.name ?? ''), edits},
      settings.showCurves);
    this.side.show({views: this.viewport.shownViews, available: this.available, coloring: settings.coloring as Coloring,
      showBones: settings.showBones, showNames: settings.showNames, joints: document.joints, joint, pose: document.pose(true),
      change: document.changeOf(joint), keyed: keys.has(document.frame), edited: edits.turns.has(joint) || (joint === 0 && edits.moves.length > 0),
      strengths: document.motion ? document.joints.map((_, b) => strengthOf(document.motion!, edits, b)) : [],
      gizmo: this.dragging.mode, model: document.model, report: document.report, worst: this.measuring.worst(5), measured: this.measuring.text,
      undo: document.history.undoLabel, redo: document.history.redoLabel});
    this.skeleton.show(document.model && !this.isShared ? {open: document.rest !== null, why: document.takes.current?.done ? '' : 'The take of this character is not on the server.',
      frame: document.rest?.frame ?? 0, numPlaced: document.rest?.placed.value.size ?? 0, sided: /^(left|right)/.test(document.joints[joint]?.name ?? ''),
      placedHere: document.rest?.placed.value.has(joint) ?? false} : null);
    byId('title').textContent = document.model ? `${document.model.name}${document.isEdited ? ' · edited' : ''}` : (document.takeInfo ?? document.compressed)?.name ?? '';
    byId<HTMLButtonElement>('train').disabled = !document.takeInfo;
    globalThis.document.body.classList.toggle('shared', this.isShared);
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
