import { expect, it } from "vitest";
import { sparse } from "../src/plots";

it("labels powers of ten, and more where few are in sight", () => {
  expect(sparse(null, [0.1, 0.2, 0.5, 1, 2, 10])).toEqual(["0.1", "", "", "1", "", "10"]);
  expect(sparse(null, [20, 30, 40, 50, 60, 200, null])).toEqual(["20", "", "", "50", "", "200", ""]);
  expect(sparse(null, [0.001, 0.002, 0.003, 0.005])).toEqual(["0.001", "0.002", "", "0.005"]);
});
