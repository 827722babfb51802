// The studio in a real browser: a take comes in, is trained, its left hand is dragged, the vertices on
// the page are those of `pleat pose`, undo brings them back, and the export reads back as the same.
//
//   node browser_test.mjs --bin build/bin --chromium /usr/bin/chromium --packages build/npm --source . [--take samba]
import assert from 'node:assert/strict';
import {existsSync, readFileSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {parseArgs} from 'node:util';
import {findPlaywright, openBrowser, Server, skip, takeFiles} from './harness.mjs';

const {values} = parseArgs({options: {
  bin: {type: 'string'}, chromium: {type: 'string'}, packages: {type: 'string'}, source: {type: 'string'},
  take: {type: 'string', default: 'dancer'}, shots: {type: 'string'},
}});
if (!values.chromium || !existsSync(values.chromium)) skip('chromium is not there (./dev setup --all installs it)');
const playwright = findPlaywright(values.packages);

// The positions of one frame of a point cache.
function cacheFrame(path, frame) {
  const bytes = readFileSync(path);
  const numVertices = bytes.readInt32LE(16);
  return Array.from({length: 3 * numVertices}, (_, i) => bytes.readFloatLE(32 + 12 * numVertices * frame + 4 * i));
}
const farthest = (a, b) => {
  assert.equal(a.length, b.length);
  let most = 0;
  for (let i = 0; i < a.length; ++i) most = Math.max(most, Math.abs(a[i] - b[i]));
  return most;
};

const server = new Server(values.bin);
await server.start();
const port = Number(new URL(server.page).port);
const browser = await openBrowser(playwright, values.chromium);
const page = await browser.newPage({viewport: {width: 1280, height: 800}});
page.setDefaultTimeout(240_000);  // a machine may be busy with other tests
const problems = [], requests = [];
page.on('console', (message) => { if (message.type() === 'error') problems.push(message.text()); });
page.on('pageerror', (error) => problems.push(String(error)));
page.on('request', (request) => requests.push(request.url()));
const shot = async (name) => { if (values.shots) await page.screenshot({path: join(values.shots, `${name}.png`)}); };
// The frame that belongs to the last change has come when the session is at rest.
const settle = async () => {
  await page.evaluate(() => { window.settled = undefined; });
  await page.waitForFunction(() => {
    const {frames} = window.studio.statistics;
    const at = performance.now();
    if (window.settled?.frames !== frames) window.settled = {frames, at};
    return frames > 0 && at - window.settled.at > 400;
  }, null, {polling: 50});
};
const positions = () => page.evaluate(() => Array.from(window.studio.viewport.surfaces.edited.positions));

try {
  await page.goto(server.page);
  await page.waitForSelector('#empty:not([hidden])');
  await shot('empty');

  // A take comes in.
  await page.setInputFiles('#files', takeFiles(server, values.source, values.take));
  await page.waitForFunction(() => window.studio.document.takes.current?.done);
  await page.waitForFunction(() => window.studio.viewport.surfaces.input.mesh.visible);
  await shot('take');

  // It is trained.
  await page.click('#train');
  await page.check('input[value=quick]');
  await shot('train');
  await page.click('dialog button.main');
  await page.waitForSelector('#work:not([hidden])', {timeout: 240_000});
  await shot('training');
  await page.waitForFunction(() => window.studio.document.model && window.studio.viewport.surfaces.edited.mesh.visible,
    null, {timeout: 600_000});
  await page.waitForFunction(() => !window.studio.measuring.running);
  await settle();
  await shot('character');
  const before = await positions();

  // The left hand is dragged.
  await page.evaluate(() => {
    window.studio.seek(12);
    window.studio.select(window.studio.document.joints.findIndex((joint) => joint.name === 'leftHand'));
    window.studio.setGizmo('translate');
  });
  await settle();
  const unposed = await positions();
  const hand = await page.evaluate(() => {
    const {document: doc, viewport} = window.studio;
    const [x, y, z] = doc.placed().positions[doc.joint];
    const point = viewport.camera.position.clone().set(x, y, z).project(viewport.camera);
    const box = window.document.getElementById('editor').getBoundingClientRect();
    return {x: box.left + (point.x + 1) / 2 * box.width, y: box.top + (1 - point.y) / 2 * box.height};
  });
  await page.evaluate(() => { window.studio.viewport.gizmo.detach(); });  // the ball itself is dragged
  await page.mouse.move(hand.x, hand.y);
  await page.mouse.down();
  for (let i = 1; i <= 12; ++i) await page.mouse.move(hand.x + 5 * i, hand.y - 8 * i);
  await page.mouse.up();
  await settle();
  const posed = await positions();
  assert.ok(farthest(posed, unposed) > .05, 'the hand has not moved');
  await shot('posed');

  // The vertices are those of the command line for the same pose, within half a step of the grid.
  const motion = join(server.folder, 'edited.json');
  writeFileSync(motion, JSON.stringify(await page.evaluate(() => window.studio.document.motionFile())));
  const modelId = await page.evaluate(() => window.studio.document.model.id);
  const model = join(server.folder, 'model.pleat');
  const bytes = await page.evaluate(async (id) => {
    const response = await fetch('/rpc/ModelService/DownloadModel', {method: 'POST',
      headers: {'X-Pleat-Studio': '1', 'Content-Type': 'application/json'}, body: JSON.stringify({id})});
    return Array.from(new Uint8Array(await response.arrayBuffer()));
  }, modelId);
  writeFileSync(model, Uint8Array.from(bytes));
  const cache = join(server.folder, 'edited.pc2');
  server.pleat('pose', model, '--motion', motion, '-o', cache);
  const header = await page.evaluate(() => {
    const {positions: p} = window.studio.viewport.surfaces.edited;
    return {numVertices: p.length / 3};
  });
  const truth = cacheFrame(cache, 12);
  assert.equal(header.numVertices * 3, truth.length);
  const grid = .0012;  // at most a step of 12 bits on a person; half of it is allowed
  const error = farthest(posed, truth);
  console.log(`page against pleat pose: ${(1e3 * error).toFixed(3)} mm at most`);
  assert.ok(error <= grid / 2, `a vertex is ${1e3 * error} mm off`);

  // Undo brings the take's pose back, redo the edit.
  await page.keyboard.press('z');
  await settle();
  assert.ok(farthest(await positions(), unposed) < 1e-3, 'undo did not bring the pose back');
  await page.keyboard.press('Shift+Z');
  await settle();
  assert.ok(farthest(await positions(), posed) < 1e-3, 'redo did not');
  await page.keyboard.press('Home');
  await settle();
  void before;

  // What is exported reads back as the frames of the command line.
  const exported = await page.evaluate(async () => Array.from(new Uint8Array(await (await window.studio.exported('pc2')).arrayBuffer())));
  writeFileSync(join(server.folder, 'page.pc2'), Uint8Array.from(exported));
  assert.ok(farthest(cacheFrame(join(server.folder, 'page.pc2'), 12), truth) < 1e-5, 'the export has other vertices');
  const glb = await page.evaluate(async () => Array.from(new Uint8Array(await (await window.studio.exported('glb')).arrayBuffer())));
  const glbPath = join(server.folder, 'page.glb');
  writeFileSync(glbPath, Uint8Array.from(glb));
  const numFrames = await page.evaluate(() => window.studio.document.numFrames);
  assert.equal(JSON.parse(server.pleat('inspect', glbPath, '--json')).num_frames, numFrames);

  // Side by side, errors as colors.
  await page.evaluate(() => window.studio.setViews(['input', 'skinned', 'hybrid', 'edited']));
  await page.keyboard.press('e');
  await settle();
  await page.evaluate(() => window.studio.setScale(10));
  await shot('compare');
  await page.keyboard.press('e');
  await page.keyboard.press('?');
  await page.waitForSelector('dialog[open]');
  await shot('help');
  await page.keyboard.press('Escape');

  // Nothing is lost by a reload.
  await page.reload();
  await page.waitForFunction(() => window.studio?.document.model && window.studio.document.isEdited);

  // A server that goes away is said, and comes back by itself.
  await page.waitForFunction(() => window.studio.viewport.surfaces.edited.mesh.visible);
  await server.stop();
  await page.waitForSelector('#server.lost', {timeout: 240_000});
  await shot('offline');
  assert.ok(await page.evaluate(() => window.studio.viewport.surfaces.edited.mesh.visible), 'the last picture is gone');
  await server.start(port);
  await page.waitForSelector('#server:not(.lost)', {timeout: 240_000});
  const framesBefore = await page.evaluate(() => window.studio.statistics.frames);
  await page.waitForFunction((n) => {
    window.studio.seek((window.studio.document.frame + 1) % window.studio.document.numFrames);
    return window.studio.statistics.frames > n + 3;
  }, framesBefore, {timeout: 240_000, polling: 300});

  // How soon a pose is answered on this machine, drawing excluded.
  const times = await page.evaluate(async () => {
    const {studio} = window;
    studio.statistics.roundTripsMs.length = 0;
    for (let i = 0; i < 60; ++i) {
      const n = studio.statistics.frames;
      studio.seek((studio.document.frame + 1) % studio.document.numFrames);
      for (let k = 0; k < 400 && studio.statistics.frames === n; ++k) await new Promise((done) => setTimeout(done, 2));
    }
    return [...studio.statistics.roundTripsMs].sort((a, b) => a - b);
  });
  console.log(`pose to decoded mesh: p50 ${times[times.length >> 1].toFixed(1)} ms, p95 ${times[Math.floor(.95 * times.length)].toFixed(1)} ms`);

  // Three tabs at once.
  const tabs = await Promise.all([0, 1, 2].map(() => browser.newPage()));
  await Promise.all(tabs.map(async (tab) => {
    await tab.goto(server.page);
    await tab.evaluate((id) => localStorage.setItem('pleat.settings', JSON.stringify({modelId: id})), modelId);
    await tab.reload();
    await tab.waitForFunction(() => window.studio?.viewport.surfaces.edited.mesh.visible);
  }));
  for (const tab of tabs) await tab.close();

  // Narrow and small windows, light and dark.
  for (const [width, height] of [[1680, 1000], [1024, 700], [420, 800]]) {
    for (const scheme of ['light', 'dark']) {
      await page.setViewportSize({width, height});
      await page.emulateMedia({colorScheme: scheme});
      await page.waitForFunction((w) => window.innerWidth === w, width);
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      assert.ok(overflow <= 0, `the page is wider than its window of ${width}`);
      await shot(`size-${width}-${scheme}`);
    }
  }

  const foreign = requests.filter((url) => !url.startsWith(server.page) && !/^(blob|data):/.test(url));
  assert.deepEqual(foreign, [], 'the page asks others');
  const unexpected = problems.filter((text) => !/ERR_CONNECTION|net::|WebSocket|Failed to load resource/.test(text));
  assert.deepEqual(unexpected, [], 'the console has errors');
  console.log('passed');
} catch (error) {
  await shot('failure');
  console.error(problems.join('\n'));
  console.error(await page.evaluate(() => document.getElementById('messages')?.innerText).catch(() => ''));
  throw error;
} finally {
  await browser.close();
  await server.stop().catch(() => {});
  server.remove();
}
