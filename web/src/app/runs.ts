// The runs: listed, watched, cancelled, opened, compared; earlier ones are there again after a restart.

import { button, element } from "../controls";
import { format } from "../data";
import { api, type Run } from "./api";
import { sweepMap } from "./sweeps";

const ACTIVE = ["queued", "running"];
/** Scenarios that verbs make. */
const MADE = ["placed.toml", "found.toml", "command.json"];
const OFTEN = 700; // ms, while something runs
const SELDOM = 5000;
const HIGHEST = 200_000; // pixels

/** A body's largest values over time; at rest it has no sizes. */
interface Body {
  tip?: { size?: { max_abs: number } };
  loads?: { root_moment: { size?: { max_abs: number } }; stress?: { max?: number } };
}

interface Answer {
  motions?: Record<string, { outcome: string; bodies?: Record<string, Body> }>;
  comparisons?: { verdict: string }[];
}

/** When a run was submitted, month, day and time, as its id has it. */
function when(id: string): string {
  const [, , month, day, , hour, minute, second] = id.match(/\d\d|-/g)!;
  return `${month}-${day} ${hour}:${minute}:${second}`;
}

/** Make a frame as high as the report in it says that it is: scrolled by itself it would cut what belongs together. */
function whole(frame: HTMLIFrameElement): void {
  const listen = ({ source, data }: MessageEvent<unknown>): void => {
    if (!frame.isConnected) return window.removeEventListener("message", listen);
    const height = source === frame.contentWindow ? Number((data as { gbeamHeight?: unknown } | null)?.gbeamHeight) : NaN;
    if (height > 0 && height < HIGHEST) frame.style.height = `${height}px`;
  };
  window.addEventListener("message", listen);
}

/** What tells a run from others of its title: its options, and what its scenario changes. */
function apart(run: Run): string {
  return [run.arguments.join(" "), run.changes].filter(Boolean).join("; ");
}

export class Runs {
  readonly root = element("section");
  private readonly list = element("div", "runs");
  private readonly shown = element("div");
  private readonly compared = new Set<string>();
  private selected = "";
  private drawn = "";
  private timer = 0;

  constructor(private readonly reuse: (text: string) => void) {
    this.list.setAttribute("aria-live", "polite");
    this.root.append(element("h2", "", "Runs"), this.list, this.shown);
  }

  /** Look at all runs now, and again after a while. */
  async watch(select = ""): Promise<void> {
    window.clearTimeout(this.timer);
    if (select) this.selected = select;
    let wait = SELDOM;
    try {
      const runs = await api.runs();
      this.draw(runs);
      if (runs.some((each) => ACTIVE.includes(each.state))) wait = OFTEN;
    } catch (error) {
      this.list.replaceChildren(element("p", "bad", error instanceof Error ? error.message : String(error)));
    }
    this.timer = window.setTimeout(() => void this.watch(), wait);
  }

  private draw(runs: Run[]): void {
    const now = JSON.stringify([runs, this.selected]);
    if (now === this.drawn) return; // nothing that has the focus is made again without need
    const before = JSON.parse(this.drawn || "[[]]") as [Run[], string?];
    const was = before[0].find((each) => each.id === this.selected)?.state;
    this.drawn = now;
    const focused = (document.activeElement as HTMLElement | null)?.dataset["key"];
    this.list.replaceChildren();
    if (!runs.length) this.list.append(element("p", "faint", "none yet"));
    for (const run of runs) this.list.append(this.row(run));
    if (focused) this.list.querySelector<HTMLElement>(`[data-key="${focused}"]`)?.focus();
    const chosen = runs.find((each) => each.id === this.selected);
    if (chosen && (chosen.state !== was || before[1] !== this.selected)) void this.open(chosen);
  }

  private row(run: Run): HTMLElement {
    const row = element("div", "gbeam-row run");
    const kind = run.state === "done" ? "good" : ACTIVE.includes(run.state) ? "" : "bad";
    const open = button(run.title || run.id, () => void this.watch(run.id));
    open.classList.add("open");
    if (apart(run)) open.append(" ", element("span", "faint", apart(run)));
    open.dataset["key"] = `open-${run.id}`;
    open.setAttribute("aria-pressed", String(run.id === this.selected));
    row.append(open, element("span", "faint", when(run.id)));
    row.append(element("span", kind, run.verb === "run" ? run.state : `${run.verb} ${run.state}`));
    if (ACTIVE.includes(run.state)) {
      row.append(element("span", "faint", run.progress));
      const cancel = button("Cancel", () => void api.cancel(run.id).then(() => this.watch()));
      cancel.dataset["key"] = `cancel-${run.id}`;
      row.append(cancel);
    } else if (run.verb === "run" && run.files.includes("answer.json")) {
      const label = element("label");
      const box = element("input");
      box.type = "checkbox";
      box.checked = this.compared.has(run.id);
      box.dataset["key"] = `compare-${run.id}`;
      box.addEventListener("change", () => {
        if (box.checked) this.compared.add(run.id);
        else this.compared.delete(run.id);
        if (this.compared.size > 1) void this.compare();
      });
      label.append(box, " compare");
      row.append(label);
    }
    return row;
  }

  private async open(run: Run): Promise<void> {
    const which = [run.verb, when(run.id), apart(run)].filter(Boolean).join("; ");
    this.shown.replaceChildren(element("h2", "", run.title || run.id), element("p", "faint", which));
    if (ACTIVE.includes(run.state)) {
      this.shown.append(element("p", "faint", `${run.state}: the report appears here`));
      return;
    }
    const links = element("div", "gbeam-row");
    const use = (text: string, name: string): HTMLElement =>
      button(text, () => void api.text(run.id, name).then((made) => this.reuse(made)));
    links.append(
      use("Use this scenario", "scenario.toml"),
      ...run.files.filter((each) => MADE.includes(each)).map((name) => use(`Open ${name}`, name)),
      ...run.files.flatMap((name) => (name === "result.nc" ? [name, "histories.csv"] : [name])).map((name) => {
        const link = element("a", "", name);
        link.href = api.file(run.id, name);
        if (name !== "report.html") link.download = name;
        else link.target = "_blank";
        return link;
      }),
    );
    this.shown.append(links);
    if (run.state === "damaged") this.shown.append(element("p", "bad", "Its state.json is missing or damaged: what it was is not known."));
    if (run.state !== "done" && run.files.includes("messages.txt")) {
      const said = (await api.text(run.id, "messages.txt")).trim();
      if (said) this.shown.append(element("pre", "bad", said));
    }
    if (run.verb === "sweep" && run.files.includes("report.html")) {
      this.shown.append(await sweepMap(run, (id) => void this.watch(id)));
    }
    if (run.files.includes("report.html")) {
      const frame = element("iframe", "report");
      frame.title = `report of ${run.title || run.id}`;
      frame.setAttribute("sandbox", "allow-scripts");
      frame.src = api.file(run.id, "report.html");
      this.shown.append(frame);
      whole(frame);
    }
  }

  /** The figures of the runs chosen, side by side. */
  private async compare(): Promise<void> {
    const ids = [...this.compared].sort();
    const answers = await Promise.all(ids.map(async (id) => JSON.parse(await api.text(id, "answer.json")) as Answer));
    const rows = new Map<string, string[]>();
    const put = (name: string, column: number, value: string): void => {
      if (!rows.has(name)) rows.set(name, ids.map(() => "–"));
      rows.get(name)![column] = value;
    };
    answers.forEach((answer, i) => {
      for (const [name, motion] of Object.entries(answer.motions ?? {})) {
        put(`${name}: outcome`, i, motion.outcome);
        const bodies = Object.entries(motion.bodies ?? {});
        for (const [body, { tip, loads }] of bodies) {
          const of = bodies.length > 1 ? `${name}, ${body}` : name;
          if (tip?.size) put(`${of}: tip, mm`, i, format(1e3 * tip.size.max_abs));
          if (loads?.root_moment.size) put(`${of}: root moment, N m`, i, format(loads.root_moment.size.max_abs));
          if (loads?.stress?.max !== undefined) put(`${of}: stress, MPa`, i, format(1e-6 * loads.stress.max));
        }
      }
      for (const each of answer.comparisons ?? []) put("verdict", i, each.verdict);
    });
    const table = element("table", "compared");
    const head = element("tr");
    const runs = (JSON.parse(this.drawn) as [Run[]])[0];
    const names = ids.map((id) => {
      const run = runs.find((each) => each.id === id);
      return run ? `${run.title} (${[when(id), apart(run)].filter(Boolean).join("; ")})` : id;
    });
    head.append(element("td"), ...names.map((name) => element("th", "", name)));
    table.append(head);
    for (const [name, values] of rows) {
      const line = element("tr");
      line.append(element("th", "", name), ...values.map((value) => element("td", "", value)));
      table.append(line);
    }
    const box = element("div", "gbeam-wide");
    box.append(table);
    this.selected = "";
    this.shown.replaceChildren(element("h2", "", "Compared"), box);
  }
}
