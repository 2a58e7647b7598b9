// Plots that zoom: all over time share their range and the viewer's clock.

import uPlot from "uplot";
import type { Clock } from "./clock";
import { lineColour, prefersDark } from "./colours";
import { element } from "./controls";
import { type Data, format, type Plot, view } from "./data";

type Range = [number, number] | null;

/** How many dots of a plot on paper stand for one of the screen's. */
const PAPER = 3;

/** What all plots over time show at once. */
class Common {
  range: Range = null;
  readonly plots: uPlot[] = [];
  private busy = false;

  zoom(from: uPlot, range: Range): void {
    if (this.busy) return;
    this.busy = true;
    this.range = range;
    for (const plot of this.plots) {
      if (plot === from) continue;
      const x = plot.data[0];
      plot.setScale("x", range ? { min: range[0], max: range[1] } : { min: x[0]!, max: x[x.length - 1]! });
    }
    this.busy = false;
  }
}

export class Plots {
  private readonly common = new Common();
  private made: { plot: uPlot; spec: Plot; root: HTMLElement }[] = [];

  constructor(
    private readonly data: Data,
    private readonly clock: Clock | null,
  ) {
    clock?.onChange(() => {
      for (const { plot, spec } of this.made) if (spec.time) this.mark(plot);
    });
    const redo = (): void => this.again();
    window.addEventListener("gbeam-theme", redo);
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redo);
    new ResizeObserver(() => {
      for (const { plot, root } of this.made) plot.setSize(size(root));
    }).observe(document.body);
  }

  /** Draw one plot into an element. */
  add(root: HTMLElement, spec: Plot): void {
    const plot = new uPlot(this.options(root, spec), table(this.data, spec), root);
    plot.root.setAttribute("role", "img");
    plot.root.setAttribute("aria-label", `${spec.title}: ${spec.y} over ${spec.x}`);
    if (spec.time) this.common.plots.push(plot);
    this.made.push({ plot, spec, root });
  }

  /** Put a picture beside each plot, which paper shows in its place: whole, in ink, as wide as its column. */
  toPaper(): void {
    for (const { spec, root } of this.made) {
      root.querySelector(".gbeam-paper")?.remove();
      const alone = root.closest(".gbeam-plots")?.querySelectorAll("figure").length === 1;
      const [width, height] = alone ? [680, 260] : [327, 180];
      const drawing = new uPlot(
        { ...this.options(root, spec, PAPER), width: PAPER * width, height: PAPER * height, legend: { show: false } },
        table(this.data, spec),
        element("div"),
      );
      drawing.batch(() => {}); // drawn now: before a page is printed there is no other frame
      const picture = element("img", "gbeam-paper");
      picture.src = drawing.ctx.canvas.toDataURL();
      picture.alt = `${spec.title}: ${spec.y} over ${spec.x}`;
      root.prepend(picture);
      drawing.destroy();
    }
  }

  /** Show the clock's time as a line above the plot: to draw the plot again takes as long as all the rest. */
  private mark(plot: uPlot): void {
    const line = plot.over.querySelector<HTMLElement>(".gbeam-now");
    if (!line || !this.clock) return;
    const x = plot.valToPos(this.clock.time, "x");
    line.hidden = x < 0 || x > plot.over.clientWidth;
    line.style.transform = `translateX(${x}px)`;
  }

  /** All of them once more, in the colours of the present theme. */
  private again(): void {
    const before = this.made;
    this.made = [];
    this.common.plots.length = 0;
    for (const { plot, spec, root } of before) {
      plot.destroy();
      this.add(root, spec);
    }
  }

  /** As it is drawn on the screen, or on paper, larger and by itself. */
  private options(root: HTMLElement, spec: Plot, scale = 1): uPlot.Options {
    const screen = scale === 1;
    const dark = screen && prefersDark();
    const axis = axisStyle(dark, scale);
    const clock = screen && spec.time ? this.clock : null;
    return {
      ...size(root),
      scales: {
        // Logarithmic ones would go on to the next power of ten.
        x: { time: false, distr: spec.logX ? 3 : 1, ...(spec.logX ? { range: (_, low, high) => [low, high] } : {}) },
        y: { distr: spec.logY ? 3 : 1, range: (_, low, high) => range(low, high, spec) },
      },
      axes: [
        { ...axis, label: spec.x, size: 34 * scale, ...(spec.logX ? LOGARITHMIC : {}) },
        { ...axis, label: spec.y, size: (screen ? 62 : 46) * scale, ...(spec.logY ? LOGARITHMIC : {}) },
      ],
      cursor: {
        show: screen,
        ...(screen && spec.time ? { sync: { key: "gbeam-time" } } : {}),
        drag: spec.time ? { x: true, y: false } : { x: true, y: true, uni: 30 },
        points: { size: 6 },
      },
      legend: { live: true },
      series: [
        { label: spec.x, value: (_, x) => format(x) },
        ...spec.series.map((each) => ({
          label: each.label,
          stroke: lineColour(each.colour, dark),
          width: each.points || each.supports ? 0 : (each.broad ? 4 : screen ? 1.4 : 1.1) * scale,
          ...(each.dash ? { dash: [6 * scale, 4 * scale] } : {}),
          points: { show: each.points === true, size: 5 * scale, fill: lineColour(each.colour, dark) },
          spanGaps: true,
          value: (_: uPlot, y: number | null) => format(y),
        })),
      ],
      hooks: {
        drawClear: [(plot) => bands(plot, spec, dark)],
        draw: [
          (plot) => levels(plot, spec, ink(dark), scale),
          (plot) => supports(plot, spec, ink(dark), scale),
          (plot) => clock && this.mark(plot),
        ],
        setScale: [
          (plot, key) => {
            if (key !== "x" || !spec.time || !screen) return;
            const { min, max } = plot.scales["x"]!;
            const x = plot.data[0];
            const whole = min === x[0] && max === x[x.length - 1];
            if (min !== undefined && max !== undefined) this.common.zoom(plot, whole ? null : [min, max]);
          },
        ],
        ready: [
          (plot) => {
            if (!clock) return;
            plot.over.append(element("div", "gbeam-now"));
            // A click without a drag takes the clock there.
            let from = 0;
            plot.over.addEventListener("mousedown", (e) => (from = e.clientX));
            plot.over.addEventListener("click", (e) => {
              if (Math.abs(e.clientX - from) < 3) clock.seek(plot.posToVal(e.offsetX, "x"));
            });
          },
        ],
      },
    };
  }
}

function size(root: HTMLElement): { width: number; height: number } {
  return { width: Math.max(240, root.clientWidth), height: 230 };
}

function ink(dark: boolean): string {
  return dark ? "#d7dbe2" : "#2c3138";
}

/** How an axis looks, and its numbers: uPlot's own have three decimals at most. */
export function axisStyle(dark: boolean, scale = 1): uPlot.Axis {
  const grid = { stroke: dark ? "#333a44" : "#e3e5e9", width: scale };
  const font = `${(scale === 1 ? 12 : 9) * scale}px system-ui, sans-serif`;
  return {
    stroke: ink(dark),
    grid,
    ticks: { ...grid, size: 10 * scale },
    gap: 5 * scale,
    space: (_, axis) => (axis === 0 ? 40 : 30) * scale,
    font,
    labelFont: font,
    labelSize: 20 * scale,
    values: (_, splits) => plain(splits),
  };
}

/** Numbers of an axis without the rounding of their sums. */
export function plain(splits: (number | null)[]): string[] {
  const largest = Math.max(...splits.map((x) => Math.abs(x ?? 0)));
  return splits.map((x) => (x === null ? "" : Math.abs(x) < 1e-9 * largest ? "0" : String(+x.toPrecision(8))));
}

/** The first digits that are labelled on logarithmic axes where few powers of ten are in sight. */
const FEW = [1, 2, 5];

function firstDigit(x: number): number {
  return +(x / 10 ** Math.floor(Math.log10(x) + 1e-9)).toPrecision(6);
}

/** Where a logarithmic axis has lines: at 1 to 9 times the powers of ten; at even steps where too few of these are in sight. */
export function decades(low: number, high: number): number[] {
  // An end may be a little off its round number: the first frequency of a spectrum, 0.10002 Hz.
  const [from, to] = [low * (1 - 1e-3), high * (1 + 1e-3)];
  const steps = (first: number, last: number, step: number): number[] =>
    Array.from({ length: Math.max(last - first + 1, 0) }, (_, i) => +((first + i) * step).toPrecision(8));
  const powers = steps(Math.floor(Math.log10(from)), Math.floor(Math.log10(to)), 1);
  const seen = powers.flatMap((power) => steps(1, 9, 10 ** power)).filter((x) => x >= from && x <= to);
  if (seen.filter((x) => FEW.includes(firstDigit(x))).length > 1) return seen;
  const power = 10 ** Math.floor(Math.log10((high - low) / 3));
  const step = power * ([5, 2].find((each) => high - low >= 3 * each * power) ?? 1);
  return steps(Math.ceil(low / step), Math.floor(high / step), step);
}

/** Of a logarithmic axis's lines those with numbers: powers of ten; where few are in sight twice and five times those, or all. */
export function sparse(splits: number[]): string[] {
  const among = (shown: number[]): boolean[] => splits.map((x) => shown.includes(firstDigit(x)));
  const marked = [[1], FEW].map(among).find((each) => each.filter(Boolean).length > 1);
  return splits.map((x, i) => (!marked || marked[i] ? String(+x.toPrecision(6)) : ""));
}

/** How uPlot divides a logarithmic axis: its own lines begin at the end of the axis, which is no round number. */
const LOGARITHMIC: Partial<uPlot.Axis> = {
  splits: (_, __, low, high) => decades(low, high),
  filter: (_, splits) => splits,
  values: (_, splits) => sparse(splits),
};

/** From the least to the largest with some air, and with zero where that is near; levels are in it if they are near. */
function range(low: number, high: number, spec: Plot): [number, number] {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
  if (spec.logY) return [low / 1.3, high * 1.3];
  for (const { value } of spec.levels ?? []) if (value <= 3 * high || high <= 0) high = Math.max(high, value);
  if (low > 0 && low < 0.5 * high) low = 0;
  const air = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low === 0 ? 0 : low - air, high + air];
}

/** One table of all lines over one column of x, as uPlot needs it. */
function table(data: Data, spec: Plot): uPlot.AlignedData {
  const lines = spec.series.map((each) => {
    const y = Array.from(view(data.numbers, each.y), (value) => (Number.isFinite(value) ? value : null));
    return [Array.from(view(data.numbers, each.x)), y] as uPlot.AlignedData;
  });
  return lines.length > 1 ? uPlot.join(lines) : lines[0]!;
}

function bands(plot: uPlot, spec: Plot, dark: boolean): void {
  const { left, top, width, height } = plot.bbox;
  plot.ctx.save();
  plot.ctx.fillStyle = dark ? "#2a2f38" : "#ececef";
  for (const [start, end] of spec.bands ?? []) {
    const [a, b] = [start, end].map((x) => Math.min(Math.max(plot.valToPos(x, "x", true), left), left + width));
    plot.ctx.fillRect(a!, top, Math.max(b! - a!, 1), height);
  }
  plot.ctx.restore();
}

function levels(plot: uPlot, spec: Plot, ink: string, scale: number): void {
  const { left, top, width, height } = plot.bbox;
  const { ctx } = plot;
  ctx.save();
  ctx.strokeStyle = ink;
  ctx.fillStyle = ink;
  const dots = devicePixelRatio * scale;
  ctx.lineWidth = dots;
  ctx.font = `${(scale === 1 ? 11 : 9) * dots}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "bottom";
  ctx.setLineDash([8 * dots, 4 * dots]);
  for (const { label, value } of spec.levels ?? []) {
    const y = plot.valToPos(value, "y", true);
    if (y < top || y > top + height) continue;
    ctx.beginPath();
    ctx.moveTo(left, y);
    ctx.lineTo(left + width, y);
    ctx.stroke();
    ctx.fillText(label, left + 4 * dots, y - 2 * dots);
  }
  ctx.restore();
}

/** Triangles that point to where a beam is held. */
function supports(plot: uPlot, spec: Plot, ink: string, scale: number): void {
  const { ctx } = plot;
  const size = 9 * devicePixelRatio * scale;
  ctx.save();
  ctx.fillStyle = ink;
  spec.series.forEach(({ supports: held }, k) => {
    if (!held) return;
    plot.data[k + 1]!.forEach((value, i) => {
      if (value === null || value === undefined) return;
      const [x, y] = [plot.valToPos(plot.data[0][i]!, "x", true), plot.valToPos(value, "y", true)];
      ctx.beginPath();
      ctx.moveTo(x, y);
      ctx.lineTo(x - 0.6 * size, y + size);
      ctx.lineTo(x + 0.6 * size, y + size);
      ctx.fill();
    });
  });
  ctx.restore();
}
