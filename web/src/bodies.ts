// A body of a scene: a beam that bends, or a rigid one as the box of its mass, each where its root is.

import {
  BoxGeometry,
  BufferGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  SphereGeometry,
} from "three";
import { BeamMesh } from "./beam";
import { interpolate, locate, type Part, view } from "./data";
import { drawn, put } from "./supports";
import { SurfaceMesh } from "./surface";

export type Colouring = "deflection" | "stress" | "none";

export interface Settings {
  factor: number;
  ghost: boolean;
  loads: boolean;
  colouring: Colouring;
  /** What the darkest and the brightest colour stand for: 0 and this. */
  largestDeflection: number;
  largestStress: number;
  largestLoad: number;
}

/** Values at positions `at`, ascending, taken linearly to `points`. */
export function along(at: number[], values: ArrayLike<number>, points: number[], out: Float32Array): void {
  points.forEach((x, k) => {
    const [i, f] = locate(at, x);
    const [a, b] = [values[i]!, values[Math.min(i + 1, at.length - 1)]!];
    out[k] = a + f * (b - a);
  });
}

export class Body {
  readonly group = new Group();
  private readonly mesh: BeamMesh | null = null;
  private readonly ghost: BeamMesh | null = null;
  private readonly surface: SurfaceMesh | null = null;
  private readonly supports: Group[];
  private readonly now: Float32Array;
  private readonly shares: Float32Array;

  /** Drawn in a scene of a `size`, m. */
  constructor(
    private readonly part: Part,
    private readonly numbers: Float32Array,
    size: number,
  ) {
    const count = part.beam?.points.length ?? 0;
    [this.now, this.shares] = [new Float32Array(3 * count), new Float32Array(count)];
    if (part.beam) {
      this.mesh = new BeamMesh(part.beam, false);
      this.ghost = new BeamMesh(part.beam, true);
      this.group.add(this.mesh.group, this.ghost.group);
    }
    if (part.surface) {
      this.surface = new SurfaceMesh(part.surface, numbers);
      this.group.add(this.surface.group);
    }
    this.supports = (part.supports ?? []).map(drawn);
    for (const each of this.supports) this.group.add(each);
    if (part.box) this.group.add(box(part.box, 0.012 * size));
    if (part.points?.length) {
      const ends = part.points.flatMap((point) => [...(part.box?.centre ?? [0, 0, 0]), ...point]);
      const lines = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(ends, 3));
      this.group.add(new LineSegments(lines, new LineBasicMaterial({ color: 0x888888 })));
    }
    if (part.joint) {
      const ball = new SphereGeometry(0.016 * size, 20, 14);
      this.group.add(new Mesh(ball, new MeshStandardMaterial({ color: 0xe69f00, roughness: 0.6 })));
    }
  }

  /** The body as it is at a place among the times. */
  update(place: [number, number], settings: Settings, dark: boolean): void {
    const { part, numbers } = this;
    if (part.frame) {
      const f = interpolate(view(numbers, part.frame), 10, place, new Float32Array(10));
      const more = settings.factor - 1;
      this.group.position.set(f[0]! + more * f[7]!, f[1]! + more * f[8]!, f[2]! + more * f[9]!);
      this.group.quaternion.set(f[4]!, f[5]!, f[6]!, f[3]!).normalize();
    }
    part.supports?.forEach((support, k) => {
      const moved = interpolate(view(numbers, support.displacement), 3, place, new Float32Array(3));
      put(this.supports[k]!, support, moved.map((each) => settings.factor * each));
    });
    if (this.surface) {
      const { colouring, largestStress, largestDeflection } = settings;
      const largest = colouring === "stress" ? largestStress : largestDeflection;
      this.surface.update(place, settings.factor, colouring, largest, dark ? 0.75 : 0.55);
      this.surface.ghost.visible = settings.ghost;
    }
    const { beam } = part;
    if (!beam || !this.mesh || !this.ghost) return;
    const points = beam.points.length;
    interpolate(view(numbers, beam.displacement), this.now.length, place, this.now);
    const coloured = this.colour(settings, place);
    const twist = beam.twist && interpolate(view(numbers, beam.twist), points, place, new Float32Array(points));
    this.mesh.move(this.now, settings.factor, coloured ? this.shares : null, dark ? 0.75 : 0.55, twist);
    this.ghost.group.visible = settings.ghost;
  }

  private colour(settings: Settings, place: [number, number]): boolean {
    const { stress, points } = this.part.beam!;
    if (settings.colouring === "stress" && stress) {
      const width = stress.at.length;
      const values = interpolate(view(this.numbers, stress.values), width, place, new Float32Array(width));
      along(stress.at, values, points, this.shares);
      for (let k = 0; k < points.length; k++) this.shares[k]! /= settings.largestStress || 1;
      return true;
    }
    if (settings.colouring !== "deflection") return false;
    for (let k = 0; k < points.length; k++) {
      const size = Math.hypot(this.now[3 * k]!, this.now[3 * k + 1]!, this.now[3 * k + 2]!);
      this.shares[k] = size / (settings.largestDeflection || 1);
    }
    return true;
  }
}

/** A box, of which no side is thinner than can be seen. */
function box(of: NonNullable<Part["box"]>, least: number): Mesh {
  const [x, y, z] = of.size.map((each) => Math.max(each, least)) as [number, number, number];
  const mesh = new Mesh(new BoxGeometry(x, y, z), new MeshStandardMaterial({ color: 0x8a8f98, roughness: 0.7 }));
  const [a, b, c, d, e, f, g, h, i] = of.rotation as [number, number, number, number, number, number, number, number, number];
  const [p, q, r] = of.centre as [number, number, number];
  mesh.applyMatrix4(new Matrix4().set(a, b, c, p, d, e, f, q, g, h, i, r, 0, 0, 0, 1));
  return mesh;
}
