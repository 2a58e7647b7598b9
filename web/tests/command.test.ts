import { expect, it } from "vitest";
import { fileName, quoted } from "../src/app/command";

it("quotes words so that a shell has them back", () => {
  expect(quoted(["gbeam", "run", "scenario.toml", "--report"]).join(" ")).toBe("gbeam run scenario.toml --report");
  expect(quoted(["--over", "beam.length=1 m, 2 m"]).join(" ")).toBe("--over 'beam.length=1 m, 2 m'");
  expect(quoted(["$HOME", "tip's", ""]).join(" ")).toBe("'$HOME' 'tip'\\''s' ''");
});

it("calls a document by its language", () => {
  expect(fileName('title = "a"')).toBe("scenario.toml");
  expect(fileName('\n {"title": "a"}')).toBe("scenario.json");
});
