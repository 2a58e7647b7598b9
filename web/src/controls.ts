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
