// Plain HTML controls, each with its name.

export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  name = "",
  text = "",
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  if (name) made.className = name;
  if (text) made.textContent = text;
  return made;
}

export function button(text: string, act: () => void): HTMLButtonElement {
  const made = element("button", "", text);
  made.type = "button";
  made.addEventListener("click", act);
  return made;
}

export function choice(
  name: string,
  options: (readonly [string, string])[],
  value: string,
  act: (value: string) => void,
): HTMLLabelElement {
  const label = element("label", "", `${name} `);
  const select = element("select");
  for (const [key, text] of options) {
    const option = element("option", "", text);
    option.value = key;
    select.append(option);
  }
  select.value = value;
  select.addEventListener("change", () => act(select.value));
  label.append(select);
  return label;
}

export function tick(name: string, value: boolean, act: (on: boolean) => void): HTMLLabelElement {
  const label = element("label");
  const box = element("input");
  box.type = "checkbox";
  box.checked = value;
  box.addEventListener("change", () => act(box.checked));
  label.append(box, ` ${name}`);
  return label;
}

/** Boxes that scroll across are come to by the Tab key, so that arrow keys scroll them; others are not. */
export function reachable(root: HTMLElement): void {
  const judge = (): void => {
    for (const box of root.querySelectorAll<HTMLElement>(".gbeam-wide")) {
      const scrolls = box.scrollWidth > box.clientWidth;
      if (!scrolls) for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
      else {
        box.tabIndex = 0;
        box.setAttribute("role", "group");
        box.setAttribute("aria-label", box.querySelector("caption, th")?.textContent || "table");
      }
    }
  };
  new ResizeObserver(judge).observe(root);
}
