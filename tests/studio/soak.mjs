// Poses a character in the page for a long time and watches the memory of the page and of the server.
// Prints a line a minute, and fails when either has grown by more than a tenth after the first five minutes.
//
//   node soak.mjs --bin build/bin --chromium /usr/bin/chromium --packages build/npm --source . [--minutes 30]
//        [--frames mesh|parameters] [--take samba]
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {parseArgs} from 'node:util';
import {StudioPage, takeFiles} from './harness.mjs';

const {values} = parseArgs({options: {
  bin: {type: 'string'}, chromium: {type: 'string'}, packages: {type: 'string'}, source: {type: 'string'},
  take: {type: 'string', default: 'dancer'}, minutes: {type: 'string', default: '30'}, frames: {type: 'string', default: 'mesh'},
}});
const kSettledMinutes = 5, kMaxGrowth = 1.1;

const studio = await StudioPage.open(values, values.frames);
const {page, server} = studio;
const serverMb = () => Number(/VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${server.child.pid}/status`, 'utf8'))[1]) / 1024;
const pageMb = async () => {
  const session = await page.context().newCDPSession(page);
  await session.send('HeapProfiler.collectGarbage');
  const {usedSize, backingStorageSize = 0} = await session.send('Runtime.getHeapUsage');
  await session.detach();
  return (usedSize + backingStorageSize) / 2 ** 20;
};

await studio.run(async () => {
  await studio.bring(takeFiles(server, values.source, values.take));
  await page.click('#train');
  await studio.trainQuickly();
  // One pose after the other, as fast as they are answered: every frame, and a hand that is turned.
  await page.evaluate(() => {
    const {studio} = window, hand = studio.document.joints.findIndex((joint) => joint.name === 'leftHand');
    let turns = 0;
    const next = () => {
      studio.seek((studio.document.frame + 1) % studio.document.numFrames);
      if (++turns % 10 === 0) studio.editing.turn(hand, [30 * Math.sin(turns / 50), 0, 0], 'soak');
      setTimeout(next, 30);
    };
    next();
  });
  const table = [];
  const end = performance.now() + 60_000 * Number(values.minutes);
  while (performance.now() < end) {
    await new Promise((done) => setTimeout(done, Math.min(60_000, end - performance.now())));
    const frames = await page.evaluate(() => window.studio.statistics.frames);
    table.push({frames, page: await pageMb(), server: serverMb()});
    const {page: inPage, server: inServer} = table.at(-1);
    console.log(`${table.length} min: ${frames} frames, page ${inPage.toFixed(1)} MB, server ${inServer.toFixed(1)} MB`);
  }
  const from = table[Math.min(kSettledMinutes, table.length) - 1], to = table.at(-1);
  for (const who of ['page', 'server']) assert.ok(to[who] <= kMaxGrowth * from[who], `the ${who} has grown from ${from[who]} to ${to[who]} MB`);
});
