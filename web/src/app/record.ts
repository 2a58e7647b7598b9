// The record that a flight follows: which columns of a file hold what, as the document has it, or as their names suggest.

import { button, choice, element } from "../controls";
import { api, type Entry, type Head } from "./api";

type Mapping = Record<string, string>;
type Options = (readonly [string, string])[];

/** A flight of the document, with what is written of its record. */
export interface Flight {
  name: string;
  record: Mapping | null;
}

/** The flights among the entries of a form. */
export function flightsOf(form: Entry[]): Flight[] {
  const motions = form.find((each) => each.path === "motion")?.inside ?? [];
  return motions.filter((each) => each.choice === "flight").map((each) => {
    const record = each.inside?.find((other) => other.key === "record" && other.written);
    const values = record?.inside?.filter((value) => value.written).map((value) => [value.key, value.value ?? ""]);
    return { name: each.key, record: values ? (Object.fromEntries(values) as Mapping) : null };
  });
}

const AXES = ["x", "y", "z"];
const RATES = ["p", "q", "r"];
const named = (units: string[]): Options => units.map((each) => [each, each.replace("^2", "²").replace("deg", "°")] as const);
const TIMES: Options = [["", "the file's unit, or s"], ...named(["s", "ms", "us", "ns", "min", "h", "day"])];
const LOADS = named(["g", "mg", "m/s^2", "cm/s^2", "mm/s^2", "ft/s^2", "in/s^2"]);
const TURNS = named(["rad/s", "deg/s", "rpm"]);
const VEHICLES: Options = [["aircraft", "an aircraft"], ["rocket", "a rocket"], ["other", "something else"]];
const HOLDS: Options = [["specific-force", "specific force"], ["acceleration", "acceleration"]];

/** What a record still lacks before it can be used, in words; nothing where it is whole. */
export function lacking(chosen: Mapping): string {
  const turns = RATES.filter((key) => chosen[key] && chosen[key] !== "0");
  if (!chosen["time"] && !chosen["sample_rate"]) return "choose the column of time, or give a sample rate";
  if (AXES.every((key) => (chosen[key] ?? "0") === "0")) return "choose a column for x, y or z";
  if (!chosen["unit"]) return "choose the unit of x, y and z";
  if (turns.length && !chosen["rate_unit"]) return "choose the unit of p, q and r";
  return "";
}

/** Columns of p, q and r about the axes that x, y and z are chosen along; `suggested` has all six along the file's axes.
 * None where no rotation takes those three to the beam's. */
export function ratesAlong(chosen: Mapping, suggested: Mapping): Mapping {
  const axes = AXES.map((key) => AXES.findIndex((axis) => suggested[axis] && chosen[key]?.replace(/^-/, "") === suggested[axis]));
  const signs = AXES.map((key, n) => (chosen[key] === suggested[AXES[axes[n]!]!] ? 1 : -1));
  const [i, j, k] = axes as [number, number, number];
  const determinant = signs.reduce((product, sign) => product * sign, -Math.sign((j - i) * (k - j) * (i - k)));
  if (axes.includes(-1) || determinant !== 1 || RATES.some((key) => !suggested[key])) return {};
  return Object.fromEntries(RATES.map((key, n) => [key, (signs[n] === 1 ? "" : "-") + suggested[RATES[axes[n]!]!]]));
}

/** What is written of a record: rates all together, or none of them. */
export function written(chosen: Mapping): Mapping {
  const turning = RATES.some((key) => chosen[key] && chosen[key] !== "0");
  const clock = chosen["sample_rate"] ? ["sample_rate"] : ["time", "time_unit"];
  const keys = ["file", ...clock, ...AXES, "unit", "quantity", "vehicle", ...(turning ? [...RATES, "rate_unit"] : [])];
  const pairs = keys.map((key) => [key, chosen[key] || ([...AXES, ...RATES].includes(key) ? "0" : "")] as const);
  return Object.fromEntries(pairs.filter(([, value]) => value));
}

export class RecordPanel {
  readonly root = element("div", "record");
  private flights: Flight[] = [];
  private motion = "";
  /** What has been dropped on the page and no flight follows yet. */
  private dropped: Head | null = null;
  private shown = "";
  private judge: () => void = () => {};

  /** `use` makes a flight follow a record, and says whether it does. */
  constructor(private readonly use: (motion: string, record: Mapping) => Promise<boolean>) {}

  /** Offer a file that has been dropped. */
  open(head: Head): void {
    this.dropped = head;
    this.draw(head, { file: head.name, ...head.suggested }, Object.keys(head.suggested));
  }

  /** Show the record of a flight of the document, unless one that was dropped waits to be used. */
  async offer(flights: Flight[]): Promise<void> {
    this.flights = flights;
    if (!flights.some((each) => each.name === this.motion)) this.motion = flights[0]?.name ?? "";
    const record = this.dropped ? null : (flights.find((each) => each.name === this.motion)?.record ?? null);
    const now = JSON.stringify([this.dropped?.name, record, this.motion, flights.map((each) => each.name)]);
    if (now === this.shown) return; // nothing that has the focus, or was chosen, is made again without need
    this.shown = now;
    if (this.dropped) this.which();
    else if (!record?.["file"]) this.root.replaceChildren();
    else {
      const head = await api.record(record["file"]).catch(() => null); // what is wrong is said of the document
      if (now !== this.shown) return; // overtaken
      if (head) this.draw(head, record, []);
      else this.root.replaceChildren();
    }
  }

  private draw(head: Head, record: Mapping, suggested: string[]): void {
    const chosen: Mapping = { ...record };
    const listed: Options = head.columns.map((each) => [each, each]);
    const signed: Options = [["0", "none"], ...listed, ...head.columns.map((each) => [`-${each}`, `−${each}`] as const)];
    const ready = element("span", "faint");
    const act = button(this.dropped ? "Use this record" : "Change the record", () => void this.take(chosen));
    this.judge = (): void => {
      ready.textContent = lacking(chosen);
      act.disabled = !this.motion || lacking(chosen) !== "";
    };
    const rates = element("details");
    const turns = ratesAlong(chosen, head.suggested);
    let following = RATES.every((key) => chosen[key] && chosen[key] === turns[key]); // until a rate is chosen
    const follow = (): void => {
      for (const [key, value] of Object.entries(ratesAlong(chosen, head.suggested))) {
        chosen[key] = value;
        rates.querySelector<HTMLSelectElement>(`[data-key=${key}] select`)!.value = value;
      }
    };
    const field = (key: string, name: string, options: Options, first = ""): HTMLElement => {
      const known = options.some(([value]) => value === (chosen[key] ?? first));
      const all = known ? options : ([["", "choose"], ...options] as Options);
      const label = choice(name, all, known ? (chosen[key] ?? first) : "", (value) => {
        chosen[key] = value;
        label.classList.remove("suggested");
        if (RATES.includes(key)) following = false;
        if (AXES.includes(key) && following) follow();
        this.judge();
      });
      label.dataset["key"] = key;
      if (suggested.includes(key)) label.classList.add("suggested");
      return label;
    };
    rates.open = RATES.some((key) => chosen[key]);
    rates.append(
      element("summary", "", "Body rates"),
      this.row(...RATES.map((key) => field(key, `${key} is`, signed, "0")), field("rate_unit", "Unit of rates", TURNS)),
    );
    const flight = element("span", "flight");
    const words = this.dropped ? `Record ${head.name}, not used yet` : `Record of ${this.motion}: ${head.name}`;
    this.root.replaceChildren(
      element("h3", "", words),
      ...(suggested.length ? [element("p", "faint", "Dashed: suggested by the columns' names and units. Check them, and choose the signs of x, y and z: p, q and r follow.")] : []),
      this.row(
        flight,
        field("time", "Time", chosen["sample_rate"] ? [["", "none"], ...listed] : listed),
        field("time_unit", "Time in", TIMES),
        this.rate(chosen),
        ...AXES.map((key) => field(key, `${key} is`, signed, "0")),
        field("unit", "Unit", LOADS),
        field("quantity", "Holds", HOLDS, "specific-force"),
        field("vehicle", "Of", VEHICLES, "aircraft"),
      ),
      rates,
      this.row(act, ready),
    );
    this.which();
  }

  /** A sample rate, which takes the place of a column of time. */
  private rate(chosen: Mapping): HTMLElement {
    const label = element("label", "", "or sample rate ");
    const input = element("input");
    input.placeholder = "such as 100 Hz";
    input.size = 12;
    input.value = chosen["sample_rate"] ?? "";
    input.addEventListener("input", () => {
      chosen["sample_rate"] = input.value.trim();
      this.judge();
    });
    label.append(input);
    return label;
  }

  /** Which flight follows the record, and whether it can. */
  private which(): void {
    const place = this.root.querySelector(".flight");
    const options = this.flights.map((each) => [each.name, each.name] as const);
    const none = element("span", "bad", "the scenario has no flight that could follow it: add a motion of that kind");
    const select = choice("Flight", options, this.motion, (value) => {
      this.motion = value;
      void this.offer(this.flights);
    });
    place?.replaceChildren(this.motion ? select : none);
    this.judge();
  }

  private async take(chosen: Mapping): Promise<void> {
    const [waiting, motion] = [this.dropped, this.motion];
    this.dropped = null; // the document that comes back shows it
    if (await this.use(motion, written(chosen))) return;
    this.dropped = waiting;
  }

  private row(...parts: HTMLElement[]): HTMLElement {
    const row = element("div", "gbeam-row");
    row.append(...parts);
    return row;
  }
}
