// What an animator does with a character in the studio, in a real browser: the folds by a shader and their
// strength, curves, the rest skeleton, films, and whether people who do not see can use it.
//
//   node edit_test.mjs --bin build/bin --chromium /usr/bin/chromium --packages build/npm --source . [--take samba]
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {parseArgs} from 'node:util';
import {accessibilityFaults, farthest, findAxe, StudioPage, takeFiles} from './harness.mjs';

const {values} = parseArgs({options: {
  bin: {type: 'string'}, chromium: {type: 'string'}, packages: {type: 'string'}, source: {type: 'string'},
  take: {type: 'string', default: 'dancer'}, shots: {type: 'string'},
}});
const studio = await StudioPage.open(values, 'parameters');
const {page, server} = studio, settle = () => studio.settle();
const axe = findAxe(values.packages);
const noFaults = async (where) => {
  if (axe) assert.deepEqual(await accessibilityFaults(page, axe), [], where);
  else console.log(`axe-core is not there: ${where} is not checked`);
};
const jointNamed = (name) => page.evaluate((wanted) => window.studio.document.joints.findIndex((joint) => joint.name === wanted), name);

await studio.run(async () => {
  await noFaults('the empty page');
  await studio.bring(takeFiles(server, values.source, values.take));
  await noFaults('a take');
  await page.click('#train');
  await noFaults('the dialog of the training');
  await studio.trainQuickly();
  const model = await studio.downloadModel();

  // The shader of the page shows the frames of the library.
  await page.evaluate(() => window.studio.seek(9));
  await settle();
  const error = farthest(await studio.positions(), await studio.posedByPleat(model, 9));
  const bytes = await page.evaluate(() => window.studio.statistics.bytes.slice(-20));
  console.log(`shader against pleat pose: ${(1e3 * error).toFixed(4)} mm at most, ${Math.max(...bytes)} bytes a frame at most`);
  assert.ok(error < 1e-4, `a vertex is ${1e3 * error} mm off`);
  assert.ok(Math.max(...bytes) < 1000, 'a frame takes more than 1 kB');

  // The strength of the folds: everywhere, and at one joint.
  const learned = await studio.positions();
  await page.locator('#folds-all').fill('0');
  await settle();
  const flat = await studio.positions();
  assert.ok(farthest(flat, learned) > 1e-3, 'the slider of the folds changes nothing');
  assert.ok(farthest(flat, await studio.posedByPleat(model, 9, '--skinned-only')) < 1e-4, 'without folds it is not the skinned mesh');
  await page.evaluate((b) => window.studio.select(b), await jointNamed('chest'));
  await page.locator('#folds-joint').fill('2');
  await settle();
  assert.ok(farthest(await studio.positions(), await studio.posedByPleat(model, 9)) < 1e-4, 'the strength at a joint is another one than that of pleat pose');
  await studio.shot('folds');
  await page.keyboard.press('z');
  await page.keyboard.press('z');
  await settle();
  assert.ok(farthest(await studio.positions(), learned) < 1e-5, 'undo does not bring the folds back');

  // A key is made, shown as curves, and dragged there.
  await page.evaluate((b) => {
    window.studio.select(b);
    window.studio.editing.setKey();
  }, await jointNamed('leftLowerArm'));
  await page.keyboard.press('v');
  await page.waitForSelector('#curves');
  const keyAt = await page.evaluate(() => {
    const box = window.document.getElementById('curves').getBoundingClientRect(), {numFrames} = window.studio.document;
    return {x: box.left + 8 + 9 / (numFrames - 1) * (box.width - 16), y: box.top + box.height / 2};
  });
  await studio.drag(keyAt, 0, -45);
  const turned = await page.evaluate(() => Math.hypot(...window.studio.document.changeOf(window.studio.document.joint)));
  assert.ok(turned > 4 && turned < 12, `the key was dragged to ${turned} degrees`);
  await studio.drag({x: keyAt.x, y: keyAt.y - 45}, 60, 0);
  const keys = await page.evaluate(() => [...window.studio.document.edits.value.turns.values()][0].map((key) => key.frame));
  assert.ok(keys.length === 1 && keys[0] > 9, `the key is at ${keys}`);
  await page.evaluate((frame) => window.studio.seek(frame), keys[0]);
  await page.click('#ease');
  await studio.shot('curves');
  await noFaults('a character with curves');
  await page.evaluate(() => { while (window.studio.document.edits.undo()); });

  // A film of the whole motion.
  const film = readFileSync(await studio.fileFrom('film.webm', () => window.takingAway.film()));
  assert.equal(film.readUInt32BE(0), 0x1a45dfa3, 'the film is no WebM');
  assert.ok(film.length > 10_000, `the film has ${film.length} bytes`);

  // The character with its folds reads back.
  const character = await studio.fileFrom('character.glb', () => window.takingAway.animation('character.glb'));
  const told = JSON.parse(server.pleat('inspect', character, '--json'));
  assert.equal(told.num_frames, await page.evaluate(() => window.studio.document.numFrames));

  // A take is compressed, and its frames are played from the middle on, within the promise.
  const frame = 25, input = await page.evaluate((t) => Array.from(window.studio.document.takes.current.frames[t]), frame);
  await page.click('#takes button[title=Compress]');
  await page.fill('#compress-mm', '1');
  await page.click('dialog button.main');
  await page.click('#compressed button');
  await page.evaluate((t) => window.studio.seek(t), frame);
  await page.waitForFunction((t) => window.studio.document.takes.current.frames[t], frame);
  const decoded = await page.evaluate((t) => Array.from(window.studio.document.takes.current.frames[t]), frame);
  assert.ok(farthest(decoded, input) <= 1e-3, 'a frame of the compressed sequence is further off than was promised');
  await studio.shot('compressed');
  await page.click('#models button');
  await page.waitForFunction(() => window.studio.document.model && window.studio.document.takes.current?.done);

  // A joint of the rest skeleton is moved, mirrored, and trained with.
  await page.click('#skeleton-open');
  const hand = await jointNamed('leftHand');
  await page.evaluate((b) => window.studio.select(b), hand);
  await page.evaluate(() => { window.studio.viewport.gizmo.detach(); });
  const before = await page.evaluate((b) => window.studio.document.rest.positions[b], hand);
  await studio.drag(await studio.jointOnScreen(hand), -14, 4);
  await page.click('#skeleton-mirror');
  await studio.shot('skeleton');
  const placed = await page.evaluate(() => [...window.studio.document.rest.placed.value]);
  assert.equal(placed.length, 2, 'the other hand was not mirrored');
  assert.ok(Math.hypot(...before.map((x, i) => x - placed[0][1][i])) > .005, 'the hand was not moved');
  await page.click('#skeleton-train');
  await studio.trainQuickly();
  const rested = await page.evaluate((b) => window.studio.document.joints[b].rest, hand);
  const off = Math.hypot(...rested.map((x, i) => x - placed[0][1][i]));
  assert.ok(off < 1e-3, `the new skeleton has the hand ${1e3 * off} mm from where it was put`);

  const unexpected = studio.problems.filter((text) => !/ERR_CONNECTION|net::|WebSocket|Failed to load resource/.test(text));
  assert.deepEqual(unexpected, [], 'the console has errors');
});
