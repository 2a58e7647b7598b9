// A sweep over two parameters: a table whose cells have the colour of their value.

import { css, GRADIENT, inkOn, shade } from "./colours";
import { element } from "./controls";
import { type Data, format, type HeatMap, view } from "./data";

const MARK = " ✗";

/** A figure as a map shows it: marked where its case, though computed, is not accepted. */
export function marked(figure: string, outcome: string): string {
  return outcome === "done" ? figure : figure + MARK;
}

export function heatMap(root: HTMLElement, data: Data, spec: HeatMap): void {
  const values = view(data.numbers, spec.values);
  const known = [...values].filter(Number.isFinite);
  const [low, high] = [Math.min(...known), Math.max(...known)];
  const table = element("table", "gbeam-map");
  const head = element("tr");
  head.append(element("th", "", `${spec.y.label} \\ ${spec.x.label}`));
  for (const tick of spec.x.ticks) head.append(element("th", "", tick));
  table.append(head);
  spec.y.ticks.forEach((tick, row) => {
    const line = element("tr");
    line.append(element("th", "", tick));
    spec.x.ticks.forEach((_, column) => {
      const i = column * spec.y.ticks.length + row;
      const value = values[i]!;
      const outcome = spec.outcomes[i]!;
      const cell = element("td", "", Number.isFinite(value) ? marked(format(value), outcome) : outcome);
      cell.title = outcome;
      if (Number.isFinite(value)) {
        const share = high > low ? (value - low) / (high - low) : 0.5;
        cell.style.background = css(shade(share));
        cell.style.color = inkOn(shade(share));
      }
      line.append(cell);
    });
    table.append(line);
  });
  const box = element("div", "gbeam-wide");
  box.append(table);
  root.append(box);
  if (!known.length) return;
  const legend = element("div", "gbeam-legend");
  const bar = element("span", "gbeam-bar");
  bar.style.background = GRADIENT;
  legend.append(element("span", "", format(low)), bar, element("span", "", `${format(high)} ${spec.unit}`));
  if (spec.outcomes.some((each, i) => marked("", each) && Number.isFinite(values[i]!))) {
    legend.append(element("span", "", `${MARK.trim()}: does not keep its limits`));
  }
  root.append(legend);
}
