// node dracoloader.mjs FOLDER: decodes FOLDER/*.drc with three.js's DRACOLoader, as a browser would,
// and prints the lines that draco3d.js prints. Node lacks Web Workers and URLs of files: the loader's
// worker source runs in a node worker, its decoder files are read from the package.
import fs from 'fs';
import path from 'path';
import { createRequire } from 'module';
import { pathToFileURL } from 'url';
import { Worker as NodeWorker } from 'worker_threads';

const require = createRequire(import.meta.url);  // unlike import, it heeds NODE_PATH
const loaderPath = require.resolve('three/examples/jsm/loaders/DRACOLoader.js');
const libraries = path.join(path.dirname(loaderPath), '..', 'libs', 'draco');

const sources = new Map();
globalThis.Blob = class {
  constructor(parts) { this.text = parts.join(''); }
};
URL.createObjectURL = (blob) => {
  sources.set(`blob:${sources.size}`, blob.text);
  return `blob:${sources.size - 1}`;
};
URL.revokeObjectURL = () => {};
globalThis.Worker = class {
  constructor(url) {
    const prelude = `const { parentPort } = require('worker_threads');
      globalThis.self = globalThis;
      self.postMessage = (message, transfer) => parentPort.postMessage(message, transfer);
      parentPort.on('message', (data) => self.onmessage({ data }));\n`;
    this.worker = new NodeWorker(prelude + sources.get(url), { eval: true });
    this.worker.on('message', (data) => this.onmessage({ data }));
    this.worker.on('error', (error) => { throw error; });
  }
  postMessage(message, transfer) { this.worker.postMessage(message, transfer); }
  terminate() { this.worker.terminate(); }
};

const { DRACOLoader } = await import(pathToFileURL(loaderPath));
const loader = new DRACOLoader();
loader.setDecoderPath('');
loader._loadLibrary = async (url, type) => {
  const bytes = fs.readFileSync(path.join(libraries, path.basename(url)));
  return type === 'arraybuffer' ? new Uint8Array(bytes).buffer : bytes.toString();
};

const folder = process.argv[2];
for (const name of fs.readdirSync(folder).filter((n) => n.endsWith('.drc')).sort()) {
  // NAME.TYPES.drc: one letter per attribute, f for float32, i for int32.
  const types = [...name.split('.')[1]];
  const ids = Object.fromEntries(types.map((_, i) => [`a${i}`, i]));
  const arrays = Object.fromEntries(
    types.map((type, i) => [`a${i}`, type === 'f' ? 'Float32Array' : 'Int32Array']));
  const buffer = new Uint8Array(fs.readFileSync(path.join(folder, name))).buffer;
  const geometry = await new Promise((resolve, reject) =>
    loader.decodeDracoFile(buffer, resolve, ids, arrays, undefined, reject));
  let sum = 0;
  for (const key of Object.keys(ids)) {
    const { array } = geometry.getAttribute(key);
    for (let i = 0; i < array.length; ++i) sum += (i % 97 + 1) * array[i];
  }
  const index = geometry.index ? geometry.index.array : [];
  for (let i = 0; i < index.length; ++i) sum += (i % 97 + 1) * index[i];
  console.log(`${name} ${geometry.getAttribute('a0').count} ${types.length} ` +
              `${index.length / 3} ${sum.toFixed(3)}`);
}
loader.dispose();
