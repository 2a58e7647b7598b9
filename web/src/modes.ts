// Mode shapes as motions: one period each, on a clock that runs round.

import type { Beam, Data, Header, Modes, Motion } from "./data";
import { view } from "./data";

const FRAMES = 48;
const AMPLITUDE = 0.15; // of the length, of the largest displacement
const TURN = 0.6; // rad, the largest angle of a section

/** The displacement Re(shape · e^{iφ}) over some periods, as a motion of its own. */
export function shapes(modes: Modes, which: number, numbers: Float32Array, periods = 50): Data {
  const size = 3 * modes.points.length;
  const [real, imaginary] = [modes.real, modes.imaginary].map((ref) =>
    view(numbers, ref).subarray(which * size, (which + 1) * size),
  ) as [Float32Array, Float32Array];
  const points = modes.points.length;
  const turns = modes.twist?.map((ref) => view(numbers, ref).subarray(which * points, (which + 1) * points)) ?? [];
  const count = FRAMES * periods + 1;
  const made = new Float32Array(count * (1 + size + (turns.length ? points : 0)));
  const twists = count * (1 + size);
  const turned = turns.length ? turns[0]!.reduce((most, re, i) => Math.max(most, Math.hypot(re, turns[1]![i]!)), 0) : 0;
  const amplitude = Math.min(AMPLITUDE * modes.points.at(-1)!, turned ? TURN / turned : Infinity);
  for (let k = 0; k < count; k++) {
    const phase = (2 * Math.PI * k) / FRAMES;
    made[k] = (2 * k) / FRAMES; // a period takes two seconds
    const [c, s] = [Math.cos(phase), Math.sin(phase)];
    for (let i = 0; i < size; i++) made[count + k * size + i] = amplitude * (real[i]! * c - imaginary[i]! * s);
    const [re, im] = turns;
    for (let i = 0; re && im && i < points; i++) made[twists + k * points + i] = amplitude * (re[i]! * c - im[i]! * s);
  }
  const beam: Beam = {
    points: modes.points,
    width: modes.width,
    thickness: modes.thickness,
    round: modes.round,
    displacement: { at: count, shape: [count, points, 3] },
    ...(turns.length ? { twist: { at: twists, shape: [count, points] } } : {}),
  };
  const motion: Motion = {
    name: modes.labels[which]!,
    environment: modes.labels[which]!,
    parts: [{ beam }],
    length: modes.points.at(-1)!,
    time: { at: 0, shape: [count] },
    largest: amplitude,
    relative: true,
  };
  const header: Header = { scene: { motions: [motion], start: 0 }, plots: [], maps: [] };
  return { header, numbers: made };
}
