// The viewport: one to four views of the same moment side by side, with one camera for all.
import {Color, DirectionalLight, GridHelper, HemisphereLight, PerspectiveCamera, Scene, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {TransformControls} from 'three/addons/controls/TransformControls.js';
import {Surface} from './surface';

export type ViewName = 'input' | 'skinned' | 'hybrid' | 'edited';
export const kViewNames: readonly ViewName[] = ['input', 'skinned', 'hybrid', 'edited'];

export class Viewport {
  readonly camera = new PerspectiveCamera(35, 1, .01, 200);
  readonly orbit: OrbitControls;
  readonly gizmo: TransformControls;
  readonly surfaces: Record<ViewName, Surface>;
  readonly overlay = new Scene();  // bones and the gizmo, in the view that is edited
  private readonly scene = new Scene();
  private readonly renderer: WebGLRenderer;
  private readonly grid = new GridHelper(10, 20);
  private views: ViewName[] = ['edited'];
  private dirty = true;
  drawn: (left: number, width: number, height: number) => void = () => {};

  // editor: an element over the view that is edited, on which the gizmo is dragged; it lies inside the
  // parent of the canvas, on which the camera is turned.
  constructor(private readonly canvas: HTMLCanvasElement, private readonly editor: HTMLElement) {
    this.renderer = new WebGLRenderer({canvas, antialias: true, preserveDrawingBuffer: false});
    this.renderer.setScissorTest(true);
    this.renderer.autoClear = false;
    this.camera.position.set(2.2, 1.5, 4.2);
    this.orbit = new OrbitControls(this.camera, canvas.parentElement!);
    this.orbit.target.set(0, .9, 0);
    this.orbit.addEventListener('change', () => this.redraw());
    this.gizmo = new TransformControls(this.camera, editor);
    this.gizmo.setSize(.7);
    this.gizmo.addEventListener('change', () => this.redraw());
    this.gizmo.addEventListener('dragging-changed', (event) => { this.orbit.enabled = !event.value; });
    this.overlay.add(this.gizmo.getHelper());
    const light = new DirectionalLight(0xffffff, 1.9);
    light.position.set(2, 4, 3);
    this.scene.add(new HemisphereLight(0xffffff, 0x555560, 1.3), light, this.grid);
    const colors: Record<ViewName, number> = {input: 0xc9c4bb, skinned: 0xb9c3d1, hybrid: 0xc3d1b9, edited: 0xd6cdbf};
    this.surfaces = Object.fromEntries(kViewNames.map((name) => [name, new Surface(colors[name])])) as Record<ViewName, Surface>;
    for (const surface of Object.values(this.surfaces)) this.scene.add(surface.mesh);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
    this.resize();
    const loop = (): void => {
      this.draw();
      requestAnimationFrame(loop);
    };
    requestAnimationFrame(loop);
  }

  redraw(): void { this.dirty = true; }
  setViews(views: ViewName[]): void {
    this.views = views;
    this.resize();
  }
  get shownViews(): readonly ViewName[] { return this.views; }
  setColors(background: string, line: string): void {
    this.scene.background = new Color(background);
    (this.grid.material as {color?: Color; vertexColors?: boolean}).vertexColors = false;
    (this.grid.material as {color: Color}).color = new Color(line);
    this.redraw();
  }

  // Looks at what is there as a whole.
  frame(positions: Float32Array): void {
    if (positions.length === 0) return;
    const low = new Vector3(Infinity, Infinity, Infinity), high = new Vector3(-Infinity, -Infinity, -Infinity);
    const point = new Vector3();
    for (let v = 0; v < positions.length; v += 3) {
      point.set(positions[v]!, positions[v + 1]!, positions[v + 2]!);
      low.min(point);
      high.max(point);
    }
    const center = low.clone().add(high).multiplyScalar(.5);
    const size = high.distanceTo(low);
    const direction = this.camera.position.clone().sub(this.orbit.target).normalize();
    this.orbit.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, 1.75 * size * Math.max(1, .8 / this.camera.aspect));
    this.camera.near = size / 500;
    this.camera.far = size * 100;
    this.grid.position.set(center.x, low.y, center.z);
    this.grid.scale.setScalar(size / 4);
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.redraw();
  }

  // The part of the canvas that shows the view, CSS pixels.
  rectOf(name: ViewName): {left: number; width: number; height: number} {
    const width = this.canvas.clientWidth / this.views.length;
    return {left: width * Math.max(0, this.views.indexOf(name)), width, height: this.canvas.clientHeight};
  }
  // The view in which joints are shown and dragged.
  get editView(): ViewName { return this.views.includes('edited') ? 'edited' : this.views[this.views.length - 1]!; }

  picture(): Promise<Blob> {
    this.dirty = true;
    this.draw();
    return new Promise((done, fail) => this.canvas.toBlob((blob) => blob ? done(blob) : fail(new Error('the view cannot be read')), 'image/png'));
  }

  // What is drawn from now on, as a film.
  stream(fps: number): MediaStream { return this.canvas.captureStream(fps); }

  private resize(): void {
    const {clientWidth: width, clientHeight: height} = this.canvas.parentElement!;
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = Math.max(.01, width / this.views.length / Math.max(1, height));
    this.camera.updateProjectionMatrix();
    const edit = this.rectOf(this.editView);
    this.editor.style.left = `${edit.left}px`;
    this.editor.style.width = `${edit.width}px`;
    this.redraw();
  }

  private draw(): void {
    if (!this.dirty) return;
    this.dirty = false;
    this.views.forEach((name, place) => {
      const {width, height} = this.rectOf(name);
      for (const other of kViewNames) this.surfaces[other].mesh.layers.set(other === name ? 0 : 1);
      this.renderer.setViewport(place * width, 0, width, height);
      this.renderer.setScissor(place * width, 0, width, height);
      this.renderer.clear();
      this.renderer.render(this.scene, this.camera);
      if (name === this.editView) this.renderer.render(this.overlay, this.camera);
    });
    const {left, width, height} = this.rectOf(this.editView);
    this.drawn(left, width, height);
  }
}
