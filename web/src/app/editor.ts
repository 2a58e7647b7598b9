// The scenario: as a form and as text, two views of one document, which the server reads after every change.

import uPlot from "uplot";
import { lineColour, prefersDark } from "../colours";
import { button, choice, element } from "../controls";
import { axisStyle } from "../plots";
import { api, type Document, type Problem, problem, Refusal, type Verb } from "./api";
import { fileName } from "./command";
import { Form } from "./form";
import { MeshPanel, meshesOf } from "./mesh";
import { flightsOf, RecordPanel } from "./record";
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
  private readonly record = new RecordPanel(async (motion, record) => {
    const used = await this.take(api.map(this.document.text, motion, record));
    if (used) await this.preview();
    return used;
  });
  private readonly mesh = new MeshPanel((body, mesh) => this.take(api.mesh(this.document.text, body, mesh)));
  private readonly curves = element("div");
  private readonly views: HTMLButtonElement[];
  private readonly look: HTMLButtonElement;
  private readonly verbs: Verbs;
  private changes: Promise<unknown> = Promise.resolve();
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
    this.root.append(this.start(), this.record.root, this.mesh.root, this.verbs.root, this.row(...this.views, ...acts), this.problems);
    this.root.append(this.curves, this.form.root, this.text, this.meaning);
    this.show(0);
  }

  /** Take up the document of the last visit, or the first example. */
  async begin(examples: string[], verbs: Record<string, Verb>): Promise<void> {
    this.verbs.begin(verbs);
    await this.verbs.refresh();
    const kept = sessionStorage.getItem(KEPT);
    await this.take(kept === null ? api.example(examples[0]!) : api.document(kept));
    const options = ["", ...examples].map((name) => [name, name || "choose"] as const);
    const select = choice("Start from", options, "", (name) => {
      if (name) void this.take(api.example(name)).then(() => this.verbs.refresh());
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
      if (made.text !== this.document.text) this.curves.replaceChildren(); // those of the text before
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
    void this.record.offer(flightsOf(form));
    void this.mesh.offer(meshesOf(form));
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
    const label = element("label", "", "Scenario, record or mesh ");
    const input = element("input");
    input.type = "file";
    input.addEventListener("change", () => void this.open(input.files));
    label.append(input);
    row.append(label, element("span", "faint", "or drop it on the page"));
    // Anywhere: a file that the page does not take the browser opens in its place.
    document.addEventListener("dragover", (e) => e.preventDefault());
    document.addEventListener("drop", (e) => {
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
          const head = await api.upload(file);
          if (head.skin) this.mesh.open(head);
          else this.record.open(head);
          await this.verbs.refresh();
        }
      } catch (error) {
        this.complain(error);
      }
    }
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
