import { expect, it } from "vitest";
import type { Entry } from "../src/app/api";
import { flightsOf, lacking, ratesAlong, written } from "../src/app/record";

it("says what a record lacks, first of all a column", () => {
  const chosen: Record<string, string> = { file: "a.csv" };
  expect(lacking(chosen)).toContain("time");
  Object.assign(chosen, { time: "t", x: "0", y: "0" });
  expect(lacking(chosen)).toContain("x, y or z");
  chosen["z"] = "-n_z";
  expect(lacking(chosen)).toContain("unit of x");
  chosen["unit"] = "g";
  expect(lacking(chosen)).toBe("");
  chosen["p"] = "p_rad_s";
  expect(lacking(chosen)).toContain("unit of p");
});

it("writes rates together or not at all, and nothing that is left out", () => {
  const chosen = { file: "a.csv", time: "t", time_unit: "", z: "z", unit: "g", p: "0", q: "0", rate_unit: "rad/s", cutoff: "5 Hz" };
  expect(written(chosen)).toEqual({ file: "a.csv", time: "t", x: "0", y: "0", z: "z", unit: "g" });
  expect(written({ ...chosen, sample_rate: "100 Hz", time_unit: "ms", vehicle: "other" })).toEqual({
    file: "a.csv", sample_rate: "100 Hz", x: "0", y: "0", z: "z", unit: "g", vehicle: "other",
  });
  expect(written({ ...chosen, p: "roll" })).toMatchObject({ p: "roll", q: "0", r: "0", rate_unit: "rad/s" });
});

it("turns rates about the axes that the loads are chosen along", () => {
  const suggested = { time: "t", x: "nx", y: "ny", z: "nz", p: "p", q: "q", r: "r" };
  expect(ratesAlong({ x: "nx", y: "ny", z: "nz" }, suggested)).toEqual({ p: "p", q: "q", r: "r" });
  expect(ratesAlong({ x: "nx", y: "-ny", z: "-nz" }, suggested)).toEqual({ p: "p", q: "-q", r: "-r" });
  expect(ratesAlong({ x: "-nz", y: "-ny", z: "-nx" }, suggested)).toEqual({ p: "-r", q: "-q", r: "-p" });
  expect(ratesAlong({ x: "ny", y: "nz", z: "nx" }, suggested)).toEqual({ p: "q", q: "r", r: "p" });
  expect(ratesAlong({ x: "nx", y: "-ny", z: "nz" }, suggested)).toEqual({}); // mirrored
  expect(ratesAlong({ x: "nx", y: "ny", z: "ny" }, suggested)).toEqual({});
  expect(ratesAlong({ x: "nx", y: "-ny", z: "0" }, suggested)).toEqual({});
  expect(ratesAlong({ x: "nx", y: "-ny", z: "-nz" }, { ...suggested, r: "" })).toEqual({});
});

it("finds the flights of a form, with their records", () => {
  const entry = (key: string, more: Partial<Entry>): Entry =>
    ({ path: key, key, help: "", required: false, written: true, kind: "table", options: [], ...more });
  const file = entry("file", { kind: "value", value: "a.csv" });
  const record = entry("record", { inside: [file, entry("cutoff", { kind: "value", written: false })] });
  const motions = [
    entry("flown", { choice: "flight", inside: [record] }),
    entry("made", { choice: "flight", inside: [entry("record", { written: false, inside: [] })] }),
    entry("spin", { choice: "centrifuge", inside: [] }),
  ];
  expect(flightsOf([entry("motion", { kind: "named", inside: motions })])).toEqual([
    { name: "flown", record: { file: "a.csv" } },
    { name: "made", record: null },
  ]);
});
