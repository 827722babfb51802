// The arithmetic of the page under node, without a browser: poses, inverse kinematics, keys, undo.
//
//   node units_test.mjs --web build/web
import assert from 'node:assert/strict';
import {existsSync, readFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {join, resolve} from 'node:path';
import {test} from 'node:test';
import {parseArgs} from 'node:util';

const {values} = parseArgs({options: {web: {type: 'string'}}});
const web = resolve(values.web);
if (!existsSync(join(web, 'node_modules/esbuild')) || !existsSync(join(web, 'src/math'))) {
  console.log('skipped: the page was not built (npm is missing)');
  process.exit(77);
}
const esbuild = createRequire(join(web, 'x.js'))('esbuild');
globalThis.sessionStorage = {getItem: () => null, setItem() {}};  // what a page has
async function load(path) {
  const {outputFiles} = await esbuild.build({entryPoints: [join(web, 'src', path)], bundle: true, format: 'esm', write: false});
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString('base64')}`);
}
const [quaternion, skeleton, ik, motion, {History}, {RestSkeleton, symmetryPlane}, colors, hierarchy, delta, {fan},
  {nextRange, forgetFar}] = await Promise.all([
  'math/quaternion.ts', 'math/skeleton.ts', 'math/inverse_kinematics.ts', 'store/motion.ts', 'store/history.ts',
  'store/rest_skeleton.ts',  'scene/colors.ts', 'worker/hierarchy.ts', 'worker/delta.ts', 'api/sequence_stream.ts',
  'store/compressed_take.ts'].map(load));

const near = (a, b, epsilon = 1e-6) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < epsilon, `${a} is not ${b}`));
const kJoints = [
  {name: 'hips', parent: -1, rest: [0, 1, 0]}, {name: 'chest', parent: 0, rest: [0, 1.4, 0]},
  {name: 'leftUpperArm', parent: 1, rest: [.2, 1.4, 0]}, {name: 'leftLowerArm', parent: 2, rest: [.5, 1.4, 0]},
  {name: 'leftHand', parent: 3, rest: [.75, 1.4, .05]}];
const rest = () => skeleton.restPose(kJoints);

test('rotations compose, and angles come back', () => {
  const a = quaternion.fromDegrees([20, -35, 70]), b = quaternion.fromDegrees([-80, 10, 5]);
  near(quaternion.rotate(quaternion.multiply(a, b), [1, 2, 3]), quaternion.rotate(a, quaternion.rotate(b, [1, 2, 3])));
  near(quaternion.toDegrees(a), [20, -35, 70]);
  near(quaternion.rotate(quaternion.between([1, 0, 0], [-1, 0, 0]), [1, 0, 0]), [-1, 0, 0]);
  near(quaternion.slerp(a, b, 0), a);
  near(quaternion.rotate(quaternion.slerp(a, b, 1), [0, 1, 0]), quaternion.rotate(b, [0, 1, 0]));
});

test('a bone turns about the joint above its end', () => {
  const pose = rest();
  const rotations = [...pose.rotations];
  rotations[3] = quaternion.fromDegrees([0, 0, 90]);
  const {positions} = skeleton.placeJoints(kJoints, {root: pose.root, rotations});
  near(positions[2], [.2, 1.4, 0]);
  near(positions[3], [.2, 1.7, 0]);
});

test('a hand that is dragged gets there, or as far as its arm reaches', () => {
  for (const target of [[.5, 1.7, .2], [.3, 1.2, .3], [.45, 1.55, -.2]]) {
    const pose = ik.dragJoint(kJoints, rest(), 4, target);
    const {positions} = skeleton.placeJoints(kJoints, pose);
    near(positions[4], target, 1e-4);
    near(positions[1], [0, 1.4, 0]);
    // Bones keep their lengths.
    assert.ok(Math.abs(quaternion.length(quaternion.subtract(positions[3], positions[2])) - .3) < 1e-9);
  }
  const far = skeleton.placeJoints(kJoints, ik.dragJoint(kJoints, rest(), 4, [5, 1.4, 0])).positions[4];
  assert.ok(far[0] > .74 && far[0] < .76);
});

test('other joints swing one bone, and the hips move the body', () => {
  const swung = skeleton.placeJoints(kJoints, ik.dragJoint(kJoints, rest(), 3, [.2, 5, 0])).positions;
  near(swung[3], [.2, 1.7, 0]);
  near(skeleton.placeJoints(kJoints, ik.dragJoint(kJoints, rest(), 0, [1, 2, 3])).positions[1], [1, 2.4, 3]);
});

test('keys hold a change, blend between each other, and go away again', () => {
  const take = motion.restMotion(kJoints, 11, 30);
  const bend = (degrees) => {
    const rotations = [...rest().rotations];
    rotations[3] = quaternion.fromDegrees([0, 0, degrees]);
    return {root: rest().root, rotations};
  };
  let edits = motion.keyPose(take, motion.kNoEdits, 0, bend(0.001));
  edits = motion.keyPose(take, edits, 10, bend(60));
  near(quaternion.toDegrees(motion.poseAt(take, edits, 5).rotations[3]), [0, 0, 30], .01);
  near(quaternion.toDegrees(motion.poseAt(take, edits, 10).rotations[3]), [0, 0, 60], .01);
  assert.deepEqual([...motion.keyedFrames(edits, 3)], [0, 10]);
  assert.deepEqual(motion.editsFromJson(motion.editsToJson(edits)), edits);
  edits = motion.removeKeys(edits, 10, 3);
  near(quaternion.toDegrees(motion.poseAt(take, edits, 10).rotations[3]), [0, 0, 0], .01);
  assert.ok(!motion.isEdited(motion.resetJoint(edits, 3)));
  const file = motion.motionToFile(take, edits, kJoints);
  assert.equal(motion.motionFromFile(file, kJoints).frames.length, 11);
});

test('a key is dragged in time and to another angle, no further than its neighbors', () => {
  const take = motion.restMotion(kJoints, 21, 30);
  const turned = (degrees) => ({turn: quaternion.fromDegrees([0, 0, degrees])});
  let edits = {...motion.kNoEdits, turns: new Map([[3, [0, 10, 20].map((frame) => ({frame, ...turned(frame)}))]])};
  edits = motion.changeKey(edits, 3, 10, 14, turned(40));
  assert.deepEqual([...motion.keyedFrames(edits, 3)], [0, 14, 20]);
  near(quaternion.toDegrees(motion.poseAt(take, edits, 14).rotations[3]), [0, 0, 40], .01);
  assert.deepEqual([...motion.keyedFrames(motion.changeKey(edits, 3, 14, 99, turned(0)), 3)], [0, 19, 20]);
  assert.deepEqual([...motion.keyedFrames(motion.changeKey(edits, 3, 0, -5, turned(0)), 3)], [0, 14, 20]);
  const moved = motion.changeKey({...motion.kNoEdits, moves: [{frame: 2, move: [0, 0, 0]}]}, 0, 2, 5, {move: [1, 2, 3]});
  near(motion.poseAt(take, moved, 8).root, [1, 3, 3]);
});

test('a key that eases starts and ends at rest', () => {
  const take = motion.restMotion(kJoints, 11, 30);
  let edits = {...motion.kNoEdits, turns: new Map([[3, [0, 10].map((frame) => ({frame, turn: quaternion.fromDegrees([0, 0, 6 * frame])}))]])};
  const angle = (frame) => quaternion.toDegrees(motion.poseAt(take, edits, frame).rotations[3])[2];
  edits = motion.toggleEase(edits, 3, 4);
  near([angle(0), angle(1), angle(5), angle(9), angle(10)], [0, 60 * .028, 30, 60 * .972, 60], 1e-6);
  assert.deepEqual(motion.editsFromJson(motion.editsToJson(edits)), edits);
  edits = motion.toggleEase(edits, 3, 9);
  near([angle(1)], [6], 1e-6);
});

test('the strength of the folds is an edit, and a motion keeps what it says of it and of its proportions', () => {
  const file = {schema: 'pleat.motion/1', fps: 24, joints: ['hips'], frames: [{root_translation: [0, 1, 0], rotations: [[1, 0, 0, 0]]}],
    bone_scales: {leftHand: 2}, detail_strengths: {chest: .5}, vertex_strengths: [0, 1, 2]};
  const dropped = motion.motionFromFile(file, kJoints);
  assert.equal(motion.lookWith(dropped, motion.kNoEdits), dropped.look);
  assert.deepEqual(dropped.look.jointStrengths, [1, .5, 1, 1, 1]);
  let edits = motion.withStrength(motion.kNoEdits, [3, 4], 0);
  assert.ok(motion.isEdited(edits));
  const look = motion.lookWith(dropped, edits);
  assert.deepEqual(look.jointStrengths, [1, .5, 1, 0, 0]);
  assert.equal(motion.lookWith(dropped, edits), look, 'the look changes without a change');
  const written = motion.motionToFile(dropped, edits, kJoints);
  assert.deepEqual(written.vertex_strengths, [0, 1, 2]);
  assert.deepEqual(written.bone_scales, {hips: 1, chest: 1, leftUpperArm: 1, leftLowerArm: 1, leftHand: 2});
  assert.equal(written.detail_strengths.leftHand, 0);
  assert.deepEqual(motion.editsFromJson(motion.editsToJson(edits)), edits);
  assert.ok(!motion.isEdited(motion.resetJoint(motion.resetJoint(edits, 3), 4)));
  const long = skeleton.scaledJoints(kJoints, dropped.look.boneScales);
  near(long[4].rest, [1, 1.4, .1]);
  assert.equal(skeleton.scaledJoints(kJoints, []), kJoints);
});

test('the rest skeleton is moved, mirrored and undone', () => {
  const joints = [...kJoints, {name: 'rightUpperArm', parent: 1, rest: [-.2, 1.4, 0]},
    {name: 'rightLowerArm', parent: 5, rest: [-.5, 1.4, 0]}, {name: 'rightHand', parent: 6, rest: [-.75, 1.4, .05]}];
  near(symmetryPlane(joints).normal, [1, 0, 0]);
  const moved = new RestSkeleton(joints, 7, () => {});
  assert.ok(!moved.mirror(4), 'there is nothing to mirror yet');
  moved.move(4, [.7, 1.3, .1], 'move left hand', 'drag1');
  assert.ok(!moved.mirror(7), 'the right side was not moved');
  assert.ok(moved.mirror(3));
  near(moved.positions[7], [-.7, 1.3, .1]);
  assert.equal(moved.text, 'leftHand=0.70000,1.30000,0.10000 rightHand=-0.70000,1.30000,0.10000');
  moved.reset(7);
  near(moved.positions[7], [-.75, 1.4, .05]);
  moved.placed.undo();
  moved.placed.undo();
  moved.placed.undo();
  assert.equal(moved.text, '');
});

test('one drag is one step of undo', () => {
  let changes = 0;
  const history = new History(0, () => ++changes);
  history.change(1, 'a', 'drag1');
  history.change(2, 'a', 'drag1');
  history.change(3, 'b', 'drag2');
  assert.equal(history.undoLabel, 'b');
  assert.ok(history.undo() && history.value === 2);
  assert.ok(history.undo() && history.value === 0);
  assert.ok(!history.undo());
  assert.ok(history.redo() && history.redo() && history.value === 3);
  assert.equal(changes, 7);
});

test('numbers have the colors of the command line', () => {
  const source = readFileSync(join(import.meta.dirname, '../../lib/render/src/color_scale.cpp'), 'utf8');
  const table = /kTurboTable = (\{[^;]*\});/.exec(source)[1].match(/\d+, \d+, \d+/g).map((row) => row.split(', ').map(Number));
  assert.deepEqual(colors.kTurboTable, table);
  near(colors.turbo(.5), [124 / 255, 254 / 255, 91 / 255]);
});

test('differences restore a frame, and a lost one is noticed', () => {
  const size = 12, triangles = [];
  for (let y = 0; y + 1 < size; ++y) for (let x = 0; x + 1 < size; ++x) {
    const v = y * size + x;
    triangles.push(v, v + 1, v + size, v + 1, v + size + 1, v + size);
  }
  const positions = Float32Array.from({length: 3 * size * size}, (_, i) => [i / 3 % size | 0, i / 3 / size | 0, 0][i % 3] * .05);
  const box = {origin: [0, 0, 0], step: .001};
  const grid = new Int32Array(positions.length);
  delta.snapToGrid(positions, box, grid);
  const {order, starts, neighbors} = hierarchy.buildHierarchy(Uint32Array.from(triangles), grid);
  assert.deepEqual([...order].sort((a, b) => a - b), Array.from({length: size * size}, (_, v) => v));
  const place = new Map([...order].map((v, i) => [v, i]));
  for (let i = 0; i < order.length; ++i) {
    for (let e = starts[i]; e < starts[i + 1]; ++e) assert.ok(place.get(neighbors[e]) < i);
  }
  const decoder = new delta.DeltaDecoder(Uint32Array.from(triangles), positions, box);
  assert.ok(!decoder.addResiduals([new Int32Array(144), new Int32Array(144), new Int32Array(144)], 0));
  assert.ok(decoder.setKeyFrame(positions, delta.gridChecksum(grid)));
  // All residuals 0 but those of the vertices without neighbors: the surface moves as a whole.
  const residuals = [0, 1, 2].map((c) => Int32Array.from(order, (_, i) => i === 0 && c === 1 ? 7 : 0));
  const moved = grid.map((k, i) => k + (i % 3 === 1 ? 7 : 0));
  assert.ok(decoder.addResiduals(residuals, delta.gridChecksum(moved)));
  near([...decoder.positions()], [...positions].map((x, i) => x + (i % 3 === 1 ? .007 : 0)), 1e-3);
  assert.ok(!decoder.addResiduals(residuals, 1));
  assert.ok(decoder.needsKeyFrame);
});

test('polygons become fans', () => {
  assert.deepEqual([...fan(Int32Array.of(4, 3), Int32Array.of(0, 1, 2, 3, 4, 5, 6))], [0, 1, 2, 0, 2, 3, 4, 5, 6]);
});

test('a compressed sequence is asked for ahead of what is shown, and forgotten far from it', () => {
  const frames = new Array(100).fill(undefined), some = new Float32Array(3);
  assert.deepEqual(nextRange(frames, 10, 20), [10, 30]);
  frames.fill(some, 10, 30);
  assert.equal(nextRange(frames, 15, 20), null);
  assert.deepEqual(nextRange(frames, 25, 20), [30, 50]);
  assert.deepEqual(nextRange(frames, 95, 20), [95, 100]);
  forgetFar(frames, 29, 5);
  assert.deepEqual(frames.flatMap((frame, t) => frame ? [t] : []), [25, 26, 27, 28, 29]);
});
