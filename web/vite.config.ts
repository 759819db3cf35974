import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';

import { svelte } from '@sveltejs/vite-plugin-svelte';
import type { Plugin } from 'vite';
import { defineConfig } from 'vitest/config';

const path = (name: string): string => fileURLToPath(new URL(name, import.meta.url));

/** Puts compressed scripts and styles beside those of the build: the station sends them as they are. */
const compress = (): Plugin => ({
  name: 'compress',
  apply: 'build',
  writeBundle({ dir }, bundle) {
    for (const name of Object.keys(bundle)) {
      if (!/\.(?:m?js|css)$/.test(name)) continue;
      const file = join(dir!, name);
      writeFileSync(`${file}.gz`, gzipSync(readFileSync(file), { level: 9 }));
    }
  },
});

export default defineConfig({
  plugins: [svelte(), compress()],
  resolve: {
    alias: { $lib: path('./src/lib'), $generated: path('./src/generated/src/index.ts') },
    // Without this vitest takes the build of Svelte for servers, where nothing is reactive.
    ...(process.env.VITEST ? { conditions: ['browser'] } : {}),
  },
  // The station is served at the root, and below any path behind a proxy.
  base: './',
  build: {
    outDir: path('../src/mavstack/server/static'),
    emptyOutDir: true,
    // For the script that adds up the size of the first load.
    manifest: true,
    target: 'es2022',
    // The station forbids inline scripts, and data URLs of modules.
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 1500,
  },
  // The station serves this folder with the policy of user scripts.
  worker: { rollupOptions: { output: { entryFileNames: 'sandbox/[name]-[hash].js' } } },
  server: {
    proxy: {
      '/api': 'http://127.0.0.1:8080',
      '/openapi.json': 'http://127.0.0.1:8080',
      '/ws': { target: 'ws://127.0.0.1:8080', ws: true },
    },
  },
  test: { include: ['src/**/*.test.ts'], environment: 'node' },
});
