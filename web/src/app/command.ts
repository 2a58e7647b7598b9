// What the page does, as a command line to copy.

import { button, element } from "../controls";

/** Words as a POSIX shell takes them. */
export function quoted(words: string[]): string[] {
  return words.map((each) => (/^[\w.,:=/@%+-]+$/.test(each) ? each : `'${each.replaceAll("'", "'\\''")}'`));
}

/** What a document is called as a file, by its language. */
export function fileName(text: string): string {
  return text.trimStart().startsWith("{") ? "scenario.json" : "scenario.toml";
}

export class Command {
  readonly root = element("div", "gbeam-row command");
  private readonly line = element("code");
  private readonly copy = button("Copy", () => void this.put());

  constructor(words: string[]) {
    this.root.append(element("span", "faint", "As a command:"), this.line, this.copy);
    this.say(words);
  }

  say(words: string[]): void {
    // Lines break between words.
    this.line.replaceChildren(...quoted(words).flatMap((each, i) => [...(i ? [" "] : []), element("span", "", each)]));
    this.copy.textContent = "Copy";
  }

  private async put(): Promise<void> {
    try {
      await navigator.clipboard.writeText(this.line.textContent ?? "");
      this.copy.textContent = "Copied";
    } catch {
      getSelection()?.selectAllChildren(this.line); // where the browser keeps its clipboard from pages
    }
  }
}
