// The entry: inside a report the page shows itself; in a notebook the widget calls `render`; the app shows a mesh.

import "./language"; // before uPlot
import "uplot/dist/uPlot.min.css";
import "./gbeam.css";
import { render } from "./notebook";
import { readPage, showPage } from "./report";

const data = typeof document === "undefined" ? null : readPage();
if (data) {
  // Words and tables are painted first: views and plots take a second or two without a graphics card.
  let drawn = false;
  const draw = (): void => {
    if (!drawn) showPage(data);
    drawn = true;
  };
  requestAnimationFrame(() => setTimeout(draw));
  window.addEventListener("beforeprint", draw); // which may come before any frame
}

export { SkinView } from "./skin";
export default { render };
