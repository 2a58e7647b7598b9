// The entry: inside a report the page shows itself; in a notebook the widget calls `render`.

import "./language"; // before uPlot
import "uplot/dist/uPlot.min.css";
import "./gbeam.css";
import { render } from "./notebook";
import { readPage, showPage } from "./report";

const data = typeof document === "undefined" ? null : readPage();
if (data) showPage(data);

export default { render };
