// The server's routes; every answer that is not one is an Error with what is wrong.

import type { Skin } from "../groups";

export interface Problem {
  path: string;
  /** Of the form, such as the key that is missing in a table. */
  field: string;
  message: string;
  hint: string;
  line: number | null;
}

/** A key of the schema, with what is written there: as `gbeam.app.form` has it. */
export interface Entry {
  path: string;
  key: string;
  help: string;
  required: boolean;
  written: boolean;
  kind: "value" | "table" | "list" | "named";
  options: string[];
  inside?: Entry[];
  choice?: string;
  about?: string;
  count?: number;
  value?: string;
  long?: boolean;
  default?: string;
  example?: string;
  unit?: string;
  tables?: string[];
}

export interface Document {
  text: string;
  form: Entry[];
  errors: Problem[];
  meaning: string;
}

export interface Option {
  name: string;
  help: string;
  example: string;
  choices: string[];
  many: number;
  of: string;
  /** Of the command line, of an option without a value. */
  ticked: string;
}

export interface Verb {
  about: string;
  options: Option[];
}

export interface Run {
  id: string;
  state: string;
  verb: string;
  arguments: string[];
  title: string;
  /** In the scenario of the last run of its title. */
  changes: string;
  progress: string;
  files: string[];
}

/** A record's columns, and what their names and units say of them: keys of a scenario's record; of a mesh its skin. */
export interface Head {
  name: string;
  columns: string[];
  suggested: Record<string, string>;
  skin?: Skin;
}

export interface Curves {
  time: number[];
  flights: Record<string, number[][]>;
}

/** What the server refuses, with its reasons. */
export class Refusal extends Error {
  constructor(readonly problems: Problem[]) {
    super(problems.map((each) => [each.path, each.message, each.hint].filter(Boolean).join(" ")).join("; "));
  }
}

/** Something that is wrong with no place of the document. */
export function problem(message: string): Problem {
  return { path: "", field: "", message, hint: "", line: null };
}

const KEYS = "gbeam-keys";
/** That of requests, and that in the addresses of files. */
let [key, reader] = ["", ""];

/** Take the keys from behind the address, where they are never sent, or from what the browser keeps for this port alone. */
export function takeKeys(): void {
  const given = /^#([\w-]{43}\.[\w-]{43})$/.exec(location.hash);
  if (given) {
    localStorage.setItem(KEYS, given[1]!);
    history.replaceState(null, "", "/"); // and from there into no history
  }
  [key = "", reader = ""] = (localStorage.getItem(KEYS) ?? "").split(".");
}

async function call<T>(path: string, method: string, body?: BodyInit, kind = "application/json"): Promise<T> {
  const headers = { "x-gbeam-key": key, "x-gbeam-refusal": "1", ...(body === undefined ? {} : { "content-type": kind }) };
  const response = await fetch(path, { method, headers, ...(body === undefined ? {} : { body }) }).catch(() => {
    throw new Refusal([problem("the server does not answer: start `gbeam app` again, and open the address that it prints")]);
  });
  if (response.headers.has("x-gbeam-refusal")) {
    throw new Refusal(((await response.json()) as { errors: Problem[] }).errors);
  }
  if (response.ok) return (await response.json()) as T;
  const why = response.status === 413 ? "the file is too large" : await response.text();
  throw new Refusal([problem(why || `status ${response.status}`)]);
}

const post = <T>(path: string, body: unknown): Promise<T> => call<T>(path, "POST", JSON.stringify(body));

export const api = {
  examples: () => call<string[]>("/api/examples", "GET"),
  example: (name: string) => post<Document>("/api/example", { name }),
  document: (text: string) => post<Document>("/api/document", { text }),
  edit: (text: string, path: string, value: string) => post<Document>("/api/edit", { text, path, value }),
  add: (text: string, path: string, choice: string) => post<Document>("/api/add", { text, path, choice }),
  remove: (text: string, path: string) => post<Document>("/api/remove", { text, path }),
  map: (text: string, motion: string, record: Record<string, string>) =>
    post<Document>("/api/record", { text, motion, record }),
  mesh: (text: string, body: string, mesh: Record<string, string | string[]>) =>
    post<Document>("/api/mesh", { text, body, mesh }),
  preview: (text: string) => post<Curves>("/api/preview", { text }),
  upload: (file: File) =>
    call<Head>(`/api/records/${encodeURIComponent(file.name)}`, "PUT", file, "application/octet-stream"),
  record: (name: string) => call<Head>(`/api/records/${encodeURIComponent(name)}`, "GET"),
  runs: () => call<Run[]>("/api/runs", "GET"),
  records: () => call<string[]>("/api/records", "GET"),
  verbs: () => call<Record<string, Verb>>("/api/verbs", "GET"),
  submit: (text: string, verb = "run", options: string[] = [], of = "") =>
    post<{ id: string }>("/api/runs", { text, verb, options, case: of }),
  cancel: (id: string) => call<Run>(`/api/runs/${id}`, "DELETE"),
  file: (id: string, name: string) => `/api/runs/${id}/${encodeURIComponent(name)}?key=${reader}`,
  text: async (id: string, name: string) => (await fetch(api.file(id, name))).text(),
};
