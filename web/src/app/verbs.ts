// What to do with the scenario: a verb of the command line and its options, and the line that does the same.

import { button, choice, element, tick } from "../controls";
import { api, type Entry, type Option, type Problem, Refusal, type Verb } from "./api";
import { Command, fileName } from "./command";

/** All values of a form that are written. */
export function written(entries: Entry[]): Entry[] {
  return entries.flatMap((each) => (each.kind === "value" ? (each.written ? [each] : []) : written(each.inside ?? [])));
}

/** What is typed for one option; `path` is that of a value that varies. */
interface Given {
  option: Option;
  path: string;
  value: string;
}

export class Verbs {
  readonly root = element("section", "verbs");
  private verbs: Record<string, Verb> = {};
  private verb = "run";
  private given: Given[] = [];
  private entries: Entry[] = [];
  private records: string[] = [];
  private offered = "";
  private readonly about = element("p", "faint");
  private readonly place = element("div", "values");
  private readonly problems = element("p", "bad");
  private readonly run = button("Run", () => void this.submit());
  private readonly head = element("div", "gbeam-row");
  private readonly command = new Command([]);

  constructor(
    private readonly text: () => string,
    private readonly submitted: (id: string) => void,
  ) {
    this.run.classList.add("primary");
    this.problems.setAttribute("role", "status");
    this.head.append(this.run);
    this.root.append(this.head, this.about, this.place, this.problems, this.command.root);
  }

  begin(verbs: Record<string, Verb>): void {
    this.verbs = verbs;
    const names = Object.keys(verbs).map((each) => [each, each] as const);
    this.head.prepend(choice("Compute", names, this.verb, (verb) => this.choose(verb)));
    this.choose(this.verb);
  }

  /** Offer the files that are kept. */
  async refresh(): Promise<void> {
    this.records = await api.records();
    this.draw();
  }

  /** Offer the motions and the values of a document; nothing is run while it is wrong. */
  offer(entries: Entry[], sound: boolean): void {
    this.run.disabled = !sound;
    this.entries = entries;
    const offered = JSON.stringify([this.motions(), this.paths()]);
    if (offered === this.offered) return this.say();
    this.offered = offered;
    this.draw();
  }

  private choose(verb: string): void {
    this.verb = verb;
    this.problems.textContent = "";
    this.about.textContent = this.verbs[verb]!.about;
    this.given = this.verbs[verb]!.options.flatMap((option) =>
      Array.from({ length: option.many }, () => ({ option, path: "", value: "" })),
    );
    this.draw();
  }

  private motions(): string[] {
    return this.entries.find((each) => each.path === "motion")?.inside?.map((each) => each.key) ?? [];
  }

  private paths(): string[] {
    return written(this.entries).map((each) => each.path).filter((path) => !path.endsWith(".file") && path !== "title");
  }

  private draw(): void {
    this.place.replaceChildren(...this.given.map((each) => this.line(each)));
    this.say();
  }

  /** One option as a field; of a value that varies its path and its values. */
  private line(given: Given): HTMLElement {
    const { option } = given;
    const place = element("div", "field");
    const put = (value: string): void => {
      given.value = value;
      this.say();
    };
    if (option.ticked) {
      place.append(tick(option.name, given.value !== "", (on) => put(on ? option.ticked : "")), element("span", "faint", option.help));
      return place;
    }
    const words = option.of === "motion" ? this.motions() : option.of === "record" ? this.records : option.choices;
    if (words.length || option.of === "record") {
      if (!words.includes(given.value)) given.value = "";
      place.append(choice(option.name, [["", "left out"], ...words.map((each) => [each, each] as const)], given.value, put));
    } else {
      if (option.of === "values") {
        const paths = this.paths();
        if (!paths.includes(given.path)) given.path = "";
        const offered = [["", "nothing"] as const, ...paths.map((path) => [path, path] as const)];
        place.append(
          choice("vary", offered, given.path, (path) => {
            given.path = path;
            this.say();
          }),
        );
      }
      const label = element("label", "", `${option.name} `);
      const input = element("input");
      input.value = given.value;
      input.placeholder = `such as ${option.example.slice(option.of === "values" ? option.example.indexOf("=") + 1 : 0)}`;
      input.addEventListener("input", () => put(input.value));
      label.append(input);
      place.append(label);
    }
    place.append(element("span", "faint", option.help));
    return place;
  }

  /** The options that are given, each as the server takes it and as the command line has it. */
  private options(): { name: string; line: string }[] {
    const sound = this.given.filter((each) => each.value.trim() && (each.option.of !== "values" || each.path));
    return sound.map(({ option, path, value }) => {
      if (option.ticked) return { name: option.name, line: option.ticked };
      const name = `${option.name}=${option.of === "values" ? `${path}=` : ""}${value}`;
      return { name, line: `--${name}` };
    });
  }

  private say(): void {
    const options = this.options().map((each) => each.line);
    this.command.say(["gbeam", this.verb, fileName(this.text()), ...options, "--report"]);
  }

  private async submit(): Promise<void> {
    this.problems.textContent = "";
    try {
      this.submitted((await api.submit(this.text(), this.verb, this.options().map((each) => each.name))).id);
    } catch (error) {
      const found: Problem[] = error instanceof Refusal ? error.problems : [];
      const lines = found.map((each) => [each.path, each.message, each.hint && `(${each.hint})`].filter(Boolean).join(" "));
      this.problems.textContent = lines.join("; ") || String(error);
    }
  }
}
