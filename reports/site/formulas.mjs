// Formulas as MathML, which browsers draw by themselves: no fonts, no script in the page.
// stdin: [[formula, displayed], ...] as JSON; the module of KaTeX is the first argument; stdout: [MathML, ...].
import { pathToFileURL } from "node:url";
import { readFileSync } from "node:fs";

const katex = (await import(pathToFileURL(process.argv[2]).href)).default;
const asked = JSON.parse(readFileSync(0, "utf-8"));
const rendered = asked.map(([formula, displayed]) =>
  katex.renderToString(formula, { displayMode: displayed, output: "mathml", throwOnError: true }),
);
process.stdout.write(JSON.stringify(rendered));
