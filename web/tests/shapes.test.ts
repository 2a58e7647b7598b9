import { Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { BeamMesh, corners, frame } from "../src/beam";
import { along, Body, type Settings } from "../src/bodies";
import { centrifuge, hub } from "../src/carriers";
import { shade } from "../src/colours";
import { visible } from "../src/viewer";

describe("a centrifuge's pose", () => {
  // The axes of gbeam.motion.centrifuge.machine.kinematics.forward.
  const [arm, length, control] = [3.3, 2.4, 1.8]; // long enough to be drawn as large as it is
  const [t1, t2, t3] = [0.7, -1.1, 0.4];
  const machine = centrifuge(arm, [[0, 0, 0], [length, 0, 0]], [control, 0, 0]);
  machine.turn([t1, t2, t3]);
  machine.world.updateMatrixWorld(true);
  const at = (x: number, y: number, z: number): Vector3 => machine.base.localToWorld(new Vector3(x, y, z));

  it("holds the control point at the arm's end", () => {
    const point = at(control, 0, 0);
    expect(point.x).toBeCloseTo(arm * Math.cos(t1), 9);
    expect(point.y).toBeCloseTo(arm * Math.sin(t1), 9);
    expect(point.z).toBeCloseTo(0, 9);
  });

  it("turns the base axes by yaw and roll", () => {
    const origin = at(0, 0, 0);
    const [e1, e2, e3] = [at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)].map((each) => each.sub(origin));
    const yaw = t1 + t2;
    const b2 = new Vector3(-Math.sin(yaw), Math.cos(yaw), 0);
    expect(e1!.distanceTo(new Vector3(Math.cos(yaw), Math.sin(yaw), 0))).toBeLessThan(1e-9);
    const expected = b2.clone().multiplyScalar(Math.cos(t3)).add(new Vector3(0, 0, Math.sin(t3)));
    expect(e2!.distanceTo(expected)).toBeLessThan(1e-9);
    expect(e3!.distanceTo(b2.multiplyScalar(-Math.sin(t3)).add(new Vector3(0, 0, Math.cos(t3))))).toBeLessThan(1e-9);
  });

  it("holds a solid by its own point, turned", () => {
    const held = centrifuge(arm, [[-0.7, -1.2, 0], [0.5, 1.2, 0.8]], [0.2, 0.9, 0.3], [0, 0, Math.PI / 2]);
    held.turn([t1, t2, t3]);
    held.world.updateMatrixWorld(true);
    const [point, along] = [new Vector3(0.2, 0.9, 0.3), new Vector3(0.2, 0.9 - 0.5, 0.3)].map((each) => held.base.localToWorld(each));
    expect(point!.distanceTo(new Vector3(arm * Math.cos(t1), arm * Math.sin(t1), 0))).toBeLessThan(1e-9);
    // Its −y lies along the machine's x, and is as long as it is: the solid is large enough.
    expect(along!.sub(point!).distanceTo(at(0.5, 0, 0).sub(at(0, 0, 0)))).toBeLessThan(1e-9);
  });
});

it("puts a beam that points inwards on the hub's rim", () => {
  const carrier = hub(2, 5, [-1, 0, 0, 0, -1, 0, 0, 0, 1]);
  carrier.turn([Math.PI / 2]);
  carrier.world.updateMatrixWorld(true);
  const tip = carrier.base.localToWorld(new Vector3(5, 0, 0));
  expect(tip.distanceTo(new Vector3(0, -3, 0))).toBeLessThan(1e-9);
});

describe("the beam's mesh", () => {
  const shape = { points: [0, 0.5, 1], width: [0.2, 0.2, 0.2], thickness: [0.1, 0.1, 0.1], round: false };

  it("has sections of the beam's size", () => {
    expect(corners(0.2, 0.1, false).map(([y, z]) => [Math.abs(y), Math.abs(z)])).toEqual(Array(4).fill([0.1, 0.05]));
    for (const [y, z] of corners(0.2, 0.1, true)) expect(Math.hypot(y, z)).toBeCloseTo(0.1, 12);
  });

  it("follows the displacement times the factor", () => {
    const beam = new BeamMesh(shape, false);
    beam.move([0, 0, 0, 0, 0, 0.01, 0, 0, 0.02], 10, [0, 0.5, 1], 1);
    const mesh = beam.group.children[0] as unknown as { geometry: { getAttribute(name: string): { array: Float32Array } } };
    const places = mesh.geometry.getAttribute("position").array;
    const tip = [0, 1, 2].map((i) => [0, 1, 2, 3].reduce((sum, k) => sum + places[3 * (8 + k) + i]! / 4, 0));
    expect(tip[0]).toBeCloseTo(1, 5);
    expect(tip[2]).toBeCloseTo(0.2, 5);
  });

  it("lies where it is at rest, its sections turned as there", () => {
    const rest = [[0, 0, 0], [0, 1, 0], [0, 2, 0]];
    const beam = new BeamMesh({ ...shape, rest, across: Array(3).fill([0, 0, 1]) }, false);
    const mesh = beam.group.children[0] as unknown as { geometry: { getAttribute(name: string): { array: Float32Array } } };
    const places = mesh.geometry.getAttribute("position").array;
    for (let k = 8; k < 12; k++) {
      expect(places[3 * k + 1]!).toBeCloseTo(2, 6);
      expect(Math.abs(places[3 * k]!)).toBeCloseTo(0.05, 6); // the thickness, along x
      expect(Math.abs(places[3 * k + 2]!)).toBeCloseTo(0.1, 6);
    }
  });

  it("keeps sections at right angles to the axis", () => {
    const t = [0.8, 0.3, -0.5] as [number, number, number];
    const [y, z] = frame(t);
    const dot = (a: number[], b: number[]): number => a.reduce((sum, each, i) => sum + each * b[i]!, 0);
    for (const [a, b] of [[t, y], [t, z], [y, z]] as const) expect(dot(a, b)).toBeCloseTo(0, 12);
    expect(dot(y, y)).toBeCloseTo(1, 12);
    expect(dot(z, z)).toBeCloseTo(1, 12);
  });
});

it("puts a body where its root is, and farther where deflections are drawn larger", () => {
  const [c, s] = [Math.cos(0.5), Math.sin(0.5)]; // a turn of one radian about z
  const frame = [1, 2, 3, c, 0, 0, s, 0.1, 0, 0];
  const part = { box: { size: [1, 1, 1], centre: [0, 0, 0], rotation: [1, 0, 0, 0, 1, 0, 0, 0, 1] }, frame: { at: 0, shape: [1, 10] } };
  const body = new Body(part, new Float32Array(frame), 1);
  const settings = { factor: 3, ghost: true, loads: true, colouring: "none", largestDeflection: 0, largestStress: 0, largestLoad: 0 };
  body.update([0, 0], settings as Settings, false);
  body.group.updateMatrixWorld(true);
  const at = body.group.localToWorld(new Vector3(1, 0, 0));
  expect(at.distanceTo(new Vector3(1.2 + Math.cos(1), 2 + Math.sin(1), 3))).toBeLessThan(1e-6);
});

it("takes stress linearly from the sections to the points", () => {
  const out = new Float32Array(4);
  along([0, 1], [10, 20], [0, 0.25, 1, 1], out);
  expect([...out]).toEqual([10, 12.5, 20, 20]);
});

it("turns the sections by twist", () => {
  const beam = new BeamMesh({ points: [0, 2], width: [2, 2], thickness: [1, 1], round: false }, false);
  beam.move([0, 0, 0, 0, 0, 0], 1, null, 1, [0, Math.PI / 2]);
  const mesh = beam.group.children[0] as unknown as { geometry: { getAttribute(name: string): { array: Float32Array } } };
  const places = mesh.geometry.getAttribute("position").array;
  // A quarter of a turn brings the corners from (±1, ±0.5) to (∓0.5, ±1).
  for (let k = 4; k < 8; k++) expect(Math.abs(places[3 * k + 1]!)).toBeCloseTo(0.5, 6);
});

it("has a colour for every share, and for none", () => {
  expect(shade(0)).toEqual(shade(-3));
  expect(shade(1)).toEqual(shade(7));
  expect(shade(NaN)).toEqual(shade(0));
  const light = (x: number): number => shade(x).reduce((a, b) => a + b);
  for (let x = 0; x < 1; x += 0.05) expect(light(x + 0.05)).toBeGreaterThan(light(x));
});

it("chooses a factor that shows a small deflection, and none for a large one", () => {
  expect(visible(0.0023, 0.3)).toBe(10);
  expect(visible(0.1, 0.3)).toBe(1);
  expect(visible(0, 0.3)).toBe(1);
});
