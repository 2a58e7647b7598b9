// The mesh of a body: in which unit its coordinates are, and which of its groups the base holds.

import { button, choice, element, tick } from "../controls";
import { extent } from "../groups";
import type { SkinView } from "../skin";
import { api, type Entry, type Head } from "./api";

/** A body of the document that is a mesh, with what is written of it. */
export interface MeshBody {
  name: string;
  file: string;
  unit: string;
  clamp: string[];
}

/** The meshes among the entries of a form. */
export function meshesOf(form: Entry[]): MeshBody[] {
  const bodies = form.find((each) => each.path === "bodies")?.inside ?? [];
  return bodies.flatMap((body) => {
    const written = (key: string): string => body.inside?.find((each) => each.key === key && each.written)?.value ?? "";
    const file = written("mesh");
    return file ? [{ name: body.key, file, unit: written("unit"), clamp: listed(written("clamp")) }] : [];
  });
}

/** One text, or a list of texts as TOML has it. */
export function listed(value: string): string[] {
  if (!value.startsWith("[")) return value ? [value] : [];
  return [...value.matchAll(/"((?:[^"\\]|\\.)*)"|'([^']*)'/g)].map((each) => each[2] ?? (JSON.parse(`"${each[1]}"`) as string));
}

/** A name of a body from that of a file. */
export function bodyName(file: string): string {
  const plain = file.replace(/\.[^.]*$/, "").replace(/\W+/g, "_");
  return /^[A-Za-z]/.test(plain) ? plain : `body_${plain}`;
}

const UNITS = ["mm", "cm", "m", "in", "ft"].map((each) => [each, each] as const);

export class MeshPanel {
  readonly root = element("div", "record mesh");
  private bodies: MeshBody[] = [];
  private body = ""; // that is shown, of several
  /** What has been dropped on the page and is no body yet. */
  private dropped: Head | null = null;
  private shown = "";
  private view: SkinView | null = null;

  /** `use` makes a mesh a body of the document, and says whether it does. */
  constructor(private readonly use: (body: string, mesh: Record<string, string | string[]>) => Promise<boolean>) {}

  /** Offer a file that has been dropped. */
  open(head: Head): void {
    this.dropped = head;
    this.shown = head.name;
    this.draw(head, { name: bodyName(head.name), file: head.name, unit: "", clamp: [] });
  }

  /** Show the mesh of the document, unless one that was dropped waits to be used. */
  async offer(bodies: MeshBody[]): Promise<void> {
    this.bodies = bodies;
    if (this.dropped) return;
    const body = bodies.find((each) => each.name === this.body) ?? bodies[0];
    const now = JSON.stringify([body, bodies.map((each) => each.name)]);
    if (now === this.shown) return;
    this.shown = now;
    if (!body) this.clear();
    else {
      const head = await api.record(body.file).catch(() => null); // what is wrong is said of the document
      if (now !== this.shown) return; // overtaken
      if (head?.skin) this.draw(head, body);
      else this.clear();
    }
  }

  private clear(): void {
    this.view?.dispose();
    this.view = null;
    this.root.replaceChildren();
  }

  private draw(head: Head, body: MeshBody): void {
    this.clear();
    const skin = head.skin!;
    const chosen = { ...body, clamp: new Set(body.clamp) };
    const named = this.dropped ? element("label", "", "Body ") : this.which(body.name);
    if (this.dropped) {
      const name = element("input");
      name.value = chosen.name;
      named.append(name);
      name.addEventListener("input", () => {
        chosen.name = name.value.trim();
        judge();
      });
    }
    const units = body.unit && !UNITS.some(([unit]) => unit === body.unit) ? [[body.unit, body.unit] as const, ...UNITS] : UNITS;
    const unit = choice("Unit of the coordinates", [["", "choose"], ...units], body.unit, (value) => {
      chosen.unit = value;
      judge();
    });
    const size = element("span", "faint");
    const ready = element("span", "faint");
    const act = button(this.dropped ? "Use this mesh" : "Change the mesh", () => void this.take(head, chosen));
    const list = element("fieldset");
    list.append(element("legend", "", "Clamped groups"));
    const boxes = new Map<string, HTMLInputElement>();
    const set = (group: string, on: boolean): void => {
      if (on) chosen.clamp.add(group);
      else chosen.clamp.delete(group);
      const box = boxes.get(group);
      if (box) box.checked = on;
      this.view?.show(chosen.clamp);
      judge();
    };
    for (const group of skin.groups) {
      const label = tick(`${group.name}, ${group.nodes} nodes`, chosen.clamp.has(group.name), (on) => set(group.name, on));
      boxes.set(group.name, label.querySelector("input")!);
      list.append(label);
    }
    if (!skin.groups.length) list.append(element("p", "bad", "the mesh has no groups: name in it the nodes or faces that are held, and drop it again"));
    const judge = (): void => {
      const edges = extent(skin.vertices).map((each) => Number(each.toPrecision(3)));
      size.textContent = `${edges.join(" × ")} ${chosen.unit}`.trim();
      const lacks = [
        /^[A-Za-z]\w*$/.test(chosen.name) ? "" : "name the body by letters, digits and _",
        chosen.unit ? "" : "choose the unit",
        chosen.clamp.size ? "" : "choose what is clamped",
      ].find(Boolean);
      ready.textContent = lacks ?? "";
      act.disabled = lacks !== undefined;
    };
    const stage = element("div", "skin");
    const words = this.dropped ? `Mesh ${head.name}, not used yet` : `Mesh of ${body.name}: ${head.name}`;
    this.root.replaceChildren(
      element("h3", "", words),
      element("p", "faint", "Click what is clamped, in the view or in the list; drag turns the view."),
      this.row(named, unit, size),
      stage,
      list,
      this.row(act, ready),
    );
    judge();
    void import("gbeam").then(({ SkinView }) => {
      if (!stage.isConnected) return;
      this.view = SkinView.mount(stage, skin, (group) => set(group, !chosen.clamp.has(group)));
      this.view?.show(chosen.clamp);
    });
  }

  /** Which of the bodies that are meshes is shown. */
  private which(name: string): HTMLLabelElement {
    return choice("Body", this.bodies.map((each) => [each.name, each.name] as const), name, (value) => {
      this.body = value;
      void this.offer(this.bodies);
    });
  }

  private async take(head: Head, chosen: { name: string; unit: string; clamp: Set<string> }): Promise<void> {
    const waiting = this.dropped;
    this.dropped = null; // the document that comes back shows it
    const groups = [...chosen.clamp];
    const clamp = groups.length === 1 ? groups[0]! : groups;
    if (await this.use(chosen.name, { mesh: head.name, unit: chosen.unit, clamp })) return;
    this.dropped = waiting;
  }

  private row(...parts: HTMLElement[]): HTMLElement {
    const row = element("div", "gbeam-row");
    row.append(...parts);
    return row;
  }
}
