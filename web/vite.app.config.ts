import { defineConfig } from "vite";

// The page of `gbeam app`, committed inside the Python package as the viewer is, which it loads for a mesh.
export default defineConfig({
  publicDir: "app-public",
  build: {
    lib: { entry: "src/app/main.ts", formats: ["es"], fileName: () => "app.js", cssFileName: "app" },
    outDir: process.env.GBEAM_WEB_OUT ? `${process.env.GBEAM_WEB_OUT}-app` : "../src/gbeam/app/assets",
    emptyOutDir: true,
    minify: true,
    rolldownOptions: { external: ["gbeam"], output: { minify: true, paths: { gbeam: "./gbeam.js" } } },
    target: "es2022",
  },
});
