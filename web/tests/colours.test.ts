import { describe, expect, it } from "vitest";
import { inkOn, luminance, shade } from "../src/colours";

describe("text on a map", () => {
  it("is read on every colour: 4.5 to 1 at least", () => {
    for (let share = 0; share <= 1; share += 0.01) {
      const ground = luminance(shade(share));
      const ink = inkOn(shade(share)) === "#000" ? 0 : 1;
      const [low, high] = [Math.min(ground, ink), Math.max(ground, ink)];
      expect((high + 0.05) / (low + 0.05)).toBeGreaterThan(4.5);
    }
  });
});
