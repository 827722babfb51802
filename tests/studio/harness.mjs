// A server, a browser and takes for tests of the page.
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

function find(packages, get) {
  for (const folder of [packages, ...(process.env.NODE_PATH ?? '').split(':').map((path) => path.replace(/\/node_modules$/, ''))]) {
    try {
      return get(createRequire(join(folder, 'x.js')));
    } catch { /* the next one */ }
  }
  return null;
}
export const findPlaywright = (packages) => find(packages, (require) => require('playwright-core'))
  ?? skip('playwright-core is not there (./dev test brings it)');
// The text of axe-core, which looks for what hinders people with a screen reader; null where it is not there.
export const findAxe = (packages) => find(packages, (require) => readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8'));

// What axe finds on the page as it is, in words.
export async function accessibilityFaults(page, axe) {
  await page.evaluate(axe);
  const {violations} = await page.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
  return violations.flatMap(({id, help, nodes}) => nodes.map((node) => `${id}: ${help}: ${node.html}`));
}

export class Server {
  constructor(bin) {
    this.bin = bin;
    this.folder = mkdtempSync(join(tmpdir(), 'pleat-studio-'));
  }
  // port: of the page; 0 takes any.
  async start(port = 0, ...more) {
    this.child = spawn(join(this.bin, 'pleatd'), ['--data-dir', join(this.folder, 'data'), '--listen', '127.0.0.1:0',
      '--http', `127.0.0.1:${port}`, '--reserve-bytes', '1MB', '--job-priority', 'normal', '--log-level', 'warning', ...more]);
    this.child.stderr.pipe(process.stderr);
    let out = '';
    await new Promise((done, fail) => {
      this.child.stdout.on('data', (bytes) => {
        out += bytes;
        if (/listening on .*\n/.test(out)) done();
      });
      this.child.on('exit', () => fail(new Error('pleatd has ended')));
    });
    this.page = /studio at (\S+)/.exec(out)[1];
    this.grpc = /listening on (\S+)/.exec(out)[1];
  }
  async stop() {
    if (this.child.exitCode !== null) return;
    const ended = new Promise((done) => this.child.removeAllListeners('exit').on('exit', done));
    this.child.kill('SIGTERM');
    await ended;
  }
  remove() { rmSync(this.folder, {recursive: true, force: true}); }
  pleat(...words) { return execFileSync(join(this.bin, 'pleat'), words, {encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe']}); }
}

// The files of a take: samba where captured sequences are on this machine, otherwise a performer.
export function takeFiles(server, source, want) {
  const shared = process.env.PLEAT_SHARED_DATA ?? join(source, '../shared/data');
  if (want === 'samba' && existsSync(join(shared, 'samba.pc2'))) {
    return [join(shared, 'samba.pc2'), join(shared, 'samba.obj')];
  }
  const folder = join(server.folder, 'dancer');
  server.pleat('generate', 'performer', '--frames', '40', '--vertices', '1500', '-o', folder);
  return readdirSync(folder).filter((name) => /\.(pc2|obj)$/.test(name)).map((name) => join(folder, name));
}

export async function openBrowser(playwright, chromium) {
  return playwright.chromium.launch({executablePath: chromium, args: [
    '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist']});
}

// A page of the studio in its own browser, with a server of its own.
export class StudioPage {
  // frames: how live frames come, 'mesh' or 'parameters'.
  static async open({bin, chromium, packages, shots}, frames = 'mesh') {
    if (!chromium || !existsSync(chromium)) skip('chromium is not there (./dev setup --all installs it)');
    const playwright = findPlaywright(packages), studio = new StudioPage();
    studio.shots = shots;
    studio.server = new Server(bin);
    await studio.server.start();
    studio.browser = await openBrowser(playwright, chromium);
    studio.page = await studio.browser.newPage({viewport: {width: 1280, height: 800}});
    studio.page.setDefaultTimeout(240_000);  // a machine may be busy with other tests
    studio.problems = [];
    studio.requests = [];
    studio.page.on('console', (message) => { if (message.type() === 'error') studio.problems.push(message.text()); });
    studio.page.on('pageerror', (error) => studio.problems.push(String(error)));
    studio.page.on('request', (request) => studio.requests.push(request.url()));
    await studio.page.addInitScript((how) => {
      const key = 'pleat.settings';
      localStorage.setItem(key, JSON.stringify({...JSON.parse(localStorage.getItem(key) ?? '{}'), frames: how}));
    }, frames);
    await studio.page.goto(studio.server.page);
    return studio;
  }
  async shot(name) { if (this.shots) await this.page.screenshot({path: join(this.shots, `${name}.png`)}); }
  async bring(files) {
    await this.page.setInputFiles('#files', files);
    await this.page.waitForFunction(() => window.studio.document.takes.current?.done);
    await this.page.waitForFunction(() => window.studio.viewport.surfaces.input.mesh.visible);
  }
  // In the dialog that is open: trains with the quick preset, and waits for the character.
  async trainQuickly() {
    const {page} = this, before = await page.evaluate(() => window.studio.document.model?.id ?? '');
    await page.check('input[value=quick]');
    await this.shot('train');
    await page.click('dialog button.main');
    await page.waitForSelector('#work:not([hidden])', {timeout: 240_000});
    await this.shot('training');
    await page.waitForFunction((id) => window.studio.document.model && window.studio.document.model.id !== id
      && window.studio.viewport.surfaces.edited.mesh.visible, before, {timeout: 600_000});
    await page.waitForFunction(() => !window.studio.measuring.running);
    await this.settle();
  }
  // The frame that belongs to the last change has come when the session is at rest.
  async settle() {
    await this.page.evaluate(() => { window.settled = undefined; });
    await this.page.waitForFunction(() => {
      const {frames} = window.studio.statistics;
      const at = performance.now();
      if (window.settled?.frames !== frames) window.settled = {frames, at};
      return frames > 0 && at - window.settled.at > 400;
    }, null, {polling: 50});
  }
  positions(view = 'edited') { return this.page.evaluate((name) => Array.from(window.studio.viewport.surfaces[name].positions), view); }
  // Bytes that the page gets from a function of its own, as a file.
  async fileFrom(name, get, argument) {
    const got = await this.page.evaluateHandle(get, argument);
    const bytes = await this.page.evaluate(async (body) => Array.from(new Uint8Array(await body.arrayBuffer())), got);
    const path = join(this.server.folder, name);
    writeFileSync(path, Uint8Array.from(bytes));
    return path;
  }
  async downloadModel() {
    return this.fileFrom('model.pleat', (id) => fetch('/rpc/ModelService/DownloadModel', {method: 'POST',
      headers: {'X-Pleat-Studio': '1', 'Content-Type': 'application/json'}, body: JSON.stringify({id})}),
    await this.page.evaluate(() => window.studio.document.model.id));
  }
  // The frames of the command line for the motion of the page: positions of one frame.
  async posedByPleat(model, frame, ...more) {
    const motion = join(this.server.folder, 'edited.json'), cache = join(this.server.folder, 'edited.pc2');
    writeFileSync(motion, JSON.stringify(await this.page.evaluate(() => window.studio.document.motionFile())));
    this.server.pleat('pose', model, '--motion', motion, '-o', cache, '--force', ...more);
    return cacheFrame(cache, frame);
  }
  // The mouse over a joint as it is shown.
  jointOnScreen(joint) {
    return this.page.evaluate((b) => {
      const {document: doc, viewport} = window.studio, [x, y, z] = doc.placed().positions[b];
      const point = viewport.camera.position.clone().set(x, y, z).project(viewport.camera);
      const box = window.document.getElementById('editor').getBoundingClientRect();
      return {x: box.left + (point.x + 1) / 2 * box.width, y: box.top + (1 - point.y) / 2 * box.height};
    }, joint);
  }
  async drag({x, y}, dx, dy) {
    const {mouse} = this.page;
    await mouse.move(x, y);
    await mouse.down();
    for (let i = 1; i <= 12; ++i) await mouse.move(x + dx * i / 12, y + dy * i / 12);
    await mouse.up();
  }
  // Runs the test, says what the page said when it fails, and ends all.
  async run(test) {
    try {
      await test();
      console.log('passed');
    } catch (error) {
      await this.shot('failure');
      console.error(this.problems.join('\n'));
      console.error(await this.page.evaluate(() => document.getElementById('messages')?.innerText).catch(() => ''));
      throw error;
    } finally {
      await this.browser.close();
      await this.server.stop().catch(() => {});
      this.server.remove();
    }
  }
}

// The positions of one frame of a point cache.
export function cacheFrame(path, frame) {
  const bytes = readFileSync(path);
  const numVertices = bytes.readInt32LE(16);
  return Array.from({length: 3 * numVertices}, (_, i) => bytes.readFloatLE(32 + 12 * numVertices * frame + 4 * i));
}
export function farthest(a, b) {
  if (a.length !== b.length) throw new Error(`${a.length} numbers and ${b.length}`);
  return a.reduce((most, x, i) => Math.max(most, Math.abs(x - b[i])), 0);
}
