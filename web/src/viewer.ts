// The viewer: every motion side by side on one canvas and one clock, with its controls.

import { WebGLRenderer } from "three";
import type { Colouring, Settings } from "./bodies";
import { Clock } from "./clock";
import { css, GRADIENT, prefersDark, shade } from "./colours";
import { button, choice, element, tick } from "./controls";
import { type Data, format, view } from "./data";
import { Orbit } from "./orbit";
import { Panel } from "./panel";

const NO_WEBGL = "This browser shows no WebGL, so there is no view in three dimensions; the plots and tables have it all.";
const PERIODS = 50; // of a motion that begins again
const SPEEDS = [0.05, 0.1, 0.25, 0.5, 1, 2, 4];

/** A factor that makes a deflection visible: 1, 2 or 5 times a power of ten; 1 where it is large itself. */
export function visible(largest: number, length: number): number {
  if (!(largest > 0) || largest > 0.05 * length) return 1;
  const factor = (0.12 * length) / largest;
  const power = 10 ** Math.floor(Math.log10(factor));
  return power * (factor / power >= 5 ? 5 : factor / power >= 2 ? 2 : 1);
}

export class Viewer {
  readonly clock: Clock;
  private readonly renderer: WebGLRenderer;
  private readonly panels: Panel[];
  private readonly labels: HTMLElement[] = [];
  private readonly canvas = element("canvas", "gbeam-canvas");
  private readonly paper = element("img", "gbeam-paper");
  private readonly stage = element("div", "gbeam-stage");
  private readonly orbit: Orbit;
  private readonly settings: Settings;
  private readonly released: (() => void)[] = [];
  private readonly onPaper = window.matchMedia("print");
  private dirty = true;
  private handle = 0;

  private constructor(root: HTMLElement, data: Data, renderer: (canvas: HTMLCanvasElement) => WebGLRenderer) {
    const motions = data.header.scene!.motions;
    const most = (of: (each: (typeof motions)[number]) => number | undefined): number =>
      Math.max(0, ...motions.map((each) => of(each) ?? 0));
    const largest = most((each) => each.largest);
    const parts = motions.flatMap((each) => each.parts);
    const beams = parts.flatMap((part) => part.beam ?? []);
    const stresses = [...beams.flatMap((each) => each.stress ?? []), ...parts.flatMap((part) => part.surface ?? [])];
    this.settings = {
      factor: motions.every((each) => each.relative) ? 1 : visible(largest, motions[0]!.length),
      ghost: true,
      loads: true,
      colouring: stresses.some((each) => each.largest > 0) ? "stress" : stresses.length + beams.length ? "deflection" : "none",
      largestDeflection: largest,
      largestStress: Math.max(0, ...stresses.map((each) => each.largest)),
      largestLoad: most((each) => each.largestLoad),
    };
    const ends = motions.map((each) => view(data.numbers, each.time));
    this.clock = new Clock(
      Math.min(...ends.map((each) => each[0]!)),
      Math.max(...ends.map((each, i) => each[each.length - 1]! * (motions[i]!.period ? PERIODS : 1))),
      data.header.scene!.start,
    );
    this.panels = motions.flatMap((motion) => {
      const views = [new Panel(motion, data.numbers, false)];
      return motion.axes || motion.angle || motion.attitude ? [...views, new Panel(motion, data.numbers, true)] : views;
    });
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The structure in motion. Space plays, arrow keys turn the view, Page Up and Down step.");
    this.paper.alt = "The structure in motion, at the time that the viewer shows.";
    this.stage.append(this.canvas, this.paper);
    this.renderer = renderer(this.canvas);
    this.renderer.setScissorTest(true);
    for (const panel of this.panels) this.stage.append(this.label(panel));
    root.append(this.stage, ...this.controls());
    this.orbit = new Orbit(this.canvas, () => this.touch());
    this.canvas.addEventListener("keydown", (e) => this.key(e));
    this.listen();
    this.handle = requestAnimationFrame((now) => this.frame(now));
  }

  /** A viewer inside an element; a text there instead, and null, where there is no WebGL. */
  static mount(root: HTMLElement, data: Data): Viewer | null {
    const make = (canvas: HTMLCanvasElement): WebGLRenderer =>
      new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    if (!document.createElement("canvas").getContext("webgl2")) {
      root.append(element("p", "gbeam-fallback", NO_WEBGL));
      return null;
    }
    root.classList.add("gbeam-viewer");
    return new Viewer(root, data, make);
  }

  /** Let go of the graphics memory and of every listener. */
  dispose(): void {
    cancelAnimationFrame(this.handle);
    for (const release of this.released) release();
    this.renderer.dispose();
  }

  private touch(): void {
    this.dirty = true;
  }

  private listen(): void {
    const resized = new ResizeObserver(() => this.touch());
    resized.observe(this.stage);
    const scheme = window.matchMedia("(prefers-color-scheme: dark)");
    const touch = (): void => this.touch();
    scheme.addEventListener("change", touch);
    // At once, and as a picture too: before a page is printed there is no other frame.
    const redraw = (): void => {
      this.draw();
      this.paper.src = this.canvas.toDataURL();
    };
    window.addEventListener("gbeam-theme", redraw);
    this.released.push(
      () => resized.disconnect(),
      () => scheme.removeEventListener("change", touch),
      () => window.removeEventListener("gbeam-theme", redraw),
      this.clock.onChange(touch),
    );
  }

  private frame(now: number): void {
    this.clock.frame(now);
    if (this.dirty && !this.onPaper.matches) this.draw(); // there the picture is one of before, and so are its labels
    this.handle = requestAnimationFrame((next) => this.frame(next));
  }

  /** Columns and rows of the panels: as many columns as fit with 260 pixels each. */
  private layout(width: number): [number, number] {
    const columns = Math.max(1, Math.min(this.panels.length, Math.floor(width / 260)));
    return [columns, Math.ceil(this.panels.length / columns)];
  }

  private draw(): void {
    this.dirty = false;
    const width = this.stage.clientWidth;
    if (!width) return;
    const [columns, rows] = this.layout(width);
    const height = Math.round(Math.min(Math.max((0.8 * width) / columns, 200), 380)) * rows;
    this.stage.style.height = `${height}px`;
    const ratio = Math.min(window.devicePixelRatio, 2);
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height);
    }
    const dark = prefersDark();
    this.panels.forEach((panel, i) => {
      const [column, row] = [i % columns, Math.floor(i / columns)];
      const [left, top] = [Math.round((column * width) / columns), Math.round((row * height) / rows)];
      const wide = Math.round(((column + 1) * width) / columns) - left - (column + 1 < columns ? 1 : 0);
      const high = Math.round(height / rows) - (row + 1 < rows ? 1 : 0);
      panel.update(this.clock.time, this.settings, dark);
      panel.draw(this.renderer, this.orbit, [left, height - top - high, wide, high]);
      const label = this.labels[i]!;
      label.style.left = `${(100 * left) / width}%`; // of the width and height: on paper they are others
      label.style.top = `${(100 * top) / height}%`;
      label.style.maxWidth = `${(100 * wide) / width}%`;
      const state = panel.state(this.clock.time);
      label.lastElementChild!.textContent = [panel.note, state].filter(Boolean).join("; ");
    });
  }

  private label(panel: Panel): HTMLElement {
    const label = element("div", "gbeam-label");
    label.append(element("strong", "", panel.title), element("span", "", panel.note));
    this.labels.push(label);
    return label;
  }

  private controls(): HTMLElement[] {
    const { clock, settings } = this;
    const play = button("Play", () => clock.toggle());
    play.classList.add("gbeam-play");
    const slider = element("input", "gbeam-time");
    Object.assign(slider, { type: "range", min: clock.start, max: clock.end, step: "any", ariaLabel: "time" });
    slider.addEventListener("input", () => clock.seek(Number(slider.value)));
    const readout = element("output", "gbeam-readout");
    const follow = (): void => {
      play.textContent = clock.playing ? "Pause" : "Play";
      slider.value = String(clock.time);
      readout.textContent = `${clock.time.toFixed(3)} s`;
    };
    this.released.push(clock.onChange(follow));
    follow();
    const speed = choice("Speed", SPEEDS.map((each) => [String(each), `× ${each}`]), "1", (value) => {
      clock.speed = Number(value);
    });
    const scales = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
    if (!scales.includes(settings.factor)) scales.push(settings.factor);
    const scale = choice("Deflection", scales.map((each) => [String(each), `× ${each}`]), String(settings.factor), (value) => {
      settings.factor = Number(value);
      this.touch();
    });
    const legend = element("div", "gbeam-legend");
    const colours: [string, string][] = [["deflection", "deflection"], ["none", "none"]];
    if (settings.largestStress > 0) colours.unshift(["stress", "stress"]);
    const colour = choice("Colour", colours, settings.colouring, (value) => {
      settings.colouring = value as Colouring;
      this.describe(legend);
      this.touch();
    });
    this.describe(legend);
    const ghost = tick("undeformed", settings.ghost, (on) => {
      settings.ghost = on;
      this.touch();
    });
    const relative = this.panels.every((panel) => panel.motion.relative);
    const bends = this.panels.some((panel) => panel.motion.parts.some((part) => part.beam ?? part.surface));
    const bending = relative ? [colour, ghost] : [scale, colour, ghost];
    const parts: HTMLElement[] = [...(clock.end > clock.start ? [speed] : []), ...(bends ? bending : [])];
    if (settings.largestLoad > 0) {
      parts.push(
        tick("load", settings.loads, (on) => {
          settings.loads = on;
          this.touch();
        }),
      );
    }
    parts.push(button("Reset view", () => this.orbit.reset()));
    const first = element("div", "gbeam-row");
    first.append(play, slider, readout);
    const second = element("div", "gbeam-row");
    second.append(...parts);
    return clock.end > clock.start ? [first, second, legend] : [second, legend];
  }

  /** What colours and arrows mean. */
  private describe(legend: HTMLElement): void {
    const { colouring, largestStress, largestDeflection, largestLoad } = this.settings;
    legend.replaceChildren();
    if (colouring !== "none") {
      const stress = colouring === "stress";
      const relative = this.panels.every((panel) => panel.motion.relative);
      const surfaces = this.panels.flatMap((panel) => panel.motion.parts.flatMap((part) => part.surface ?? []));
      const more = stress && surfaces.some((each) => each.beyond) ? ", more where it has no limit as the mesh gets finer" : "";
      const size = relative ? "largest" : stress ? `${format(largestStress / 1e6)} MPa` : `${format(1e3 * largestDeflection)} mm`;
      const end = `${size}${more}`;
      const bar = element("span", "gbeam-bar");
      bar.style.background = GRADIENT;
      bar.style.borderColor = css(shade(0));
      legend.append(element("span", "", `${stress ? "stress" : "deflection"} 0`), bar, element("span", "", end));
    }
    const supports = this.panels.flatMap((panel) => panel.motion.parts.flatMap((part) => part.supports ?? []));
    if (supports.length) {
      const each = new Set(supports.map(({ name, words }) => `at ${name} ${words}`));
      legend.append(element("span", "", `supports, orange: ${[...each].join("; ")}`));
    }
    if (largestLoad > 0) {
      const wanted = this.panels.some((panel) => panel.motion.reference);
      const rooted = this.panels.some((panel) => panel.motion.load && !panel.motion.reference);
      const where = `load at the control point${rooted ? ", of a flight at the root" : ""}`;
      const words = wanted ? `${where}: orange made, black or white of the target` : "load at the root: orange";
      legend.append(element("span", "", `${words}; axes x orange, y green, z blue`));
    }
  }

  private key(e: KeyboardEvent): void {
    const step = (this.clock.end - this.clock.start) / 100;
    const actions: Record<string, () => void> = {
      " ": () => this.clock.toggle(),
      ...this.orbit.keys,
      PageUp: () => this.clock.seek(this.clock.time - step),
      PageDown: () => this.clock.seek(this.clock.time + step),
      Home: () => this.clock.seek(this.clock.start),
      End: () => this.clock.seek(this.clock.end),
    };
    const action = actions[e.key];
    if (!action) return;
    e.preventDefault();
    action();
  }
}
