// The beam as a mesh of rings along its axis, one per point; moved, turned and coloured at every frame.

import {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshStandardMaterial,
  SphereGeometry,
} from "three";
import { shade } from "./colours";
import type { Shape } from "./data";

type Vector = [number, number, number];

/** Corners of a section in its own y and z, anticlockwise seen from the tip. */
export function corners(width: number, thickness: number, round: boolean): [number, number][] {
  const count = round ? 16 : 4;
  return Array.from({ length: count }, (_, k) => {
    const angle = (2 * Math.PI * (k + (round ? 0 : 0.5))) / count;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    return round ? [(width / 2) * c, (width / 2) * s] : [(Math.sign(c) * width) / 2, (Math.sign(s) * thickness) / 2];
  });
}

/** Directions y and z of a section whose axis points along `t`: y stays as near as it can to that at rest. */
export function frame(t: Vector, across: Vector = [0, 1, 0]): [Vector, Vector] {
  const length = Math.hypot(...t) || 1;
  const [x, y, z] = t.map((each) => each / length) as Vector;
  // That y without its part along the axis; along z where the axis is y itself.
  const along = across[0] * x + across[1] * y + across[2] * z;
  const [a, b, c]: Vector = Math.abs(along) > 0.999 ? [0, 0, 1] : across;
  const part = a * x + b * y + c * z;
  const first: Vector = [a - part * x, b - part * y, c - part * z];
  const size = Math.hypot(...first);
  const e: Vector = [first[0] / size, first[1] / size, first[2] / size];
  return [e, [y * e[2] - z * e[1], z * e[0] - x * e[2], x * e[1] - y * e[0]]];
}

export class BeamMesh {
  readonly group = new Group();
  private readonly positions: Float32Array;
  private readonly colours: Float32Array;
  private readonly geometry = new BufferGeometry();
  private readonly around: number;
  private readonly bodies: { mesh: Mesh; at: number }[] = [];
  private readonly sections: [number, number][][];

  constructor(
    private readonly shape: Shape,
    ghost: boolean,
  ) {
    const count = shape.points.length;
    this.sections = shape.points.map((_, k) => corners(shape.width[k]!, shape.thickness[k]!, shape.round));
    this.around = this.sections[0]!.length;
    this.positions = new Float32Array(3 * count * this.around);
    this.colours = new Float32Array(this.positions.length).fill(0.6);
    const index: number[] = [];
    for (let k = 0; k + 1 < count; k++) {
      for (let j = 0; j < this.around; j++) {
        const [a, b] = [k * this.around + j, k * this.around + ((j + 1) % this.around)];
        index.push(a, b, a + this.around, b, b + this.around, a + this.around);
      }
    }
    for (let j = 1; j + 1 < this.around; j++) {
      const tip = (count - 1) * this.around;
      index.push(0, j + 1, j, tip, tip + j, tip + j + 1);
    }
    this.geometry.setIndex(index);
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("color", new BufferAttribute(this.colours, 3));
    if (ghost) {
      const lines: number[] = [];
      for (let j = 0; j < this.around; j += Math.max(1, this.around / 4)) {
        for (let k = 0; k + 1 < count; k++) lines.push(k * this.around + j, (k + 1) * this.around + j);
      }
      for (const ring of [0, count - 1]) {
        for (let j = 0; j < this.around; j++) {
          lines.push(ring * this.around + j, ring * this.around + ((j + 1) % this.around));
        }
      }
      this.geometry.setIndex(lines);
      this.group.add(new LineSegments(this.geometry, new LineBasicMaterial({ color: 0x888888 })));
    } else {
      const material = new MeshStandardMaterial({
        vertexColors: true,
        flatShading: !shape.round,
        side: DoubleSide,
        roughness: 0.6,
        metalness: 0.1,
      });
      this.group.add(new Mesh(this.geometry, material));
      this.addBodies();
    }
    this.move(null, 1, null, 1);
  }

  /** Put the beam where displacements (points × 3, m; null: at rest) times a factor take it, turn its sections by twist
   * (points, rad) times it, and colour it by shares. */
  move(
    displacement: ArrayLike<number> | null,
    factor: number,
    shares: ArrayLike<number> | null,
    grey: number,
    twist: ArrayLike<number> | null = null,
  ): void {
    const { points, rest, across } = this.shape;
    const place = (k: number): Vector => {
      const at = rest?.[k] ?? [points[k]!, 0, 0];
      return [0, 1, 2].map((i) => at[i]! + (displacement ? factor * displacement[3 * k + i]! : 0)) as Vector;
    };
    const last = points.length - 1;
    for (let k = 0; k <= last; k++) {
      const [before, here, after] = [place(Math.max(k - 1, 0)), place(k), place(Math.min(k + 1, last))];
      const along: Vector = [after[0] - before[0], after[1] - before[1], after[2] - before[2]];
      const [y, z] = frame(along, across?.[k] as Vector | undefined);
      const angle = twist ? factor * twist[k]! : 0;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      const colour = shares ? shade(shares[k]!) : ([grey, grey, grey] as const);
      for (let j = 0; j < this.around; j++) {
        const [v, w] = this.sections[k]![j]!;
        const [a, b] = [v * cos - w * sin, v * sin + w * cos];
        for (let i = 0; i < 3; i++) {
          const n = 3 * (k * this.around + j) + i;
          this.positions[n] = here[i]! + a * y[i]! + b * z[i]!;
          this.colours[n] = colour[i]! ** 2.2; // the renderer's colours are linear
        }
      }
    }
    for (const { mesh, at } of this.bodies) {
      const k = Math.max(0, Math.min(last - 1, points.findIndex((x) => x > at) - 1));
      const f = at >= points[last]! ? 1 : (at - points[k]!) / (points[k + 1]! - points[k]!);
      const [a, b] = at >= points[last]! ? [place(last), place(last)] : [place(k), place(k + 1)];
      mesh.position.set(a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2]));
    }
    this.geometry.getAttribute("position").needsUpdate = true;
    this.geometry.getAttribute("color").needsUpdate = true;
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
  }

  private addBodies(): void {
    const length = this.shape.points.at(-1)!;
    const heavy = (this.shape.bodies ?? []).filter(([, mass]) => mass > 0);
    const most = Math.max(...heavy.map(([, mass]) => mass));
    for (const [at, mass] of heavy) {
      const radius = 0.035 * length * Math.cbrt(mass / most);
      const mesh = new Mesh(new SphereGeometry(radius, 20, 14), new MeshStandardMaterial({ color: 0x777777 }));
      this.bodies.push({ mesh, at });
      this.group.add(mesh);
    }
  }
}
