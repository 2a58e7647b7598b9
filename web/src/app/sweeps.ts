// The map of a sweep's cases, each of which opens its run.

import { css, inkOn, shade } from "../colours";
import { button, element } from "../controls";
import { format } from "../data";
import { marked } from "../maps";
import { api, type Run } from "./api";

interface Parameter {
  path: string;
  distribution: unknown;
  unit: string;
  values: (number | string)[];
}

interface Sweep {
  verb: string;
  parameters: Parameter[];
  measures: Record<string, { unit: string; values: unknown }>;
  outcomes: unknown;
  counts: Record<string, number>;
}

/** A table of a sweep's cases in the colours of its first figure; a click on one opens or starts its run. */
export async function sweepMap({ id, arguments: given }: Run, opened: (id: string) => void): Promise<HTMLElement> {
  const sweep = JSON.parse(await api.text(id, "answer.json")) as Sweep;
  const scenario = await api.text(id, "scenario.toml");
  // Of more parameters, or of values that are drawn, there is no grid: the report shows them.
  if (sweep.parameters.length > 2 || sweep.parameters.some((each) => each.distribution)) return element("div");
  const [rows, columns] = [sweep.parameters[0]!, sweep.parameters[1]];
  const [name, figure] = Object.entries(sweep.measures)[0]!;
  const entry = <T,>(values: unknown, i: number, j: number): T | null => {
    const row = (values as (T | null | (T | null)[])[])[i];
    return Array.isArray(row) ? (row[j] ?? null) : (row ?? null);
  };
  const all = (figure.values as unknown[]).flat().filter((each): each is number => typeof each === "number");
  const [low, high] = [Math.min(...all), Math.max(...all)];
  const text = (of: Parameter, k: number): string => `${of.values[k]}${of.unit ? ` ${of.unit}` : ""}`;
  const short = (of: Parameter, k: number): string => {
    const value = of.values[k]!;
    return `${typeof value === "number" ? Number(value.toPrecision(6)) : value}${of.unit ? ` ${of.unit}` : ""}`;
  };
  const problem = element("p", "bad");
  problem.setAttribute("role", "status");
  const open = async (i: number, j: number): Promise<void> => {
    problem.textContent = "";
    try {
      let made = scenario;
      for (const [of, k] of [[rows, i], [columns, j]] as const) {
        if (of) made = (await api.edit(made, of.path, text(of, k))).text;
      }
      const options = given.filter((each) => /^--(motion|at)=/.test(each)).map((each) => each.slice(2));
      opened((await api.submit(made, sweep.verb, options, `${id}/${i}/${j}`)).id);
    } catch (error) {
      problem.textContent = error instanceof Error ? error.message : String(error);
    }
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
      const value = entry<number>(figure.values, i, j);
      const outcome = entry<string>(sweep.outcomes, i, j) ?? "";
      const cell = element("td");
      const act = button(value === null ? format(value) : marked(format(value), outcome), () => void open(i, j));
      const share = value === null ? 0 : high > low ? (value - low) / (high - low) : 0.5;
      if (value !== null) {
        act.style.background = css(shade(share));
        act.style.color = inkOn(shade(share));
      }
      act.title = `${outcome}: open the run of this case`;
      cell.append(act);
      line.append(cell);
    }
    table.append(line);
  });
  const box = element("div", "gbeam-wide");
  const counts = Object.entries(sweep.counts).map(([ended, count]) => `${count} ${ended}`).join(", ");
  const about = `${name}${figure.unit ? `, ${figure.unit}` : ""}: a cell opens its run; ${counts}`;
  box.append(element("p", "faint", about), table, problem);
  return box;
}
