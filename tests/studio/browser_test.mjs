// The studio in a real browser: a take comes in, is trained, its left hand is dragged, the vertices on
// the page are those of `pleat pose`, undo brings them back, and the export reads back as the same.
//
//   node browser_test.mjs --bin build/bin --chromium /usr/bin/chromium --packages build/npm --source . [--take samba]
import assert from 'node:assert/strict';
import {parseArgs} from 'node:util';
import {cacheFrame, farthest, StudioPage, takeFiles} from './harness.mjs';

const {values} = parseArgs({options: {
  bin: {type: 'string'}, chromium: {type: 'string'}, packages: {type: 'string'}, source: {type: 'string'},
  take: {type: 'string', default: 'dancer'}, shots: {type: 'string'},
}});
const studio = await StudioPage.open(values);
const {server, browser, page, problems, requests} = studio;
const port = Number(new URL(server.page).port);  // the same after a restart
const shot = (name) => studio.shot(name), settle = () => studio.settle(), positions = () => studio.positions();

await studio.run(async () => {
  await page.waitForSelector('#empty:not([hidden])');
  await shot('empty');

  // A take comes in.
  await studio.bring(takeFiles(server, values.source, values.take));
  await shot('take');

  // It is trained.
  await page.click('#train');
  await studio.trainQuickly();
  await shot('character');

  // The left hand is dragged.
  await page.evaluate(() => {
    window.studio.seek(12);
    window.studio.select(window.studio.document.joints.findIndex((joint) => joint.name === 'leftHand'));
    window.studio.setGizmo('translate');
  });
  await settle();
  const unposed = await positions();
  const hand = await studio.jointOnScreen(await page.evaluate(() => window.studio.document.joint));
  await page.evaluate(() => { window.studio.viewport.gizmo.detach(); });  // the ball itself is dragged
  await studio.drag(hand, 60, -96);
  await settle();
  const posed = await positions();
  assert.ok(farthest(posed, unposed) > .05, 'the hand has not moved');
  await shot('posed');

  // The vertices are those of the command line for the same pose, within half a step of the grid.
  const modelId = await page.evaluate(() => window.studio.document.model.id);
  const truth = await studio.posedByPleat(await studio.downloadModel(), 12);
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

  // What is exported reads back as the frames of the command line.
  const exported = await studio.fileFrom('page.pc2', () => window.takingAway.animation('pc2'));
  assert.ok(farthest(cacheFrame(exported, 12), truth) < 1e-5, 'the export has other vertices');
  const glbPath = await studio.fileFrom('page.glb', () => window.takingAway.animation('glb'));
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

  // A link to the character: it can be posed, and there is nothing else.
  await server.stop();
  await server.start(port, '--share', modelId);
  const visitor = await browser.newPage({viewport: {width: 1280, height: 800}});
  await visitor.goto(server.page);
  await visitor.waitForFunction(() => window.studio?.viewport.surfaces.edited.mesh.visible);
  assert.equal(await visitor.evaluate(() => window.studio.models.length + window.studio.takes.length), 2);
  assert.equal(await visitor.locator('#train').isVisible(), false, 'a visitor could train');
  const refused = await visitor.evaluate(async (id) => (await fetch('/rpc/ModelService/DeleteModel', {method: 'POST',
    headers: {'X-Pleat-Studio': '1', 'Content-Type': 'application/json'}, body: JSON.stringify({id})})).status, modelId);
  assert.equal(refused, 403, 'a visitor could delete the character');
  if (values.shots) await visitor.screenshot({path: `${values.shots}/shared.png`});
  await visitor.close();

  const foreign = requests.filter((url) => !url.startsWith(server.page) && !/^(blob|data):/.test(url));
  assert.deepEqual(foreign, [], 'the page asks others');
  const unexpected = problems.filter((text) => !/ERR_CONNECTION|net::|WebSocket|Failed to load resource/.test(text));
  assert.deepEqual(unexpected, [], 'the console has errors');
});
