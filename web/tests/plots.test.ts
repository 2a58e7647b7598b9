import { expect, it } from "vitest";
import { plain, sparse } from "../src/plots";

it("labels powers of ten, and more where few are in sight", () => {
  expect(sparse(null, [0.1, 0.2, 0.5, 1, 2, 10])).toEqual(["0.1", "", "", "1", "", "10"]);
  expect(sparse(null, [20, 30, 40, 50, 60, 200, null])).toEqual(["20", "", "", "50", "", "200", ""]);
  expect(sparse(null, [0.001, 0.002, 0.003, 0.005])).toEqual(["0.001", "0.002", "", "0.005"]);
});

it("writes the numbers of an axis in full, and zero as zero", () => {
  expect(plain([0.00172, 0.00174, 0.0017600000000000003])).toEqual(["0.00172", "0.00174", "0.00176"]);
  expect(plain([-0.2, 2.7755575615628914e-17, 0.2, null])).toEqual(["-0.2", "0", "0.2", ""]);
  expect(plain([2000, 4000])).toEqual(["2000", "4000"]);
});
