import { expect, it } from "vitest";
import { SurfaceMesh, summed, vonMises } from "../src/surface";

it("sums shapes with their sizes", () => {
  expect([...summed(new Float32Array([1, 2, 10, 20]), [3, 0.5], new Float32Array(2))]).toEqual([8, 16]);
});

it("takes von Mises stress of a pull, of shear, and none of a pressure", () => {
  expect(vonMises([5, 0, 0, 0, 0, 0], 0)).toBeCloseTo(5, 6);
  expect(vonMises([0, 0, 0, 0, 0, 2], 0)).toBeCloseTo(2 * Math.sqrt(3), 6);
  expect(vonMises([7, 7, 7, 0, 0, 0], 0)).toBeCloseTo(0, 6);
});

it("moves and colours a triangle between two times", () => {
  const at = (first: number, ...shape: number[]) => ({ at: first, shape });
  const numbers = new Float32Array([
    ...[0, 0, 0, 1, 0, 0, 0, 1, 0], // vertices
    ...[0, 1, 2], // triangle
    ...[0, 0, 0, 0, 0, 1, 0, 0, 2], // one shape
    ...[0, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 10, 0, 0, 0, 0, 0], // its stress
    ...[0, 1], // its sizes
  ]);
  const surface = {
    vertices: at(0, 3, 3), triangles: at(9, 1, 3), shapes: at(12, 1, 3, 3), stress: at(21, 1, 3, 6), sizes: at(39, 2, 1),
    largest: 10,
  };
  const mesh = new SurfaceMesh(surface, numbers);
  mesh.update([0, 0.5], 10, "stress", 10, 0.5);
  const made = mesh.group.children[0] as unknown as { geometry: { getAttribute(name: string): { array: Float32Array } } };
  expect([...made.geometry.getAttribute("position").array]).toEqual([0, 0, 0, 1, 0, 5, 0, 1, 10]);
  const colours = made.geometry.getAttribute("color").array;
  expect(colours[6]! + colours[7]! + colours[8]!).toBeGreaterThan(colours[3]! + colours[4]! + colours[5]!);
});
