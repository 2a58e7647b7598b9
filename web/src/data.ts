// What Python hands over: a header in JSON, and all numbers in one Float32Array that the header points into.

/** Where an array lies among the numbers: first element, and shape. */
export interface Ref {
  at: number;
  shape: number[];
}

/** What holds a body at a place, in axes of its root: directions x, y, z, rx, ry, rz, with spaces between. */
export interface Support {
  name: string;
  words: string;
  rigid?: string;
  yielding?: string;
  place: number[];
  /** Of a beam's section there, m; 0 of other bodies. */
  extents: number[];
  /** Along x, y and z, whether it is beyond the body's middle. */
  beyond: boolean[];
  /** Of the body, m. */
  size: number;
  /** Of the place over time, (t, 3). */
  displacement: Ref;
}

export interface Shape {
  points: number[];
  width: number[];
  thickness: number[];
  round: boolean;
  bodies?: [number, number][];
  /** Places of the points at rest and directions of the sections' y, of a beam that is not straight along x. */
  rest?: number[][];
  across?: number[][];
}

export interface Stress {
  at: number[];
  values: Ref;
  largest: number;
}

/** A beam in axes of its root. */
export interface Beam extends Shape {
  displacement: Ref;
  /** Angles of the sections about the beam's axis. */
  twist?: Ref;
  stress?: Stress;
}

/** The surface of a solid: vertices (v, 3), triangles (f, 3), and shapes (s, v, 3) of displacement and (s, v, 6) of stress
 * xx, yy, zz, yz, xz, xy, whose sizes (t, s) change over time. */
export interface Surface {
  vertices: Ref;
  triangles: Ref;
  shapes: Ref;
  stress: Ref;
  sizes: Ref;
  /** Stress that is judged; whether it is more at vertices that are not, where it has no limit. */
  largest: number;
  beyond?: boolean;
}

/** A body: a beam, or the box of a rigid body and the places of its points, in axes of its root. */
export interface Part {
  beam?: Beam;
  surface?: Surface;
  /** Size, centre, and rotation row by row. */
  box?: { size: number[]; centre: number[]; rotation: number[] };
  points?: number[][];
  supports?: Support[];
  /** Whether the joint that holds it moves, and is drawn. */
  joint?: boolean;
  /** Of the root over time: place, quaternion w, x, y, z, and how far it is carried by the deflection of beams that hold
   * it; base axes. */
  frame?: Ref;
}

/** Bodies in motion in one environment, or a mode's shape; SI, base axes B. */
export interface Motion {
  name: string;
  environment: string;
  parts: Part[];
  /** Of the longest beam; of bodies without one how far they reach. */
  length: number;
  time: Ref;
  largest: number;
  /** Middle of what is shown, (1, 3) or over time, and its radius, where it is not one straight beam on a base. */
  middle?: Ref;
  radiusShown?: number;
  /** Whether it is a mode's shape, whose size means nothing. */
  relative?: boolean;
  /** s, after which it begins again. */
  period?: number;
  /** Of a specimen on a machine: the point at the end of the arm, the least and the largest coordinates of the specimen,
   * and the rotation vector of its axes in those of the module. */
  controlPlace?: number[];
  extent?: number[][];
  turn?: number[];
  load?: Ref;
  reference?: Ref;
  largestLoad?: number;
  span?: [number, number];
  arm?: number;
  axes?: Ref;
  radius?: number;
  /** Of the root, in axes of a plain arm. */
  place?: number[];
  mounting?: number[];
  angle?: Ref;
  /** Quaternions w, x, y, z of base axes that turn in flight. */
  attitude?: Ref;
}

/** Mode shapes, each as a motion of one period. */
export interface Modes {
  labels: string[];
  motions: Motion[];
}

export interface Series {
  label: string;
  x: Ref;
  y: Ref;
  colour: number;
  dash?: boolean;
  points?: boolean;
  /** Symbols of supports. */
  supports?: boolean;
  /** Of a flight that others are compared with, and drawn above. */
  broad?: boolean;
}

export interface Level {
  label: string;
  value: number;
}

export interface Plot {
  id: string;
  title: string;
  x: string;
  y: string;
  time: boolean;
  logX?: boolean;
  logY?: boolean;
  series: Series[];
  bands?: [number, number][];
  levels?: Level[];
}

export interface HeatMap {
  id: string;
  title: string;
  x: { label: string; ticks: string[] };
  y: { label: string; ticks: string[] };
  unit: string;
  values: Ref;
  outcomes: string[];
}

export interface Header {
  scene?: { motions: Motion[]; start: number };
  modes?: Modes;
  plots: Plot[];
  maps: HeatMap[];
}

export interface Data {
  header: Header;
  numbers: Float32Array;
}

/** The elements of an array, without a copy. */
export function view(numbers: Float32Array, ref: Ref): Float32Array {
  return numbers.subarray(ref.at, ref.at + ref.shape.reduce((a, b) => a * b, 1));
}

/** Base64 of little-endian 32-bit floats. */
export function decode(text: string): Float32Array {
  const bytes = atob(text.trim());
  const packed = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; i++) packed[i] = bytes.charCodeAt(i);
  return new Float32Array(packed.buffer);
}

/** The interval that holds a time, and the fraction of it; the ends beyond them. */
export function locate(time: ArrayLike<number>, t: number): [number, number] {
  const last = time.length - 1;
  if (last < 1 || t <= time[0]!) return [0, 0];
  if (t >= time[last]!) return [last - 1, 1];
  let low = 0;
  let high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (time[middle]! <= t) low = middle;
    else high = middle;
  }
  return [low, (t - time[low]!) / (time[low + 1]! - time[low]!)];
}

/** Row `t` of values (rows, width) by linear interpolation between `[row, fraction]`, into `out`. */
export function interpolate(
  values: Float32Array,
  width: number,
  [row, fraction]: [number, number],
  out: Float32Array,
): Float32Array {
  const a = row * width;
  const b = Math.min(a + width, values.length - width);
  for (let i = 0; i < width; i++) out[i] = values[a + i]! + fraction * (values[b + i]! - values[a + i]!);
  return out;
}

/** A number with four significant digits; a dash where there is none. */
export function format(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-4 ? value.toExponential(3) : value.toPrecision(4);
}
