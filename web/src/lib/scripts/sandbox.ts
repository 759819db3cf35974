/**
 * The program text of a sandbox: a worker that runs one user script and can do nothing else.
 *
 * Two layers confine the script. The browser applies the policy that the station sends with the file of the worker
 * (`script.worker.ts`): no request to anywhere, no other worker, no data of the station's pages. And before the script
 * runs, everything is removed from the global object that is not part of the language itself: no network, no storage,
 * no timers, no other workers. The removal uses only built-ins that it reaches through literals, so that a script that
 * redefines globals (function declarations are hoisted) cannot weaken it, and results are read without methods that a
 * script can replace. `import` is syntax and cannot be removed: scripts that contain the word are refused
 * (`problemOf`).
 */

/** A request of the page: values by input name (latched), and the time in seconds since 1970. */
export interface ScriptRequest {
  readonly id: number;
  readonly calls: readonly {
    readonly values: Readonly<Record<string, number | null>>;
    readonly time: number;
    /** A frame, for a script that reads the bytes of a source. */
    readonly bytes?: Uint8Array;
  }[];
  /** The state of the worker before, for the first request to the next one. */
  readonly state?: unknown;
  /** Whether the answer holds the state, for the next worker. */
  readonly givesState?: boolean;
}

/** The first message to the worker: the program that it runs. */
export interface ScriptProgram {
  readonly program: string;
}

/** The answer of the worker: a result for each call, or the first error. */
export interface ScriptAnswer {
  /** That of the request; 0: the program has started, and takes requests. */
  readonly id: number;
  /** Objects of finite numbers, or lists of them. */
  readonly results?: unknown;
  /** A copy of the state, of limited size. */
  readonly state?: unknown;
  readonly error?: string;
}

/** Names of the global object that belong to the language and reach nothing outside. */
const KEPT = [
  'Object',
  'Function',
  'Array',
  'Number',
  'Boolean',
  'String',
  'Symbol',
  'BigInt',
  'Math',
  'JSON',
  'Date',
  'RegExp',
  'Map',
  'Set',
  'WeakMap',
  'WeakSet',
  'Error',
  'RangeError',
  'TypeError',
  'SyntaxError',
  'ReferenceError',
  'EvalError',
  'URIError',
  'AggregateError',
  'Promise',
  'Proxy',
  'Reflect',
  'Iterator',
  'ArrayBuffer',
  'DataView',
  'Float32Array',
  'Float64Array',
  'Int8Array',
  'Int16Array',
  'Int32Array',
  'Uint8Array',
  'Uint8ClampedArray',
  'Uint16Array',
  'Uint32Array',
  'BigInt64Array',
  'BigUint64Array',
  'NaN',
  'Infinity',
  'undefined',
  'isNaN',
  'isFinite',
  'parseInt',
  'parseFloat',
  'globalThis',
  'constructor',
  'hasOwnProperty',
  'isPrototypeOf',
  'propertyIsEnumerable',
  'toString',
  'toLocaleString',
  'valueOf',
  '__proto__',
  '__defineGetter__',
  '__defineSetter__',
  '__lookupGetter__',
  '__lookupSetter__',
] as const;

const MAX_FIELDS = 32;
/** Rows that a script may return for one call. */
const MAX_ROWS = 64;
const MAX_NAME_LENGTH = 32;
const FIELD_NAME = /^[A-Za-z]\w*$/;
const MAX_SCRIPT = 20_000;
const MAX_ERROR = 300;
/** Numbers, keys and characters that the state may have. */
export const MAX_STATE = 100_000;
const MAX_STATE_DEPTH = 50;

/** Returns why a script cannot run, null if it can be tried. */
export function problemOf(script: string): string | null {
  if (script.trim() === '') return 'the script is empty';
  if (script.length > MAX_SCRIPT) return `the script is longer than ${MAX_SCRIPT} characters`;
  if (/\bimport\b/.test(script)) return 'a script must not contain the word import';
  return null;
}

/**
 * Returns the fields of a result: names of letters and digits, finite numbers.
 *
 * The worker sends numbers only; whether their names are good ones, the page decides.
 */
export function fieldsOf(result: unknown): Record<string, number> {
  const entries = Object.entries(typeof result === 'object' && result !== null ? result : {});
  const valid = entries.filter(
    ([name, value]) => name.length <= MAX_NAME_LENGTH && FIELD_NAME.test(name) && Number.isFinite(value),
  );
  return Object.fromEntries(valid.slice(0, MAX_FIELDS)) as Record<string, number>;
}

/** Returns the rows of a result: an object is one, a list holds several. */
export function rowsOf(result: unknown): readonly Record<string, number>[] {
  return (Array.isArray(result) ? result.slice(0, MAX_ROWS) : [result]).map(fieldsOf);
}

/** Returns the program of a worker that runs the body of a function of `values`, `state`, `time` and `bytes`. */
export function workerProgram(script: string): string {
  return `${guard()}\n;__run__(function (values, state, time, bytes) { "use strict";\n${script}\n});`;
}

/** The part that closes the sandbox and leaves one function behind, which takes the script once. */
function guard(): string {
  return `(function (scope) {
"use strict";
const { getOwnPropertyNames, getOwnPropertyDescriptor, getPrototypeOf, defineProperty, keys } = ({}).constructor;
const isFiniteNumber = (0).constructor.isFinite;
const { apply } = scope.Reflect, cut = ("").slice;
const kept = ${JSON.stringify(KEPT)};
const post = scope.postMessage.bind(scope), listen = scope.addEventListener.bind(scope);
for (let owner = scope; owner !== null && owner !== ({}).__proto__; owner = getPrototypeOf(owner)) {
  for (const name of getOwnPropertyNames(owner)) {
    if (kept.includes(name)) continue;
    try { delete owner[name]; } catch {}
    try { defineProperty(owner, name, { value: undefined, writable: false, configurable: false }); } catch {}
  }
}
for (const each of [function () {}, async function () {}, function* () {}, async function* () {}])
  defineProperty(getPrototypeOf(each), "constructor", { value: undefined, configurable: false });
delete scope.Function;
const numbers = (result) => {
  const found = { __proto__: null }, names = typeof result === "object" && result !== null ? keys(result) : [];
  for (let at = 0, count = 0; at < names.length && count < ${MAX_FIELDS}; at++) {
    const name = names[at], value = result[name];
    if (name.length > ${MAX_NAME_LENGTH} || typeof value !== "number" || !isFiniteNumber(value)) continue;
    found[name] = value;
    count++;
  }
  return found;
};
const isArray = [].constructor.isArray, plain = ({}).__proto__;
const rows = (result) => {
  if (!isArray(result)) return numbers(result);
  const found = [];
  for (let at = 0; at < result.length && at < ${MAX_ROWS}; at++)
    defineProperty(found, at, { value: numbers(result[at]), writable: true, enumerable: true, configurable: true });
  return found;
};
const typed = { __proto__: null };
for (const name of ${JSON.stringify(KEPT.filter((name) => name.endsWith('Array') && name !== 'Array'))})
  typed[name] = scope[name];
const views = getPrototypeOf(getPrototypeOf(new scope.Uint8Array(0)));
const tagOf = getOwnPropertyDescriptor(views, scope.Symbol.toStringTag).get;
const lengthOf = getOwnPropertyDescriptor(views, "length").get;
let room = 0;
const take = (count) => {
  room -= count;
  if (!(room >= 0)) throw "the script keeps too much in state";
};
const copy = (value, depth) => {
  take(typeof value === "string" ? value.length + 1 : 1);
  if (value === null || typeof value === "undefined" || typeof value === "boolean") return value;
  if (typeof value === "string" || typeof value === "number") return value;
  const tag = typeof value === "object" ? apply(tagOf, value, []) : undefined;
  const isList = tag !== undefined || isArray(value);
  if (typeof value !== "object" || !(isList || getPrototypeOf(value) === plain))
    throw "state may hold numbers, texts, arrays and plain objects only";
  if (depth > ${MAX_STATE_DEPTH}) throw "the script keeps too much in state";
  const length = tag !== undefined ? apply(lengthOf, value, []) : isList ? value.length : 0;
  take(length);
  const found = tag !== undefined ? new typed[tag](length) : isList ? [] : {};
  const names = isList ? [] : keys(value);
  const count = isList ? length : names.length;
  for (let at = 0; at < count; at++) {
    const name = isList ? at : names[at];
    if (!isList) take(name.length);
    const kept = tag !== undefined ? value[at] : copy(value[name], depth + 1);
    if (tag !== undefined) found[at] = kept;
    else defineProperty(found, name, { value: kept, writable: true, enumerable: true, configurable: true });
  }
  return found;
};
defineProperty(scope, "__run__", { configurable: true, value: (compute) => {
  delete scope.__run__;
  let state = {};
  listen("message", ({ data }) => {
    try {
      const results = [];
      if (data.state !== undefined) state = data.state;
      for (let at = 0; at < data.calls.length; at++) {
        const { values, time, bytes } = data.calls[at];
        results[at] = rows(compute(values, state, time, bytes));
      }
      room = ${MAX_STATE};
      post(data.givesState ? { id: data.id, results, state: copy(state, 0) } : { id: data.id, results });
    }
    catch (error) { post({ id: data.id, error: apply(cut, \`\${error}\`, [0, ${MAX_ERROR}]) }); }
  });
  post({ id: 0 });
} });
})(this);`;
}
