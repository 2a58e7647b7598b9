// A sweep: what varies, and the map of its cases, each of which opens its run.

import { css, shade } from "../colours";
import { button, choice, element } from "../controls";
import { format } from "../data";
import { api, type Field, type Problem, Refusal } from "./api";
import { Command } from "./command";

/** What varies, over which values, and which figures of the cases. */
export class SweepForm {
  readonly root = element("details", "sweep");
  private readonly rows = [0, 1].map(() => ({ place: element("span"), path: "", values: element("input") }));
  private readonly measure = element("input");
  private readonly problems = element("p", "bad");
  private readonly command = new Command([]);
  private paths = "";

  constructor(text: () => string, submitted: (id: string) => void) {
    this.root.append(element("summary", "", "Sweep"));
    this.rows.forEach((row, i) => {
      row.values.placeholder = "1 m:12 m:12, or 1 m, 2 m";
      row.values.addEventListener("input", () => this.say());
      const label = element("label", "", "over ");
      label.append(row.values);
      const line = element("div", "gbeam-row");
      line.append(row.place, label);
      if (i) line.append(element("span", "faint", "(or nothing)"));
      this.root.append(line);
    });
    this.measure.value = "tip.size.max_abs";
    const label = element("label", "", "Figures ");
    label.append(this.measure);
    this.measure.addEventListener("input", () => this.say());
    const run = async (): Promise<void> => {
      this.problems.textContent = "";
      try {
        submitted((await api.sweep(text(), this.over(), this.measure.value)).id);
      } catch (error) {
        const found: Problem[] = error instanceof Refusal ? error.problems : [];
        this.problems.textContent = found.map((each) => `${each.path} ${each.message}; ${each.hint}`).join(" ") || String(error);
      }
    };
    const line = element("div", "gbeam-row");
    line.append(label, button("Run sweep", () => void run()));
    this.root.append(line, this.problems, this.command.root);
    this.say();
  }

  /** What varies over which values, as `--over` has it. */
  private over(): string[] {
    return this.rows.filter((row) => row.path && row.values.value).map((row) => `${row.path}=${row.values.value}`);
  }

  private say(): void {
    const over = this.over().flatMap((each) => ["--over", each]);
    this.command.say(["gbeam", "sweep", "scenario.toml", ...over, "--measure", this.measure.value]);
  }

  /** Offer the values of a document. */
  offer(fields: Field[]): void {
    const options = fields.map((each) => each.path).filter((path) => !path.endsWith(".file") && path !== "title");
    if (this.paths === options.join()) return;
    this.paths = options.join();
    this.rows.forEach((row, i) => {
      if (!options.includes(row.path)) row.path = "";
      const offered = [["", "nothing"] as const, ...options.map((path) => [path, path] as const)];
      row.place.replaceChildren(
        choice(i ? "and" : "Vary", offered, row.path, (path) => {
          row.path = path;
          this.say();
        }),
      );
    });
    this.say();
  }
}

interface Parameter {
  path: string;
  unit: string;
  values: (number | string)[];
}

interface Sweep {
  parameters: Parameter[];
  measures: Record<string, { unit: string; values: unknown }>;
}

/** A table of a sweep's cases in the colours of its first figure; a click on one opens or starts its run. */
export async function sweepMap(id: string, opened: (id: string) => void): Promise<HTMLElement> {
  const sweep = JSON.parse(await api.text(id, "answer.json")) as Sweep;
  const scenario = await api.text(id, "scenario.toml");
  const [rows, columns] = [sweep.parameters[0]!, sweep.parameters[1]];
  const [name, figure] = Object.entries(sweep.measures)[0]!;
  const at = (i: number, j: number): number | null => {
    const row = (figure.values as (number | null | (number | null)[])[])[i];
    return Array.isArray(row) ? (row[j] ?? null) : (row ?? null);
  };
  const all = (figure.values as unknown[]).flat().filter((each): each is number => typeof each === "number");
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const text = (of: Parameter, k: number): string => `${of.values[k]}${of.unit ? ` ${of.unit}` : ""}`;
  const short = (of: Parameter, k: number): string => {
    const value = of.values[k]!;
    return `${typeof value === "number" ? Number(value.toPrecision(6)) : value}${of.unit ? ` ${of.unit}` : ""}`;
  };
  const open = async (i: number, j: number): Promise<void> => {
    let made = scenario;
    for (const [of, k] of [[rows, i], [columns, j]] as const) {
      if (of) made = (await api.edit(made, of.path, text(of, k))).text;
    }
    opened((await api.submit(made, `${id}/${i}/${j}`)).id);
  };
  const table = element("table", "gbeam-map");
  const head = element("tr");
  head.append(element("th", "", columns ? `${rows.path} \\ ${columns.path}` : rows.path));
  for (let j = 0; j < (columns?.values.length ?? 1); j++) head.append(element("th", "", columns ? short(columns, j) : name));
  table.append(head);
  rows.values.forEach((_, i) => {
    const line = element("tr");
    line.append(element("th", "", short(rows, i)));
    for (let j = 0; j < (columns?.values.length ?? 1); j++) {
      const value = at(i, j);
      const cell = element("td");
      const act = button(format(value), () => void open(i, j));
      const share = value === null ? 0 : high > low ? (value - low) / (high - low) : 0.5;
      if (value !== null) {
        act.style.background = css(shade(share));
        act.style.color = share > 0.55 ? "#000" : "#fff";
      }
      act.title = "open the run of this case";
      cell.append(act);
      line.append(cell);
    }
    table.append(line);
  });
  const box = element("div", "gbeam-wide");
  box.append(element("p", "faint", `${name}${figure.unit ? `, ${figure.unit}` : ""}: a cell opens its run`), table);
  return box;
}
