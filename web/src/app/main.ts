// The page of `gbeam app`.

import "../language"; // before uPlot
import "uplot/dist/uPlot.min.css";
import "../gbeam.css";
import "./app.css";
import { reachable } from "../controls";
import { api, takeKeys } from "./api";
import { Editor } from "./editor";
import { Runs } from "./runs";

takeKeys();
const root = document.getElementById("app")!;
const runs: Runs = new Runs((text) => void editor.read(text));
const editor: Editor = new Editor((id) => void runs.watch(id));
root.append(editor.root, runs.root);
reachable(root);
await editor.begin(...(await Promise.all([api.examples(), api.verbs()])));
await runs.watch();
document.documentElement.dataset["gbeam"] = "drawn";
