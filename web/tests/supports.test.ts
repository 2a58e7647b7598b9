import { describe, expect, it } from "vitest";
import type { Shape } from "../src/data";
import { drawn, symbols } from "../src/supports";

const support = { at: 0.5, words: "holds z, spring y rx", rigid: "z", yielding: "y rx" };

describe("supports", () => {
  it("have one symbol for each direction that they hold", () => {
    expect(symbols(support)).toEqual([
      { kind: "pyramid", axis: [0, 0, 1] },
      { kind: "zigzag", axis: [0, 1, 0] },
      { kind: "spiral", axis: [1, 0, 0] },
    ]);
    expect(symbols({ at: 0, words: "holds ry", rigid: "ry" })).toEqual([{ kind: "ring", axis: [0, 1, 0] }]);
  });

  it("stand below the section that they hold, where it is at rest", () => {
    const beam: Shape = { points: [0, 1, 2], width: [0.2, 0.2, 0.2], thickness: [0.1, 0.1, 0.1], round: false };
    const [below, beside, around] = drawn({ ...beam, supports: [support] }).children;
    expect(below!.position.toArray()).toEqual([0.5, 0, -0.05]);
    expect(beside!.position.toArray()).toEqual([0.5, -0.1, 0]);
    expect(around!.position.toArray()).toEqual([0.5, 0, 0]);
    expect(drawn(beam).children).toEqual([]);
  });
});
