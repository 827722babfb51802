// node three_figure.mjs FILE: what three.js shows of a skinned GLB or USD text, of a BVH clip or of an
// MDD cache, as text: for each key of the animation, the places of all vertices (of all corners of USD, which it
// splits) or of all joints (BVH), a line each.
import fs from 'fs';
import path from 'path';
import { createRequire } from 'module';
import { pathToFileURL } from 'url';

const require = createRequire(import.meta.url);  // unlike import, it heeds NODE_PATH
const loaders = path.dirname(require.resolve('three/examples/jsm/loaders/BVHLoader.js'));
const load = (file) => import(pathToFileURL(file));
// The module that the loaders import.
const THREE = await load(path.join(loaders, '..', '..', '..', 'build', 'three.module.js'));
globalThis.self = globalThis;

const file = process.argv[2];
let lines = [];
const add = (v) => lines.push(`${v.x} ${v.y} ${v.z}\n`);
function endKey() {
  fs.writeSync(1, lines.join(''));
  lines = [];
}

function showMesh(scene, clip) {
  const mixer = new THREE.AnimationMixer(scene);
  const times = clip.tracks[0].times;
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  let mesh = null;
  scene.traverse((object) => { if (object.isSkinnedMesh) mesh = mesh || object; });
  const point = new THREE.Vector3();
  for (const time of times) {
    mixer.setTime(time);
    scene.updateMatrixWorld(true);
    for (let v = 0; v < mesh.geometry.attributes.position.count; ++v) {
      mesh.getVertexPosition(v, point);
      add(point.applyMatrix4(mesh.matrixWorld));
    }
    endKey();
  }
}

function showBvh({ clip, skeleton }) {
  const root = new THREE.Group();
  root.add(skeleton.bones[0]);
  const mixer = new THREE.AnimationMixer(root);
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce);
  action.clampWhenFinished = true;
  action.play();
  const point = new THREE.Vector3();
  for (const time of clip.tracks[0].times) {
    mixer.setTime(time);
    root.updateMatrixWorld(true);
    for (const bone of skeleton.bones) add(point.setFromMatrixPosition(bone.matrixWorld));
    endKey();
  }
}

if (file.endsWith('.bvh')) {
  const { BVHLoader } = await load(path.join(loaders, 'BVHLoader.js'));
  showBvh(new BVHLoader().parse(fs.readFileSync(file, 'utf8')));
} else if (file.endsWith('.mdd')) {
  const { MDDLoader } = await load(path.join(loaders, 'MDDLoader.js'));
  const bytes = fs.readFileSync(file);
  const { morphTargets } = new MDDLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  for (const target of morphTargets) {
    for (let v = 0; v < target.count; ++v) add(new THREE.Vector3().fromBufferAttribute(target, v));
    endKey();
  }
} else if (file.endsWith('.usda')) {
  const { USDLoader } = await load(path.join(loaders, 'USDLoader.js'));
  const scene = new USDLoader().parse(fs.readFileSync(file, 'utf8'));
  showMesh(scene, scene.animations[0]);
} else {
  const { GLTFLoader } = await load(path.join(loaders, 'GLTFLoader.js'));
  const bytes = fs.readFileSync(file);
  const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);
  const gltf = await new GLTFLoader().parseAsync(buffer, '');
  showMesh(gltf.scene, gltf.animations[0]);
}
