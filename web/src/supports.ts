// What holds a body, as symbols that move with its place: pyramids and rings where it is rigid, zigzags and spirals where it yields.

import {
  BufferGeometry,
  ConeGeometry,
  Float32BufferAttribute,
  Group,
  Line,
  LineBasicMaterial,
  Mesh,
  MeshStandardMaterial,
  type Object3D,
  TorusGeometry,
  Vector3,
} from "three";
import type { Support } from "./data";

const COLOUR = 0xe69f00; // as joints have
const TALL = 0.06; // of the body's size
const UP = new Vector3(0, 1, 0); // the axis of cones
const OUT = new Vector3(0, 0, 1); // the axis of rings

export interface Sign {
  kind: "pyramid" | "zigzag" | "ring" | "spiral";
  axis: [number, number, number];
}

/** One symbol for each direction that a support holds. */
export function symbols(support: Support): Sign[] {
  const of = (directions: string | undefined, straight: Sign["kind"], turning: Sign["kind"]): Sign[] =>
    (directions ?? "").split(" ").filter(Boolean).map((direction) => {
      const axis = [0, 0, 0] as [number, number, number];
      axis["xyz".indexOf(direction.at(-1)!)] = 1;
      return { kind: direction.length > 1 ? turning : straight, axis };
    });
  return [...of(support.rigid, "pyramid", "ring"), ...of(support.yielding, "zigzag", "spiral")];
}

/** Symbols of a support around the origin. */
export function drawn(support: Support): Group {
  const group = new Group();
  const half = new Vector3().fromArray(support.extents).divideScalar(2);
  const tall = TALL * support.size;
  for (const { kind, axis } of symbols(support)) {
    const along = new Vector3(...axis);
    const straight = kind === "pyramid" || kind === "zigzag";
    const part = shape(kind, tall, 0.5 * tall + Math.max(...half.toArray()));
    // What holds it stands on the side that is nearer, and of the middle below.
    if (straight && support.beyond[axis.indexOf(1)]) along.negate();
    part.quaternion.setFromUnitVectors(straight ? UP : OUT, along);
    if (straight) part.position.addScaledVector(along, -Math.abs(along.dot(half)));
    group.add(part);
  }
  return group;
}

/** Put the symbols of a support where a displacement, m, takes its place. */
export function put(group: Group, support: Support, displacement: ArrayLike<number>): void {
  const [x, y, z] = support.place.map((rest, i) => rest + displacement[i]!);
  group.position.set(x!, y!, z!);
}

/** A symbol whose point, or middle, is the origin. */
function shape(kind: Sign["kind"], tall: number, radius: number): Object3D {
  const solid = new MeshStandardMaterial({ color: COLOUR, roughness: 0.6 });
  if (kind === "pyramid") return new Mesh(new ConeGeometry(0.4 * tall, tall, 4).translate(0, -tall / 2, 0), solid);
  if (kind === "ring") return new Mesh(new TorusGeometry(radius, 0.06 * tall, 8, 32), solid);
  const points: number[] = [];
  if (kind === "zigzag") {
    for (let i = 0; i <= 10; i++) points.push(i % 10 ? 0.2 * tall * (i % 2 ? 1 : -1) : 0, (-tall * i) / 10, 0);
    for (const end of [-1, 1]) points.push(0.4 * tall * end, -tall, 0);
  } else {
    for (let i = 0; i <= 60; i++) {
      const [angle, r] = [(4 * Math.PI * i) / 60, radius * (0.4 + (0.6 * i) / 60)];
      points.push(r * Math.cos(angle), r * Math.sin(angle), 0);
    }
  }
  const line = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3));
  return new Line(line, new LineBasicMaterial({ color: COLOUR }));
}
