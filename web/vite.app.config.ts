import { defineConfig } from "vite";
import { COLLECTED, notices } from "./notices.ts";

// The page of `gbeam app`, committed inside the Python package as the viewer is, which it loads for a mesh.
export default defineConfig({
  publicDir: "app-public",
  plugins: [notices()], // the viewer's file has these too
  build: {
    lib: { entry: "src/app/main.ts", formats: ["es"], fileName: () => "app.js", cssFileName: "app" },
    outDir: process.env.GBEAM_WEB_OUT ? `${process.env.GBEAM_WEB_OUT}-app` : "../src/gbeam/app/assets",
    emptyOutDir: true,
    license: { fileName: COLLECTED },
    minify: true,
    rolldownOptions: { external: ["gbeam"], output: { minify: true, paths: { gbeam: "./gbeam.js" } } },
    target: "es2022",
  },
});
