// The server's routes; every answer that is not one is an Error with what is wrong.

export interface Problem {
  path: string;
  message: string;
  hint: string;
  line: number | null;
}

export interface Field {
  path: string;
  value: string;
  help: string;
}

export interface Document {
  text: string;
  fields: Field[];
  errors: Problem[];
  meaning: string;
}

export interface Run {
  id: string;
  state: string;
  verb: string;
  title: string;
  progress: string;
  files: string[];
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

async function call<T>(path: string, method: string, body?: BodyInit, kind = "application/json"): Promise<T> {
  const response = await fetch(path, { method, ...(body === undefined ? {} : { body, headers: { "content-type": kind } }) });
  if (response.ok) return (await response.json()) as T;
  if (response.status === 422) {
    const answer = (await response.json()) as { errors?: Problem[] };
    if (answer.errors) throw new Refusal(answer.errors);
  }
  const why = response.status === 413 ? "the file is too large" : await response.text();
  throw new Refusal([{ path: "", message: why || `status ${response.status}`, hint: "", line: null }]);
}

const post = <T>(path: string, body: unknown): Promise<T> => call<T>(path, "POST", JSON.stringify(body));

export const api = {
  examples: () => call<Record<string, string>>("/api/examples", "GET"),
  document: (text: string) => post<Document>("/api/document", { text }),
  edit: (text: string, path: string, value: string) => post<Document>("/api/edit", { text, path, value }),
  map: (text: string, motion: string, record: Record<string, string>) =>
    post<Document>("/api/record", { text, motion, record }),
  preview: (text: string) => post<Curves>("/api/preview", { text }),
  upload: (file: File) =>
    call<{ name: string; columns: string[] }>(
      `/api/records/${encodeURIComponent(file.name)}`, "PUT", file, "application/octet-stream",
    ),
  runs: () => call<Run[]>("/api/runs", "GET"),
  submit: (text: string, of = "") => post<{ id: string }>("/api/runs", { text, case: of }),
  sweep: (text: string, over: string[], measure: string) => post<{ id: string }>("/api/sweeps", { text, over, measure }),
  cancel: (id: string) => call<Run>(`/api/runs/${id}`, "DELETE"),
  file: (id: string, name: string) => `/api/runs/${id}/${name}`,
  text: async (id: string, name: string) => (await fetch(`/api/runs/${id}/${name}`)).text(),
};
