// A browser may name a language that it does not know itself, such as "en-US@posix"; uPlot formats numbers in it.

try {
  new Intl.NumberFormat(navigator.language);
} catch {
  Object.defineProperty(navigator, "language", { value: "en-US" });
}

export {};
