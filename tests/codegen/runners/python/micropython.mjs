// The runner of Python packages on MicroPython for WebAssembly:
// node micropython.mjs MICROPYTHON.mjs FOLDER PACKAGE RUNNER.py
import { createInterface } from "node:readline";
import { readFileSync, readdirSync, statSync, writeSync } from "node:fs";
import { join } from "node:path";

const [module, folder, name, runner] = process.argv.slice(2);
const { loadMicroPython } = await import(module);
const print = (line) => writeSync(1, `${line}\n`);
const micropython = await loadMicroPython({ heapsize: 64 * 1024 * 1024, stdout: print });

function copy(source, target) {
  if (statSync(source).isDirectory()) {
    micropython.FS.mkdir(target);
    for (const entry of readdirSync(source)) copy(join(source, entry), `${target}/${entry}`);
  } else if (source.endsWith(".py")) {
    micropython.FS.writeFile(target, readFileSync(source));
  }
}

copy(join(folder, name), `/${name}`);
micropython.FS.writeFile("/runner.py", readFileSync(runner));
try {
  micropython.runPython('import sys; sys.path.append("/")');
  micropython.runPython(`from runner import Runner; run = Runner("${name}").run`);
  const run = micropython.globals.get("run");
  for await (const line of createInterface({ input: process.stdin })) run(line);
} catch (error) {
  console.error(error.message); // the stack would show the whole interpreter
  process.exit(1);
}
