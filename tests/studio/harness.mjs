// A server, a browser and takes for tests of the page.
import {execFileSync, spawn} from 'node:child_process';
import {existsSync, mkdtempSync, readdirSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';

export function skip(why) {
  console.log(`skipped: ${why}`);
  process.exit(77);
}

export function findPlaywright(packages) {
  for (const folder of [packages, ...(process.env.NODE_PATH ?? '').split(':').map((path) => path.replace(/\/node_modules$/, ''))]) {
    try {
      return createRequire(join(folder, 'x.js'))('playwright-core');
    } catch { /* the next one */ }
  }
  return skip('playwright-core is not there (./dev test brings it)');
}

export class Server {
  constructor(bin) {
    this.bin = bin;
    this.folder = mkdtempSync(join(tmpdir(), 'pleat-studio-'));
  }
  // port: of the page; 0 takes any.
  async start(port = 0) {
    this.child = spawn(join(this.bin, 'pleatd'), ['--data-dir', join(this.folder, 'data'), '--listen', '127.0.0.1:0',
      '--http', `127.0.0.1:${port}`, '--reserve-bytes', '1MB', '--job-priority', 'normal', '--log-level', 'warning']);
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
