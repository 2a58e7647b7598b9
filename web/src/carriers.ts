// What carries the beam: the arm, yaw frame and module of a centrifuge, a hub, or base axes alone.

import {
  ArrowHelper,
  Box3,
  BoxGeometry,
  CylinderGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  EdgesGeometry,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  TorusGeometry,
  Vector3,
} from "three";

const AXES = [0xd55e00, 0x009e73, 0x0072b2] as const; // x, y, z

/** Base axes at the root: x orange, y green, z blue. */
export function triad(size: number): Group {
  const group = new Group();
  AXES.forEach((colour, i) => {
    const direction = new Vector3().setComponent(i, 1);
    group.add(new ArrowHelper(direction, new Vector3(), size, colour, 0.2 * size, 0.09 * size));
  });
  return group;
}

export interface Carrier {
  /** Fixed to the world. */
  readonly world: Group;
  /** Moves with the base: the beam goes in here, in base axes. */
  readonly base: Group;
  /** Radius of what is drawn, and its middle, m. */
  readonly size: number;
  readonly middle: [number, number, number];
  /** What is said of it below its name. */
  readonly note: string;
  /** Turn to angles, rad, of axes 1, 2, 3 or of the hub; or to a quaternion. */
  turn(angles: number[]): void;
}

function part(geometry: BoxGeometry | CylinderGeometry | TorusGeometry, colour: number): Mesh {
  return new Mesh(geometry, new MeshStandardMaterial({ color: colour, roughness: 0.7, metalness: 0.15 }));
}

/** A cylinder along z. */
function upright(radius: number, height: number, colour: number): Mesh {
  const mesh = part(new CylinderGeometry(radius, radius, height, 40), colour);
  mesh.rotation.x = Math.PI / 2;
  return mesh;
}

/** The centrifuge: the specimen is drawn larger than it is, where it would not be seen beside the arm. It reaches over an
 * extent of its axes, and is turned in those of the module by a rotation vector, its control point at the end of the arm.
 */
export function centrifuge(arm: number, extent: number[][], place: number[], turn: number[] = [0, 0, 0]): Carrier {
  const [low, high, at, axis] = [...extent, place, turn].map((each) => new Vector3(...each)) as [Vector3, Vector3, Vector3, Vector3];
  const factor = Math.max(1, (0.42 * arm) / high.distanceTo(low));
  const [world, turning, yaw, roll, base] = [new Group(), new Group(), new Group(), new Group(), new Group()];
  const post = upright(0.11 * arm, 0.5 * arm, 0x8a8f98);
  post.position.z = -0.3 * arm;
  const foot = upright(0.3 * arm, 0.03 * arm, 0x6c717a);
  foot.position.z = -0.55 * arm;
  world.add(post, foot, turning);
  // The arm ends at the yaw frame, and has a counterweight on the other side.
  const turned = new Matrix4().makeRotationAxis(axis.clone().normalize(), axis.length());
  const around = new Box3(low.sub(at), high.sub(at)).applyMatrix4(turned);
  const reach = factor * around.min.clone().negate().max(around.max).length();
  const ring = Math.min(1.08 * reach, 0.62 * arm);
  const beam = part(new BoxGeometry(1.3 * arm - ring, 0.1 * arm, 0.08 * arm), 0xa9afb9);
  beam.position.x = (arm - ring - 0.3 * arm) / 2;
  const weight = part(new BoxGeometry(0.2 * arm, 0.26 * arm, 0.2 * arm), 0x6c717a);
  weight.position.x = -0.36 * arm;
  turning.add(beam, weight, yaw);
  // The fork that carries axis 2, the frame that turns about it, and the module that rolls inside.
  const thin = 0.012 * arm;
  const fork = part(new TorusGeometry(1.04 * ring, thin, 10, 72, Math.PI), 0xa9afb9);
  // Upright, the half circle towards axis 1: its x to Z, its y to −X.
  fork.setRotationFromMatrix(new Matrix4().makeBasis(new Vector3(0, 0, 1), new Vector3(-1, 0, 0), new Vector3(0, -1, 0)));
  fork.position.x = arm;
  turning.add(fork);
  const outer = part(new TorusGeometry(ring, thin, 10, 72), 0x56b4e9);
  outer.rotation.x = Math.PI / 2; // in the plane of axis 3 and the vertical
  const module = new Group();
  const half = 0.34 * ring;
  const sides = around.getSize(new Vector3()).multiplyScalar(1.1 * factor);
  const box = new BoxGeometry(1.86 * reach, Math.max(2 * half, sides.y), Math.max(2 * half, sides.z));
  box.translate(...around.getCenter(new Vector3()).multiplyScalar(factor).toArray());
  module.add(new LineSegments(new EdgesGeometry(box), new LineBasicMaterial({ color: 0xe69f00 })));
  base.scale.setScalar(factor);
  base.quaternion.setFromRotationMatrix(turned);
  base.position.copy(at.applyMatrix4(turned).multiplyScalar(-factor));
  roll.add(module, base);
  yaw.add(outer, roll);
  yaw.position.x = arm;
  return {
    world,
    base,
    size: 1.05 * arm + 0.3 * ring,
    middle: [0, 0, -0.1 * arm],
    note: factor > 1.05 ? `specimen drawn ${factor.toPrecision(2)} times larger` : "",
    turn(angles) {
      turning.rotation.z = angles[0]!;
      yaw.rotation.z = angles[1]!;
      roll.rotation.x = angles[2]!;
    },
  };
}

/** Base axes at a place in axes that turn; `mounting` is their rotation row by row. */
function mounted(mounting: number[], [x, y, z]: number[]): Group {
  const base = new Group();
  const m = mounting;
  base.applyMatrix4(
    new Matrix4().set(m[0]!, m[1]!, m[2]!, x!, m[3]!, m[4]!, m[5]!, y!, m[6]!, m[7]!, m[8]!, z!, 0, 0, 0, 1),
  );
  return base;
}

/** A plain arm that turns about z and ends below the root of a beam, at `place`, with a counterweight on the other side;
 * `mounting` is R_HB row by row. */
export function plainArm(place: number[], length: number, mounting: number[]): Carrier {
  const [world, turning, base] = [new Group(), new Group(), mounted(mounting, place)];
  const [x, y, z] = place as [number, number, number];
  const reach = Math.max(Math.hypot(x, y), 0.1 * length);
  const thick = Math.min(0.06 * reach, 0.3 * length);
  const post = upright(thick, 0.3 * reach, 0x8a8f98);
  post.position.z = -0.15 * reach;
  const foot = upright(3 * thick, 0.02 * reach, 0x6c717a);
  foot.position.z = -0.3 * reach;
  const beam = part(new BoxGeometry(1.3 * reach, thick, thick), 0xa9afb9);
  beam.position.x = 0.35 * reach;
  const weight = part(new BoxGeometry(2.5 * thick, 3 * thick, 2.5 * thick), 0x6c717a);
  weight.position.x = -0.3 * reach;
  const along = new Group();
  along.rotation.z = Math.atan2(y, x);
  along.add(beam, weight);
  if (z) {
    const column = part(new BoxGeometry(0.7 * thick, 0.7 * thick, Math.abs(z)), 0xa9afb9);
    column.position.set(x, y, z / 2);
    turning.add(column);
  }
  turning.add(along, base);
  world.add(post, foot, turning);
  return {
    world,
    base,
    size: 1.08 * (reach + length),
    middle: [0, 0, 0],
    note: "",
    turn: (angles) => {
      turning.rotation.z = angles[0]!;
    },
  };
}

/** A hub that turns about z, the beam on its rim; `mounting` is R_HB row by row. */
export function hub(radius: number, length: number, mounting: number[]): Carrier {
  const [world, turning, base] = [new Group(), new Group(), mounted(mounting, [radius, 0, 0])];
  const size = Math.max(radius, 0.03 * length);
  const disc = upright(size, 0.25 * size + 0.01 * length, 0x8a8f98);
  const mark = part(new BoxGeometry(0.8 * size, 0.08 * size, 0.27 * size + 0.012 * length), 0xe69f00);
  mark.position.x = 0.5 * size;
  turning.add(disc, mark, base);
  world.add(turning);
  return {
    world,
    base,
    size: Math.max(radius + mounting[0]! * length, radius) * 1.08,
    middle: [0, 0, 0],
    note: "",
    turn: (angles) => {
      turning.rotation.z = angles[0]!;
    },
  };
}

/** Axes that turn in flight: those of the first time stay, faint. */
export function flying(length: number): Carrier {
  const [world, base] = [new Group(), new Group()];
  const first = triad(0.5 * length);
  for (const each of first.children) {
    const { line, cone } = each as ArrowHelper;
    for (const { material } of [line, cone]) Object.assign(material, { transparent: true, opacity: 0.35 });
  }
  base.add(triad(0.22 * length));
  world.add(first, base);
  return {
    world,
    base,
    size: 1.05 * length,
    middle: [0, 0, 0],
    note: "turned by the rates given; attitude at the start, heading too, not known",
    turn: ([w, x, y, z]) => {
      base.quaternion.set(x!, y!, z!, w!).normalize();
    },
  };
}

/** The base's own axes: what somebody sees who moves with it. */
export function axesOnly(length: number, note = ""): Carrier {
  const [world, base] = [new Group(), new Group()];
  world.add(base, triad(0.22 * length));
  const clamp = part(new BoxGeometry(0.03 * length, 0.14 * length, 0.14 * length), 0x8a8f98);
  clamp.position.x = -0.015 * length;
  world.add(clamp);
  return { world, base, size: 0.6 * length, middle: [0.5 * length, 0, 0.11 * length], note, turn: () => undefined };
}

/** The axes in which several bodies move. */
export function surroundings(size: number, middle: number[], length: number): Carrier {
  const [world, base] = [new Group(), new Group()];
  world.add(base, triad(Math.min(0.22 * length, 0.3 * size)));
  return { world, base, size, middle: [middle[0]!, middle[1]!, middle[2]!], note: "", turn: () => undefined };
}
