// Writes three.min.js, which is part of the repository, from the versions in package-lock.json.
import { build } from 'esbuild';
import { copyFileSync, readFileSync } from 'node:fs';

const { version } = JSON.parse(readFileSync('node_modules/three/package.json', 'utf8'));
await build({
  entryPoints: ['entry.js'],
  outfile: 'three.min.js',
  bundle: true,
  minify: true,
  format: 'iife',
  globalName: 'THREE',
  target: 'es2021',
  legalComments: 'none',
  banner: { js: `/* three.js ${version}, copyright three.js authors, MIT licence: https://threejs.org/license */` },
});
copyFileSync('node_modules/three/LICENSE', 'LICENSE');
