// Builds the page into the Python package, with addresses that are relative to the page: its own address holds a token.
import { defineConfig } from "vite";

export default defineConfig({
  base: "./",
  build: {
    outDir: "../python/luxfer/studio/static",
    emptyOutDir: true,
    assetsInlineLimit: 0,
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
  },
});
