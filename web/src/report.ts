// The page: fills the places that Python left for the viewer, the plots and the maps.

import { button, choice, element, reachable } from "./controls";
import { type Data, decode, type Header } from "./data";
import { heatMap } from "./maps";
import { Plots } from "./plots";
import { Viewer } from "./viewer";

declare global {
  interface Window {
    /** What is shown, for tests and for the browser's console. */
    gbeam?: { viewer: Viewer | null };
  }
}

/** The data of this page; null where it is no report. */
export function readPage(): Data | null {
  const [header, numbers] = ["gbeam-header", "gbeam-numbers"].map((id) => document.getElementById(id)?.textContent);
  if (!header) return null;
  return { header: JSON.parse(header) as Header, numbers: decode(numbers ?? "") };
}

export function showPage(data: Data): void {
  const stage = document.getElementById("gbeam-viewer");
  let viewer: Viewer | null = null;
  if (stage && data.header.scene) viewer = Viewer.mount(stage, data);
  if (stage && data.header.modes) viewer = showModesIn(stage, data).viewer();
  const plots = new Plots(data, viewer && data.header.scene ? viewer.clock : null);
  for (const spec of data.header.plots) {
    const place = document.getElementById(spec.id);
    if (place) plots.add(place, spec);
  }
  for (const spec of data.header.maps) {
    const place = document.getElementById(spec.id);
    if (place) heatMap(place, data, spec);
  }
  themeSwitch();
  reachable(document.body);
  printing(plots);
  sayHeight();
  window.gbeam = { viewer };
  document.documentElement.dataset["gbeam"] = "drawn";
}

/** The shapes of modes, one at a time. */
export function showModesIn(stage: HTMLElement, data: Data): { viewer: () => Viewer | null; dispose: () => void } {
  const modes = data.header.modes!;
  const place = element("div");
  let viewer: Viewer | null = null;
  const show = (which: number): void => {
    viewer?.dispose();
    place.replaceChildren();
    const scene = { motions: [modes.motions[which]!], start: 0 };
    viewer = Viewer.mount(place, { header: { scene, plots: [], maps: [] }, numbers: data.numbers });
    if (window.gbeam) window.gbeam.viewer = viewer;
  };
  const row = element("div", "gbeam-row");
  const options = modes.labels.map((label, i) => [String(i), label] as const);
  row.append(choice("Mode", options, "0", (value) => show(Number(value))));
  stage.append(row, place);
  show(0);
  return { viewer: () => viewer, dispose: () => viewer?.dispose() };
}

/** Tell the page that shows this one in a frame, if any, how high it is. */
function sayHeight(): void {
  if (window.parent === window) return;
  new ResizeObserver(() => {
    window.parent.postMessage({ gbeamHeight: Math.ceil(document.body.getBoundingClientRect().height) }, "*");
  }).observe(document.body);
}

/** Light or dark, whatever the system says. */
function themeSwitch(): void {
  const place = document.getElementById("gbeam-theme");
  if (!place) return;
  const themes = ["", "light", "dark"] as const;
  let i = 0;
  const act = button("Theme: system", () => {
    i = (i + 1) % themes.length;
    setTheme(themes[i]!);
    act.textContent = `Theme: ${themes[i] || "system"}`;
  });
  place.append(act);
}

function setTheme(theme: string): void {
  if (theme) document.documentElement.dataset["theme"] = theme;
  else delete document.documentElement.dataset["theme"];
  window.dispatchEvent(new Event("gbeam-theme"));
}

const PAPER_WIDTH = 680; // pixels between the margins

/** Paper is white and cannot be clicked: all is drawn in light colours and unfolded while the page is printed. */
function printing(plots: Plots): void {
  let before = "";
  let folded: HTMLDetailsElement[] = [];
  let maps: HTMLElement[] = [];
  window.addEventListener("beforeprint", () => {
    before = document.documentElement.dataset["theme"] ?? "";
    setTheme("light");
    plots.toPaper();
    folded = [...document.querySelectorAll<HTMLDetailsElement>("details:not([open])")];
    for (const each of folded) each.open = true;
    maps = [...document.querySelectorAll<HTMLElement>(".gbeam-map")];
    for (const each of maps) each.style.zoom = String(Math.min(1, PAPER_WIDTH / each.offsetWidth));
  });
  window.addEventListener("afterprint", () => {
    setTheme(before);
    for (const each of folded) each.open = false;
    for (const each of maps) each.style.zoom = "";
  });
}
