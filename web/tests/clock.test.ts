import { expect, it } from "vitest";
import { Clock } from "../src/clock";

it("plays at its speed, stops at the end and begins again", () => {
  const clock = new Clock(0, 1);
  let changes = 0;
  const stop = clock.onChange(() => changes++);
  clock.speed = 2;
  clock.play();
  clock.frame(1000);
  clock.frame(1100);
  expect(clock.time).toBeCloseTo(0.2, 12);
  clock.frame(1300);
  clock.frame(1500);
  expect(clock.time).toBe(1);
  expect(clock.playing).toBe(false);
  clock.play();
  expect(clock.time).toBe(0);
  expect(changes).toBeGreaterThan(4);
  stop();
  const before = changes;
  clock.seek(0.5);
  expect(changes).toBe(before);
});

it("does not jump after the page was hidden, and stays within its range", () => {
  const clock = new Clock(-1, 10, 2);
  clock.play();
  clock.frame(0);
  clock.frame(60_000);
  expect(clock.time).toBeCloseTo(2.25, 12);
  clock.seek(99);
  expect(clock.time).toBe(10);
  clock.seek(NaN);
  expect(clock.time).toBe(10);
  clock.seek(-99);
  expect(clock.time).toBe(-1);
});
