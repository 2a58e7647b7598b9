import { defineConfig } from "vite";
import { COLLECTED, notices } from "./notices.ts";

// One module and one style sheet, committed inside the Python package: its users need no Node.
export default defineConfig({
  publicDir: false,
  plugins: [notices(process.env.GBEAM_WEB_OUT ? `${process.env.GBEAM_WEB_OUT}-NOTICE` : "../NOTICE")],
  build: {
    lib: { entry: "src/index.ts", formats: ["es"], fileName: () => "gbeam.js", cssFileName: "gbeam" },
    outDir: process.env.GBEAM_WEB_OUT ?? "../src/gbeam/report/page/assets",
    emptyOutDir: true,
    license: { fileName: COLLECTED },
    minify: true,
    // Of a library module Vite leaves the white space; this one is not bundled again.
    rolldownOptions: { output: { minify: true } },
    target: "es2022",
    chunkSizeWarningLimit: 800,
  },
});
