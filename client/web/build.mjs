// Type-checks and bundles the page. Runs in a folder with src, static and node_modules
// (build_page.py copies them there).
import {execFileSync} from 'node:child_process';
import {copyFileSync, cpSync, mkdirSync, rmSync} from 'node:fs';
import {parseArgs} from 'node:util';
import * as esbuild from 'esbuild';

const {values} = parseArgs({options: {
  protoc: {type: 'string'}, protos: {type: 'string'}, out: {type: 'string'},
}});

// The messages of live sessions, as TypeScript.
rmSync('src/generated', {recursive: true, force: true});
mkdirSync('src/generated', {recursive: true});
execFileSync(values.protoc, [
  `--plugin=protoc-gen-es=${process.cwd()}/node_modules/.bin/protoc-gen-es`,
  `--proto_path=${values.protos}`, '--es_out=src/generated',
  '--es_opt=target=ts,import_extension=none', 'pleat/v1/common.proto', 'pleat/v1/pose_service.proto',
], {stdio: 'inherit'});

execFileSync(process.execPath, ['node_modules/typescript/bin/tsc', '--noEmit', '-p', 'tsconfig.json'],
             {stdio: 'inherit'});

// Draco's loader looks for files only under node; the page gives it the bytes.
const withoutNode = {
  name: 'without-node',
  setup(build) {
    build.onResolve({filter: /^(node:)?(fs|path)$/}, (args) => ({path: args.path, namespace: 'none'}));
    build.onLoad({filter: /.*/, namespace: 'none'}, () => ({contents: 'module.exports = {}'}));
  },
};
await esbuild.build({
  entryPoints: {studio: 'src/main.ts', worker: 'src/worker/main.ts'},
  bundle: true, minify: true, format: 'esm', target: ['es2022'], outdir: values.out,
  legalComments: 'linked', plugins: [withoutNode], logLevel: 'warning',
});
cpSync('static', values.out, {recursive: true});
copyFileSync('node_modules/draco3d/draco_decoder.wasm', `${values.out}/draco_decoder.wasm`);
