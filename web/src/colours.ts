// Colours that are distinct with any colour vision: Okabe and Ito (2008), and cividis for sizes.

export const PALETTE = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"] as const;
/** The same on a dark ground: lighter where the contrast would be below 3 to 1. */
const ON_DARK = ["#4BA3E3", "#F08A3C", "#2BC49A", "#E29BC4", "#F0B840", "#7FCBF5", "#F2F2F2"] as const;

export function lineColour(index: number, dark: boolean): string {
  const palette = dark ? ON_DARK : PALETTE;
  return palette[index % palette.length]!;
}

/** Nine colours of cividis (Nuñez, Anderton and Renslow 2018), from small to large. */
const CIVIDIS: readonly (readonly [number, number, number])[] = [
  [0, 34, 78],
  [26, 56, 111],
  [67, 78, 108],
  [97, 101, 111],
  [125, 124, 120],
  [155, 148, 118],
  [188, 174, 108],
  [222, 201, 88],
  [254, 232, 56],
];

/** Colour of a share, 0 to 1; red, green and blue from 0 to 1. */
export function shade(share: number): [number, number, number] {
  const x = (Number.isFinite(share) ? Math.min(Math.max(share, 0), 1) : 0) * (CIVIDIS.length - 1);
  const i = Math.min(Math.floor(x), CIVIDIS.length - 2);
  const [a, b, f] = [CIVIDIS[i]!, CIVIDIS[i + 1]!, x - i];
  return [0, 1, 2].map((k) => (a[k]! + f * (b[k]! - a[k]!)) / 255) as [number, number, number];
}

/** Black or white, whichever is read better on a colour. */
export function inkOn(colour: [number, number, number]): "#000" | "#fff" {
  return luminance(colour) > 0.179 ? "#000" : "#fff";
}

/** Relative luminance of WCAG 2. */
export function luminance(colour: [number, number, number]): number {
  const [r, g, b] = colour.map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4)) as typeof colour;
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

export function css([r, g, b]: [number, number, number]): string {
  return `rgb(${Math.round(255 * r)} ${Math.round(255 * g)} ${Math.round(255 * b)})`;
}

export const GRADIENT = `linear-gradient(to right, ${CIVIDIS.map((c) => `rgb(${c.join(" ")})`).join(", ")})`;

export function prefersDark(): boolean {
  const forced = document.documentElement.dataset["theme"];
  return forced ? forced === "dark" : window.matchMedia("(prefers-color-scheme: dark)").matches;
}
