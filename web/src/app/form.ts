// The form of a scenario: every key that the schema has, those that are not written folded away.

import { button, choice, element } from "../controls";
import type { Entry, Problem } from "./api";

/** What the form does to the document. */
export interface Acts {
  edit(path: string, value: string): void;
  add(path: string, choice: string): void;
  remove(path: string): void;
}

/** A value of the form: its control, what is wrong with it, and the value that the document has. */
interface Field {
  input: HTMLInputElement | HTMLSelectElement;
  words: HTMLElement;
  value: string;
}

/** A unit as it is printed: kg/m³. */
export function raised(unit: string): string {
  return unit.replace(/\^([234])/g, (_, power: string) => "²³⁴"["234".indexOf(power)]!);
}

export class Form {
  readonly root = element("div", "form");
  private readonly entries = element("div");
  private readonly about = element("p", "about faint"); // what has the focus
  private fields = new Map<string, Field>();
  private heads = new Map<string, HTMLElement>(); // of tables: what is wrong with the table as a whole
  private shape = "";
  private count = 0;
  private added = "";

  constructor(private readonly acts: Acts) {
    this.root.append(this.entries, this.about);
    this.about.setAttribute("aria-hidden", "true"); // each field has its own
    this.entries.addEventListener("focusin", (e) => {
      const place = (e.target as HTMLElement).closest(".field");
      const input = place?.querySelector<HTMLElement>("[data-path]");
      this.about.textContent = input ? `${input.dataset["path"]}: ${place!.querySelector(".help")!.textContent}` : "";
    });
  }

  /** Show the entries of a document, and what is wrong at each. */
  draw(entries: Entry[], errors: Problem[]): void {
    const shape = JSON.stringify(entries, (key, value: unknown) => (key === "value" ? undefined : value));
    if (shape !== this.shape) this.build(entries);
    this.shape = shape;
    this.fill(entries);
    for (const field of this.fields.values()) this.mark(field, "");
    for (const head of this.heads.values()) head.textContent = "";
    for (const each of errors) {
      const words = [each.message, each.hint].filter(Boolean).join("; ");
      const field = this.fields.get(each.field) ?? this.fields.get(each.path);
      const head = this.heads.get(each.field) ?? this.heads.get(each.path);
      if (field) this.mark(field, words);
      else if (head) head.textContent = [head.textContent, words].filter(Boolean).join("; ");
    }
  }

  private mark({ input, words }: Field, text: string): void {
    words.textContent = text;
    if (text) {
      input.setAttribute("aria-invalid", "true");
      const folded = input.closest("details");
      if (folded) folded.open = true;
    } else input.removeAttribute("aria-invalid");
  }

  private fill(entries: Entry[]): void {
    for (const entry of entries) {
      const field = this.fields.get(entry.path);
      const value = entry.value ?? "";
      if (field) {
        // An answer may come while the next field is being typed in.
        if (field.input !== document.activeElement || field.input.value === field.value) field.input.value = value;
        field.value = value;
      }
      this.fill(entry.inside ?? []);
    }
  }

  private build(entries: Entry[]): void {
    const focused = (document.activeElement as HTMLElement | null)?.dataset["path"];
    const open = new Set([...this.entries.querySelectorAll("details[open]")].map((each) => (each as HTMLElement).dataset["of"]));
    this.fields = new Map();
    this.heads = new Map();
    const general = entries.filter((each) => each.kind === "value");
    const box = element("fieldset");
    box.append(element("legend", "", "general"), this.values(general));
    this.entries.replaceChildren(box, ...entries.filter((each) => each.kind !== "value").map((each) => this.group(each)));
    for (const each of this.entries.querySelectorAll("details")) if (open.has(each.dataset["of"])) each.open = true;
    const fresh = this.added && this.entries.querySelector<HTMLElement>(`[data-table="${CSS.escape(this.added)}"] :is(input, select)`);
    const again = focused && this.entries.querySelector<HTMLElement>(`[data-path="${CSS.escape(focused)}"]`);
    // Not within this turn: the control that was changed loses the focus at its end.
    if (fresh || again) requestAnimationFrame(() => (fresh || (again as HTMLElement)).focus());
    this.added = "";
  }

  /** A table, a list of tables, or tables by name. */
  private group(entry: Entry): HTMLElement {
    const box = element("fieldset");
    box.dataset["table"] = entry.path;
    box.append(element("legend", "", /^\d+$/.test(entry.key) ? entry.path.slice(entry.path.lastIndexOf(".") + 1) : entry.key));
    const head = element("p", "bad");
    this.heads.set(entry.path, head);
    const about = element("p", "faint", entry.about || entry.help);
    if (!entry.written) {
      box.append(about, head, this.adder(entry, entry.path, entry.options));
      return box;
    }
    const row = element("div", "gbeam-row head");
    if (entry.kind === "table" && entry.options.length > 1) {
      const options = entry.options.map((each) => [each, each] as const);
      const select = choice("kind", entry.choice ? options : [["", "choose"], ...options], entry.choice ?? "", (word) => {
        if (word) this.add(entry.path, word);
      });
      select.querySelector("select")!.dataset["path"] = `${entry.path}:`;
      row.append(select);
    }
    if (!entry.required) {
      const remove = button("Remove", () => this.acts.remove(entry.path));
      remove.setAttribute("aria-label", `Remove ${entry.path}`);
      row.append(remove);
    }
    row.prepend(about);
    box.append(row, head);
    const inside = entry.inside ?? [];
    if (entry.kind === "table") this.table(box, entry, inside);
    else {
      // Of tables by name some may be written as a value, such as a direction.
      const values = inside.filter((each) => each.kind === "value" && each.written);
      if (values.length) box.append(this.values(values));
      box.append(...inside.filter((each) => !values.includes(each)).map((each) => this.group(each)));
      const rest = (entry.count ?? inside.length) - inside.length;
      if (rest > 0) box.append(element("p", "faint", `and ${rest} more: see the text`));
      const next = `${entry.path}[${entry.count}]`;
      box.append(entry.kind === "list" ? this.adder(entry, next, entry.options, `to ${entry.key}`) : this.namer(entry));
    }
    return box;
  }

  /** What a table holds: what is written or has to be, then all else that may be. */
  private table(box: HTMLElement, entry: Entry, inside: Entry[]): void {
    const shown = inside.filter((each) => each.written || each.required);
    const rest = inside.filter((each) => !each.written && !each.required);
    box.append(this.values(shown.filter((each) => each.kind === "value")));
    box.append(...shown.filter((each) => each.kind !== "value").map((each) => this.group(each)));
    if (!rest.length) return;
    const folded = element("details");
    folded.dataset["of"] = entry.path;
    if (!shown.length) folded.open = true;
    folded.append(element("summary", "", `More: ${rest.map((each) => each.key).join(", ")}`));
    folded.append(this.values(rest.filter((each) => each.kind === "value")));
    for (const each of rest.filter((other) => other.kind !== "value")) {
      const path = each.kind === "list" ? `${each.path}[0]` : each.path;
      const line = this.adder(each, path, each.options);
      line.append(element("span", "faint", each.help));
      folded.append(line);
    }
    box.append(folded);
  }

  private values(entries: Entry[]): HTMLElement {
    const grid = element("div", "values");
    grid.append(...entries.map((each) => this.field(each)));
    return grid;
  }

  private field(entry: Entry): HTMLElement {
    const place = element("div", "field");
    const label = element("label");
    const name = element("span", "", entry.key);
    const facts = [raised(entry.unit ?? ""), entry.required && !entry.written ? "required" : ""].filter(Boolean);
    if (facts.length) name.append(element("span", "faint", `, ${facts.join(", ")}`));
    const input = entry.options.length ? this.select(entry) : this.typed(entry);
    input.dataset["path"] = entry.path;
    input.addEventListener("change", () => this.acts.edit(entry.path, input.value));
    label.append(name, input);
    const words = element("span", "bad");
    words.id = `problem-${this.count}`;
    const help = element("span", "help faint", entry.help);
    help.id = `help-${this.count++}`;
    input.setAttribute("aria-describedby", `${words.id} ${help.id}`);
    place.append(label, words, help);
    // Kinds of profiles have names; a direction of an arm is a table of one kind.
    const form = entry.tables?.[0] ? "as a profile" : "as a table";
    if (entry.tables?.length) place.append(this.adder(entry, entry.path, entry.tables, form));
    this.fields.set(entry.path, { input, words, value: "" });
    return place;
  }

  private typed(entry: Entry): HTMLInputElement {
    const input = element("input");
    input.placeholder = entry.default ? entry.default : entry.example ? `such as ${entry.example}` : "";
    if (entry.long) {
      input.disabled = true;
      input.placeholder = "long: see the text";
    }
    return input;
  }

  private select(entry: Entry): HTMLSelectElement {
    const select = element("select");
    const first = entry.default ? `${entry.default} (default)` : entry.required ? "choose" : "left out";
    for (const [value, text] of [["", first], ...entry.options.map((each) => [each, each])]) {
      const option = element("option", "", text);
      option.value = value!;
      select.append(option);
    }
    // What is written and is none of the options is shown all the same.
    if (entry.value && !entry.options.includes(entry.value)) select.append(new Option(entry.value, entry.value));
    return select;
  }

  private adder(entry: Entry, path: string, options: string[], words = `${entry.key}`): HTMLElement {
    const row = element("div", "gbeam-row add");
    let chosen = options[0] ?? "";
    const act = button(`Add ${words}`, () => this.add(path, chosen));
    act.dataset["path"] = `${path}+`;
    if (words.startsWith("as a ")) act.setAttribute("aria-label", `Add ${entry.path} ${words}`);
    if (options.length > 1) {
      const select = choice("", options.map((each) => [each, each]), chosen, (word) => {
        chosen = word;
      });
      select.querySelector("select")!.setAttribute("aria-label", `kind of ${path}`);
      row.append(select);
    }
    row.append(act);
    return row;
  }

  /** A new table by a name that is typed. */
  private namer(entry: Entry): HTMLElement {
    const label = element("label", "", "name ");
    const name = element("input");
    name.dataset["path"] = `${entry.path}.`;
    label.append(name);
    const row = this.adder(entry, "", entry.options);
    const act = row.querySelector("button")!;
    const select = row.querySelector("select");
    const fresh = act.cloneNode(true) as HTMLButtonElement;
    fresh.addEventListener("click", () => {
      if (name.value.trim()) this.add(`${entry.path}.${name.value.trim()}`, select?.value ?? "");
      else name.focus();
    });
    act.replaceWith(fresh);
    row.prepend(label);
    return row;
  }

  private add(path: string, word: string): void {
    this.added = path;
    this.acts.add(path, word);
  }
}
