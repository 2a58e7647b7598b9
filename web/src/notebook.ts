// The viewer in a notebook, as an anywidget: the same data, over the notebook's own connection.

import type { Data, Header } from "./data";
import { element } from "./controls";
import { showModesIn } from "./report";
import { Viewer } from "./viewer";

interface Model {
  get(name: "header"): string;
  get(name: "numbers"): DataView;
}

export function render({ model, el }: { model: Model; el: HTMLElement }): () => void {
  const packed = model.get("numbers");
  const bytes = packed.buffer.slice(packed.byteOffset, packed.byteOffset + packed.byteLength) as ArrayBuffer;
  const data: Data = { header: JSON.parse(model.get("header")) as Header, numbers: new Float32Array(bytes) };
  const place = element("div", "gbeam-widget");
  el.append(place);
  if (data.header.modes) return showModesIn(place, data).dispose;
  const viewer = Viewer.mount(place, data);
  return () => viewer?.dispose();
}
