// The scenario: as a form and as text, two views of one document, which the server reads after every change.

import uPlot from "uplot";
import { lineColour, prefersDark } from "../colours";
import { button, choice, element } from "../controls";
import { axisStyle } from "../plots";
import { api, type Document, type Problem, problem, Refusal, type Verb } from "./api";
import { fileName } from "./command";
import { Form } from "./form";
import { Verbs } from "./verbs";

const KEPT = "gbeam-document";
const PAUSE = 400; // ms without a key before the text is read
const COMPONENTS = ["x", "y", "z"] as const;

let held: Promise<void> | null = null;
window.addEventListener("pointerdown", () => {
  held = new Promise((done) => {
    for (const end of ["pointerup", "pointercancel"]) {
      window.addEventListener(end, () => window.setTimeout(done), { once: true });
    }
  });
});

/** Once no button of the mouse is held down, and what it did is done. */
async function released(): Promise<void> {
  await held;
}

export class Editor {
  readonly root = element("section");
  private document: Document = { text: "", form: [], errors: [], meaning: "" };
  private readonly text = element("textarea", "text");
  private readonly form = new Form({
    edit: (path, value) => this.change((text) => api.edit(text, path, value)),
    add: (path, kind) => this.change((text) => api.add(text, path, kind)),
    remove: (path) => this.change((text) => api.remove(text, path)),
  });
  private readonly problems = element("div", "problems");
  private readonly meaning = element("pre");
  private readonly record = element("div", "record");
  private readonly curves = element("div");
  private readonly views: HTMLButtonElement[];
  private readonly look: HTMLButtonElement;
  private readonly verbs: Verbs;
  private changes: Promise<unknown> = Promise.resolve();
  private offerFlights: (flights: string[]) => void = () => {};
  private waiting = 0;
  private latest = 0;

  constructor(submitted: (id: string) => void) {
    this.root.append(element("h2", "", "Scenario"));
    this.text.setAttribute("aria-label", "scenario as TOML");
    this.text.spellcheck = false;
    this.text.addEventListener("input", () => {
      window.clearTimeout(this.waiting);
      this.waiting = window.setTimeout(() => void this.read(this.text.value), PAUSE);
    });
    this.views = [button("Form", () => this.show(0)), button("Text", () => this.show(1))];
    this.problems.setAttribute("role", "status");
    this.look = button("Preview load", () => void this.preview());
    const acts = [this.look, button("Download", () => this.save())];
    this.verbs = new Verbs(() => this.document.text, submitted);
    this.root.append(this.start(), this.record, this.verbs.root, this.row(...this.views, ...acts), this.problems);
    this.root.append(this.curves, this.form.root, this.text, this.meaning);
    this.show(0);
  }

  /** Take up the document of the last visit, or the first example. */
  async begin(examples: Record<string, string>, verbs: Record<string, Verb>): Promise<void> {
    this.verbs.begin(verbs);
    await this.verbs.refresh();
    await this.read(sessionStorage.getItem(KEPT) ?? Object.values(examples)[0] ?? "");
    const options = [["", "choose"], ...Object.keys(examples).map((name) => [name, name])] as [string, string][];
    const select = choice("Start from", options, "", (name) => {
      if (examples[name]) void this.read(examples[name]);
    });
    this.root.querySelector(".start")!.prepend(select);
  }

  /** Show a text, and what the server says of it. */
  async read(text: string): Promise<void> {
    await this.take(api.document(text));
  }

  /** Change the document: one change after the other, each of what the last has made. */
  private change(act: (text: string) => Promise<Document>): void {
    this.changes = this.changes.then(() => this.take(act(this.document.text)));
  }

  /** Show what becomes of the document; whether it has been taken. */
  private async take(answer: Promise<Document>): Promise<boolean> {
    const number = ++this.latest;
    try {
      const made = await answer;
      await released(); // a click on what is made again before its end would be lost
      if (number !== this.latest) return false; // a later change has overtaken it
      this.document = made;
      sessionStorage.setItem(KEPT, made.text);
      if (this.text.value !== made.text) this.text.value = made.text;
      this.draw();
      return true;
    } catch (error) {
      this.complain(error);
      return false;
    }
  }

  private draw(): void {
    const { form, errors, meaning } = this.document;
    this.form.draw(form, errors);
    this.verbs.offer(form, errors.length === 0);
    this.look.disabled = errors.length > 0;
    this.offerFlights(this.flights());
    this.list(errors);
    this.meaning.textContent = meaning;
    this.meaning.hidden = !meaning;
  }

  private list(errors: Problem[]): void {
    this.problems.replaceChildren();
    for (const each of errors) {
      const where = [each.line ? `line ${each.line}` : "", each.path].filter(Boolean).join(", ");
      this.problems.append(element("p", "bad", `${where ? `${where}: ` : ""}${each.message}${each.hint ? `; ${each.hint}` : ""}`));
    }
  }

  private complain(error: unknown): void {
    this.list(error instanceof Refusal ? error.problems : [problem(String(error))]);
  }

  private show(which: number): void {
    this.form.root.hidden = which !== 0;
    this.text.hidden = which !== 1;
    this.views.forEach((each, i) => each.setAttribute("aria-pressed", String(i === which)));
  }

  private save(): void {
    const link = element("a");
    link.href = URL.createObjectURL(new Blob([this.document.text], { type: "text/plain" }));
    link.download = fileName(this.document.text);
    link.click();
    URL.revokeObjectURL(link.href);
  }

  private start(): HTMLElement {
    const row = this.row();
    row.classList.add("start");
    const label = element("label", "", "Scenario or record ");
    const input = element("input");
    input.type = "file";
    input.addEventListener("change", () => void this.open(input.files));
    label.append(input);
    row.append(label);
    this.root.addEventListener("dragover", (e) => e.preventDefault());
    this.root.addEventListener("drop", (e) => {
      e.preventDefault();
      void this.open(e.dataTransfer?.files ?? null);
    });
    return row;
  }

  private async open(files: FileList | null): Promise<void> {
    for (const file of files ?? []) {
      try {
        if (/\.(toml|json)$/i.test(file.name)) await this.read(await file.text());
        else {
          this.map(await api.upload(file));
          await this.verbs.refresh();
        }
      } catch (error) {
        this.complain(error);
      }
    }
  }

  private flights(): string[] {
    const motions = this.document.form.find((each) => each.path === "motion")?.inside ?? [];
    return motions.filter((each) => each.choice === "flight").map((each) => each.key);
  }

  /** Columns, signs and units of a record, by hand; what is chosen stays as the flights change. */
  private map({ name, columns }: { name: string; columns: string[] }): void {
    const chosen: Record<string, string> = { file: name, time: columns[0] ?? "", x: "0", y: "0", z: "0", unit: "g" };
    const listed = columns.map((each) => [each, each] as const);
    const signed = [["0", "none"] as const, ...listed, ...columns.map((each) => [`-${each}`, `−${each}`] as const)];
    const set = (key: string) => (value: string) => {
      if (value) chosen[key] = value;
      else delete chosen[key];
    };
    const parts = [
      choice("Time", listed, chosen["time"]!, set("time")),
      choice("Time in", [["", "the file's unit, or s"], ...["s", "ms", "us", "min"].map((each) => [each, each] as const)], "", set("time_unit")),
      ...COMPONENTS.map((key) => choice(`${key} is`, signed, "0", set(key))),
      choice("Unit", [["g", "g"], ["m/s^2", "m/s²"]], "g", set("unit")),
      choice("Holds", [["specific-force", "specific force"], ["acceleration", "acceleration"]], "specific-force", set("quantity")),
    ];
    const which = element("span");
    const act = button("Use this record", () => void use());
    let motion = "";
    const use = async (): Promise<void> => {
      if (await this.take(api.map(this.document.text, motion, chosen))) await this.preview();
    };
    let offered: string | null = null;
    this.offerFlights = (flights) => {
      if (offered === flights.join("\n")) return; // nothing that has the focus is made again without need
      offered = flights.join("\n");
      if (!flights.includes(motion)) motion = flights[0] ?? "";
      act.disabled = !motion;
      const none = element("span", "bad", "the scenario has no flight that could follow it: add a motion of that kind");
      which.replaceChildren(motion ? choice("Flight", flights.map((each) => [each, each]), motion, (value) => (motion = value)) : none);
    };
    this.offerFlights(this.flights());
    this.record.replaceChildren(element("h3", "", `Record ${name}`), this.row(which, ...parts, act));
  }

  private async preview(): Promise<void> {
    this.curves.replaceChildren();
    if (this.document.errors.length) return; // which are said
    try {
      const { time, flights } = await api.preview(this.document.text);
      for (const [name, parts] of Object.entries(flights)) {
        this.curves.append(element("h3", "", `${name}: load in base axes`));
        const place = element("div");
        this.curves.append(place);
        const dark = prefersDark();
        const axis = axisStyle(dark);
        const series = COMPONENTS.map((label, i) => ({ label, stroke: lineColour(i, dark), width: 1.3 }));
        new uPlot(
          {
            width: Math.max(280, this.root.clientWidth),
            height: 200,
            scales: { x: { time: false } },
            axes: [{ ...axis, label: "time, s", size: 34 }, { ...axis, label: "load, g", size: 62 }],
            series: [{ label: "time, s" }, ...series],
          },
          [time, ...parts] as uPlot.AlignedData,
          place,
        );
      }
    } catch (error) {
      this.complain(error);
    }
  }

  private row(...parts: HTMLElement[]): HTMLElement {
    const row = element("div", "gbeam-row");
    row.append(...parts);
    return row;
  }
}
