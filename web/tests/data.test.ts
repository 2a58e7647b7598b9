import { describe, expect, it } from "vitest";
import { decode, format, interpolate, locate, view } from "../src/data";

describe("numbers from Python", () => {
  it("decodes little-endian floats", () => {
    const bytes = new Uint8Array(new Float32Array([1.5, -2, Infinity]).buffer);
    const text = btoa(String.fromCharCode(...bytes));
    expect([...decode(`\n${text}\n`)]).toEqual([1.5, -2, Infinity]);
  });

  it("views an array without a copy", () => {
    const numbers = new Float32Array([0, 1, 2, 3, 4, 5]);
    const part = view(numbers, { at: 2, shape: [2, 2] });
    expect([...part]).toEqual([2, 3, 4, 5]);
    expect(part.buffer).toBe(numbers.buffer);
  });
});

describe("interpolation in time", () => {
  const time = [0, 1, 3];
  it("finds the interval, and stays at the ends beyond them", () => {
    expect(locate(time, -5)).toEqual([0, 0]);
    expect(locate(time, 2)).toEqual([1, 0.5]);
    expect(locate(time, 1)).toEqual([1, 0]);
    expect(locate(time, 99)).toEqual([1, 1]);
    expect(locate([7], 3)).toEqual([0, 0]);
  });

  it("is exact for what is linear in time", () => {
    const values = new Float32Array(time.flatMap((t) => [2 * t - 1, -t]));
    for (const t of [0, 0.25, 1, 1.7, 3]) {
      const [a, b] = interpolate(values, 2, locate(time, t), new Float32Array(2));
      expect(a).toBeCloseTo(2 * t - 1, 6);
      expect(b).toBeCloseTo(-t, 6);
    }
  });

  it("takes the only row of one", () => {
    expect([...interpolate(new Float32Array([4, 5]), 2, locate([0], 9), new Float32Array(2))]).toEqual([4, 5]);
  });
});

it("writes four significant digits, and a dash for none", () => {
  expect([0, 2.31819, 1234.5678, 1.5e-7, 123456, null, NaN].map(format)).toEqual([
    "0", "2.318", "1235", "1.500e-7", "1.235e+5", "–", "–",
  ]);
});
