import { describe, expect, it } from "vitest";
import type { Support } from "../src/data";
import { drawn, put, symbols } from "../src/supports";

const support: Support = {
  name: "500 mm",
  words: "holds z, spring y rx",
  rigid: "z",
  yielding: "y rx",
  place: [0.5, 0, 0],
  extents: [0, 0.2, 0.1],
  beyond: [false, false, false],
  size: 2,
  displacement: { at: 0, shape: [1, 3] },
};

describe("supports", () => {
  it("have one symbol for each direction that they hold", () => {
    expect(symbols(support)).toEqual([
      { kind: "pyramid", axis: [0, 0, 1] },
      { kind: "zigzag", axis: [0, 1, 0] },
      { kind: "spiral", axis: [1, 0, 0] },
    ]);
    expect(symbols({ ...support, rigid: "ry", yielding: "" })).toEqual([{ kind: "ring", axis: [0, 1, 0] }]);
  });

  it("stand below the section that they hold", () => {
    const [below, beside, around] = drawn(support).children;
    expect(below!.position.toArray()).toEqual([0, 0, -0.05]);
    expect(beside!.position.toArray()).toEqual([0, -0.1, 0]);
    expect(around!.position.toArray()).toEqual([0, 0, 0]);
  });

  it("stand on the side that is nearer", () => {
    const [below, beside] = drawn({ ...support, beyond: [false, false, true] }).children;
    expect(below!.position.z).toBeCloseTo(0.05);
    expect(beside!.position.y).toBeCloseTo(-0.1);
  });

  it("move with the place that they hold", () => {
    const group = drawn(support);
    put(group, support, [0, 0.25, -0.5]);
    expect(group.position.toArray()).toEqual([0.5, 0.25, -0.5]);
  });
});
