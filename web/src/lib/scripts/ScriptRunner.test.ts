import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { runInNewContext } from 'node:vm';
import { ScriptRunner, type ScriptWorker } from './ScriptRunner';
import {
  fieldsOf,
  problemOf,
  workerProgram,
  type ScriptAnswer,
  type ScriptProgram,
  type ScriptRequest,
} from './sandbox';

/** Runs a program in a context that has what a worker has, as far as the sandbox must take it away. */
class ContextWorker implements ScriptWorker {
  onmessage: ScriptWorker['onmessage'] = null;
  onerror: ScriptWorker['onerror'] = null;
  terminated = false;
  private listener: ((event: { data: ScriptRequest }) => void) | null = null;

  /** Runs the program of the first message, as the worker does. */
  private start(program: string): void {
    const scope = Object.create({ fetch: () => 'inherited', importScripts: () => 'loaded' }) as Record<string, unknown>;
    scope.postMessage = (answer: ScriptAnswer) => this.onmessage?.({ data: structuredClone(answer) });
    scope.addEventListener = (_: string, listener: ContextWorker['listener']) => (this.listener = listener);
    for (const name of ['fetch', 'XMLHttpRequest', 'WebSocket', 'setTimeout', 'indexedDB']) scope[name] = () => name;
    runInNewContext(program, scope);
  }

  postMessage(message: ScriptRequest | ScriptProgram): void {
    if (this.terminated) return;
    if ('program' in message) this.start(message.program);
    else this.listener?.({ data: message });
  }

  terminate(): void {
    this.terminated = true;
  }
}

function compute(
  script: string,
  ...calls: { values: Record<string, number | null>; time: number; bytes?: Uint8Array }[]
): unknown {
  const results: unknown[] = [];
  const problems: string[] = [];
  const runner = new ScriptRunner(
    script,
    (found) => results.push(...found),
    (problem) => problems.push(problem),
    () => new ContextWorker(),
  );
  for (const call of calls.length > 0 ? calls : [{ values: {}, time: 0 }]) runner.call(call);
  return problems[0] ?? runner.problem ?? results;
}

describe('scripts', () => {
  it('read the bytes of frames, and return several rows of each', () => {
    const script = 'return [...bytes].map((each) => ({ each, kind: "text" }));';
    const call = { values: {}, time: 1, bytes: Uint8Array.of(7, 9) };
    expect(compute(script, call)).toEqual([{ each: 7 }, { each: 9 }]);
    const many = 'return Array.from({ length: 1000 }, (_, each) => ({ each }));';
    expect(compute(many, call)).toHaveLength(64);
    const view = 'const view = new DataView(bytes.buffer, bytes.byteOffset); return { volts: view.getUint16(0) };';
    expect(compute(view, call)).toEqual([{ volts: 0x0709 }]);
  });

  it('compute fields of values, with a state of their own', () => {
    const script = 'state.sum = (state.sum ?? 0) + values.a; return { sum: state.sum, twice: values.a * 2, time };';
    const call = (a: number) => ({ values: { a }, time: a });
    expect(compute(script, call(1), call(2))).toEqual([
      { sum: 1, twice: 2, time: 1 },
      { sum: 3, twice: 4, time: 2 },
    ]);
  });

  it('keep data in their state, and not too much of it', () => {
    expect(compute('state.f = () => 1; return {}')).toContain(
      'state may hold numbers, texts, arrays and plain objects',
    );
    expect(compute('state.m = new Map(); return {}')).toContain('plain objects only');
    expect(compute('state.n = 1n << 10_000n; return {}')).toContain('plain objects only');
    for (const much of ['"x".repeat(1e6)', 'Array(1e6)', 'new Float64Array(1e6)', '[[["x".repeat(1e5)]]]'])
      expect(compute(`state.a = ${much}; return {}`)).toBe('the script keeps too much in state');
    expect(compute('state.a = state; return {}')).toBe('the script keeps too much in state');
    // Methods that the script replaces, and getters that tell lies, are no way around.
    const lies = 'const a = new Float64Array(1e6); Object.defineProperty(a, "length", { value: 1 });';
    expect(compute(`${lies} state.a = a; Array.isArray = () => false; return {}`)).toBe(
      'the script keeps too much in state',
    );
    const proxy = 'const found = { enumerable: true, configurable: true }; state.a = new Proxy({}, {';
    const traps = 'ownKeys: () => ["b"], get: () => "x".repeat(1e6), getOwnPropertyDescriptor: () => found });';
    expect(compute(`${proxy} ${traps} return {}`)).toBe('the script keeps too much in state');
  });

  it('go on in a new worker with their state, and nothing else', () => {
    const workers: ContextWorker[] = [];
    const results: unknown[] = [];
    const problems: string[] = [];
    const now = vi.spyOn(performance, 'now').mockImplementation(() => (time += 200));
    let time = 0;
    const runner = new ScriptRunner(
      `state.list ??= new Float32Array([7]); state.text ??= { a: ['x'] }; state.count = (state.count ?? 0) + 1;
       globalThis.left = (globalThis.left ?? 0) + 1;
       const text = state.text.a[0] === 'x' ? 1 : 0;
       return { count: state.count, left: globalThis.left, list: state.list[0], text };`,
      (found) => results.push(...found),
      (problem) => problems.push(problem),
      () => {
        const worker = new ContextWorker();
        workers.push(worker);
        return worker;
      },
    );
    for (let call = 0; call < 5; call += 1) runner.call({ values: {}, time: call });
    now.mockRestore();
    expect(problems).toEqual([]);
    expect(results.map((each) => (each as { count: number }).count)).toEqual([1, 2, 3, 4, 5]);
    expect(results.map((each) => (each as { left: number }).left)).toEqual([1, 2, 3, 4, 1]);
    expect(results.at(-1)).toMatchObject({ list: 7, text: 1 });
    expect(workers.map(({ terminated }) => terminated)).toEqual([true, false]);
  });

  it('return finite numbers only', () => {
    expect(compute('return { a: NaN, b: "x", "no name": 1, c: 3 }')).toEqual([{ c: 3 }]);
    expect(compute('return null')).toEqual([{}]);
  });

  it('return no more than the page can take', () => {
    const replaced =
      'Array.prototype.map = () => ["a"]; Array.prototype.filter = () => [["a", "<b>"]]; Object.keys = () => 5;';
    expect(compute(`${replaced} return { a: "<b>", b: 2 }`)).toEqual([{ b: 2 }]);
    const many = Object.fromEntries(Array.from({ length: 100 }, (_, index) => [`f${index}`, index]));
    expect(Object.keys((compute(`return ${JSON.stringify(many)}`) as object[])[0]!)).toHaveLength(32);
    expect(fieldsOf({ ok: 1, 'no name': 2, text: 'x', ['x'.repeat(40)]: 3 })).toEqual({ ok: 1 });
    expect(fieldsOf(null)).toEqual({});
  });

  it('end with their error', () => {
    expect(compute('return missing.value')).toContain('missing is not defined');
    const long = 'String.prototype.slice = () => "replaced"; throw { toString: () => "x".repeat(1e6) };';
    expect(compute(long)).toBe('x'.repeat(300));
  });

  it.each(['', 'import("./x.js")', 'x'.repeat(30_000)])('that cannot run are refused', (script) => {
    expect(problemOf(script)).not.toBeNull();
  });
});

describe('the sandbox', () => {
  const reach = (name: string) => `return { found: typeof ${name} === 'undefined' ? 0 : 1 }`;

  it.each([
    'fetch',
    'importScripts',
    'XMLHttpRequest',
    'WebSocket',
    'setTimeout',
    'indexedDB',
    'postMessage',
    'Function',
  ])('has no %s', (name) => expect(compute(reach(name))).toEqual([{ found: 0 }]));

  it('does not give it back by the prototypes', () => {
    const script = 'return { found: Object.getPrototypeOf(globalThis).fetch === undefined ? 0 : 1 }';
    expect(compute(script)).toEqual([{ found: 0 }]);
  });

  it('makes no functions of texts', () => {
    expect(compute('return { made: (() => {}).constructor("return 1")() }')).toContain('not a function');
  });

  it('is not weakened by declarations that come first', () => {
    const breakout = `return { found: globalThis.fetch === undefined ? 0 : 1 } });
      function Object() {} function JSON() {} function defineProperty() {} (function () {`;
    expect(compute(breakout)).toEqual([{ found: 0 }]);
  });

  it('is strict', () => {
    expect(compute('undeclared = 1; return {}')).toContain('undeclared');
    expect(workerProgram('return {}')).toContain('"use strict"');
  });
});

describe('a script that hangs', () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  it('is stopped after the time limit', () => {
    const worker: ScriptWorker = { postMessage: () => {}, terminate: vi.fn(), onmessage: null, onerror: null };
    const problems: string[] = [];
    const runner = new ScriptRunner(
      'for (;;) {}',
      () => {},
      (problem) => problems.push(problem),
      () => worker,
    );
    runner.call({ values: {}, time: 0 });
    // The browser starts the worker.
    vi.advanceTimersByTime(4000);
    worker.onmessage!({ data: { id: 0 } });
    vi.advanceTimersByTime(499);
    expect(problems).toEqual([]);
    vi.advanceTimersByTime(1);
    expect(problems).toEqual(['the script took longer than 0.5 s and was stopped']);
    expect(worker.terminate).toHaveBeenCalled();
    runner.call({ values: {}, time: 1 });
    expect(problems).toHaveLength(1);
  });

  it('is stopped when it does not start', () => {
    const worker: ScriptWorker = { postMessage: () => {}, terminate: vi.fn(), onmessage: null, onerror: null };
    const onProblem = vi.fn();
    new ScriptRunner(
      '}); for (;;) {} (function () {',
      () => {},
      onProblem,
      () => worker,
    );
    vi.advanceTimersByTime(5000);
    expect(onProblem).toHaveBeenCalledWith('the script took longer than 5 s and was stopped');
    expect(worker.terminate).toHaveBeenCalled();
  });

  it('keeps a bounded number of calls', () => {
    const requests: ScriptRequest[] = [];
    const worker: ScriptWorker = {
      postMessage: (message) => void ('calls' in message && requests.push(message)),
      terminate: () => {},
      onmessage: null,
      onerror: null,
    };
    const runner = new ScriptRunner(
      'return {}',
      () => {},
      () => {},
      () => worker,
    );
    worker.onmessage!({ data: { id: 0 } });
    for (let time = 0; time < 1000; time++) runner.call({ values: {}, time });
    expect(requests).toHaveLength(1);
    worker.onmessage!({ data: { id: 1, results: [{}] } });
    expect(requests[1]!.calls).toHaveLength(200);
    expect(requests[1]!.calls.at(-1)!.time).toBe(999);
    runner.close();
  });

  it('reports an error of its syntax', () => {
    const worker: ScriptWorker = { postMessage: () => {}, terminate: () => {}, onmessage: null, onerror: null };
    const onProblem = vi.fn();
    const runner = new ScriptRunner(
      'return (',
      () => {},
      onProblem,
      () => worker,
    );
    worker.onerror!({ message: 'SyntaxError: Unexpected token' });
    expect(onProblem).toHaveBeenCalledWith('SyntaxError: Unexpected token');
    expect(runner.problem).toContain('Unexpected token');
  });
});
