import { expect, test } from "vitest";
import { bodyName, listed } from "../src/app/mesh";
import { extent, groupAt } from "../src/groups";

test("what is clamped is read as TOML has it", () => {
  expect(listed("")).toEqual([]);
  expect(listed("screwed")).toEqual(["screwed"]);
  expect(listed(`["a \\"b\\", c", 'd\\']`)).toEqual(['a "b", c', "d\\"]);
});

test("a file's name makes a body's", () => {
  expect(bodyName("bracket.msh")).toBe("bracket");
  expect(bodyName("Board, rev. 2.inp")).toBe("Board_rev_2");
  expect(bodyName("2nd.vtk")).toBe("body_2nd");
});

test("a click means the smallest group there", () => {
  const groups = [
    { name: "body", nodes: 100, vertices: [0, 1, 2, 3] },
    { name: "hole", nodes: 8, vertices: [2, 3] },
  ];
  expect(groupAt(groups, 2)).toBe("hole");
  expect(groupAt(groups, 0)).toBe("body");
  expect(groupAt(groups, 9)).toBe("");
});

test("the box around vertices", () => {
  expect(extent([0, 0, 0, 2, -1, 0, 1, 1, 5])).toEqual([2, 2, 5]);
});
