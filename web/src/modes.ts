// Mode shapes as motions: one period each, on a clock that runs round.

import type { Data, Header, Modes, Motion } from "./data";
import { view } from "./data";

const FRAMES = 48;
const AMPLITUDE = 0.15; // of the length, of the largest displacement

/** The displacement Re(shape · e^{iφ}) over some periods, as a motion of its own. */
export function shapes(modes: Modes, which: number, numbers: Float32Array, periods = 50): Data {
  const size = 3 * modes.points.length;
  const [real, imaginary] = [modes.real, modes.imaginary].map((ref) =>
    view(numbers, ref).subarray(which * size, (which + 1) * size),
  ) as [Float32Array, Float32Array];
  const count = FRAMES * periods + 1;
  const made = new Float32Array(count * (1 + size));
  const amplitude = AMPLITUDE * modes.points.at(-1)!;
  for (let k = 0; k < count; k++) {
    const phase = (2 * Math.PI * k) / FRAMES;
    made[k] = (2 * k) / FRAMES; // a period takes two seconds
    const [c, s] = [Math.cos(phase), Math.sin(phase)];
    for (let i = 0; i < size; i++) made[count + k * size + i] = amplitude * (real[i]! * c - imaginary[i]! * s);
  }
  const motion: Motion = {
    name: modes.labels[which]!,
    environment: modes.labels[which]!,
    points: modes.points,
    width: modes.width,
    thickness: modes.thickness,
    round: modes.round,
    bodies: [],
    time: { at: 0, shape: [count] },
    displacement: { at: count, shape: [count, modes.points.length, 3] },
    largest: amplitude,
    relative: true,
  };
  const header: Header = { scene: { motions: [motion], start: 0 }, plots: [], maps: [] };
  return { header, numbers: made };
}
