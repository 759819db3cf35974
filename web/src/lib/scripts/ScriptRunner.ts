/**
 * Runs one user script in a worker: batches of calls go in, computed fields come out.
 *
 * One batch is under way at a time; calls that come meanwhile wait, and the oldest of them are dropped. A script
 * that does not answer in time is stopped: its worker is terminated, and the reason is told once.
 */
import { type ScriptAnswer, type ScriptRequest, fieldsOf, problemOf, workerProgram } from './sandbox';

export type ScriptCall = ScriptRequest['calls'][number];
type Results = (results: readonly Readonly<Record<string, number>>[], calls: readonly ScriptCall[]) => void;

/** The part of a worker that the runner uses, so that tests stand in for it. */
export interface ScriptWorker {
  postMessage(request: ScriptRequest): void;
  terminate(): void;
  onmessage: ((event: { data: ScriptAnswer }) => void) | null;
  onerror: ((event: { message?: string }) => void) | null;
}

export const TIME_LIMIT = 500;
/** The browser starts the worker before the first answer. */
export const START_TIME_LIMIT = 5000;
const MAX_WAITING = 200;

export class ScriptRunner {
  /** Why the script does not run any more, null while it does. */
  problem: string | null;
  private worker: ScriptWorker | null = null;
  private waiting: ScriptCall[] = [];
  private underWay: readonly ScriptCall[] | null = null;
  private sent = 0;
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(
    script: string,
    private readonly onResults: Results,
    private readonly onProblem: (problem: string) => void = () => {},
    makeWorker: (program: string) => ScriptWorker = startWorker,
    private readonly timeLimit = TIME_LIMIT,
  ) {
    this.problem = problemOf(script);
    if (this.problem !== null) return;
    this.worker = makeWorker(workerProgram(script));
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.onerror = (event) => this.fail(event.message ?? 'the script cannot run');
  }

  /** Calls the script; the results come later. */
  call(call: ScriptCall): void {
    if (this.worker === null) return;
    this.waiting.push(call);
    if (this.waiting.length > MAX_WAITING) this.waiting.shift();
    this.send();
  }

  close(): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.worker?.terminate();
    this.worker = null;
    this.underWay = null;
    this.waiting = [];
  }

  private send(): void {
    if (this.worker === null || this.underWay !== null || this.waiting.length === 0) return;
    this.underWay = this.waiting;
    this.waiting = [];
    this.sent++;
    const limit = this.sent === 1 ? Math.max(this.timeLimit, START_TIME_LIMIT) : this.timeLimit;
    this.timer = setTimeout(() => this.fail(`the script took longer than ${limit / 1000} s and was stopped`), limit);
    this.worker.postMessage({ id: this.sent, calls: this.underWay });
  }

  private take(answer: ScriptAnswer): void {
    if (answer.id !== this.sent || this.underWay === null) return;
    if (this.timer !== null) clearTimeout(this.timer);
    const calls = this.underWay;
    this.underWay = null;
    if (answer.error !== undefined) {
      this.fail(answer.error);
      return;
    }
    const results = Array.isArray(answer.results) ? answer.results : [];
    this.onResults(calls.map((_, index) => fieldsOf(results[index])), calls);
    this.send();
  }

  private fail(problem: string): void {
    if (this.worker === null) return;
    this.close();
    this.problem = problem;
    this.onProblem(problem);
  }
}

function startWorker(program: string): ScriptWorker {
  const url = URL.createObjectURL(new Blob([program], { type: 'text/javascript' }));
  const worker = new Worker(url) as unknown as ScriptWorker;
  URL.revokeObjectURL(url);
  return worker;
}
