import { expect, it } from "vitest";
import { decades, plain, sparse } from "../src/plots";

it("labels powers of ten, more where few are in sight, and never nothing", () => {
  const labels = (low: number, high: number): string[] => sparse(decades(low, high)).filter(Boolean);
  expect(labels(0.1, 10)).toEqual(["0.1", "1", "10"]);
  expect(labels(0.10002, 99.97)).toEqual(["0.1", "1", "10", "100"]);
  // As of a shock spectrum, whose ends are no round numbers.
  expect(labels(17.3, 410)).toEqual(["20", "50", "100", "200"]);
  expect(labels(0.0009, 0.0061)).toEqual(["0.001", "0.002", "0.005"]);
  expect(labels(31, 97)).toEqual(["40", "60", "80"]);
  expect(labels(1.21, 1.69)).toEqual(["1.3", "1.4", "1.5", "1.6"]);
  expect(labels(71.8, 193)).toEqual(["80", "100", "120", "140", "160", "180"]);
  expect(decades(8, 20)).toEqual([8, 9, 10, 20]);
});

it("writes the numbers of an axis in full, and zero as zero", () => {
  expect(plain([0.00172, 0.00174, 0.0017600000000000003])).toEqual(["0.00172", "0.00174", "0.00176"]);
  expect(plain([-0.2, 2.7755575615628914e-17, 0.2, null])).toEqual(["-0.2", "0", "0.2", ""]);
  expect(plain([2000, 4000])).toEqual(["2000", "4000"]);
});
