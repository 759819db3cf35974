/**
 * Runs one user script in a worker: batches of calls go in, computed fields come out.
 *
 * One batch is under way at a time; calls that come meanwhile wait, and the oldest of them are dropped. A script
 * that does not answer in time is stopped: its worker is terminated, and the reason is told once.
 *
 * A script could also fill the memory of the page little by little. So a worker computes for as long as one batch may
 * take and is then replaced: a copy of the state, of limited size, is all that the next worker gets.
 */
import { type ScriptAnswer, type ScriptProgram, type ScriptRequest, problemOf, rowsOf, workerProgram } from './sandbox';

export type ScriptCall = ScriptRequest['calls'][number];
/** Called with the rows of results, and with the call of each row. */
type Results = (results: readonly Readonly<Record<string, number>>[], calls: readonly ScriptCall[]) => void;

/** The part of a worker that the runner uses, so that tests stand in for it. */
export interface ScriptWorker {
  postMessage(request: ScriptRequest | ScriptProgram): void;
  terminate(): void;
  onmessage: ((event: { data: ScriptAnswer }) => void) | null;
  onerror: ((event: { message?: string }) => void) | null;
}

/** Milliseconds that a batch of calls may take: short, since a script can fill the memory of the page meanwhile. */
export const TIME_LIMIT = 500;
/** Milliseconds that the browser has to start the worker. */
export const START_TIME_LIMIT = 5000;
const MAX_WAITING = 200;

export class ScriptRunner {
  /** Why the script does not run any more, null while it does. */
  problem: string | null;
  private worker: ScriptWorker | null = null;
  private waiting: ScriptCall[] = [];
  private underWay: readonly ScriptCall[] | null = null;
  private sent = 0;
  /** Milliseconds that the worker has computed. */
  private busy = 0;
  private sentAt = 0;
  /** The state for a new worker. */
  private state: unknown;
  private hasStarted = false;
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(
    private readonly script: string,
    private readonly onResults: Results,
    private readonly onProblem: (problem: string) => void = () => {},
    private readonly makeWorker: () => ScriptWorker = startWorker,
    private readonly timeLimit = TIME_LIMIT,
  ) {
    this.problem = problemOf(script);
    if (this.problem === null) this.start();
  }

  private start(): void {
    [this.hasStarted, this.busy] = [false, 0];
    this.worker = this.makeWorker();
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.onerror = (event) => this.fail(event.message ?? 'the script cannot run');
    this.worker.postMessage({ program: workerProgram(this.script) });
    this.limit(START_TIME_LIMIT);
  }

  /** Goes on in a new worker, which has nothing of the old one but the state. */
  private replace(state: unknown): void {
    if (this.timer !== null) clearTimeout(this.timer);
    this.worker?.terminate();
    this.state = state;
    this.start();
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
    if (!this.hasStarted || this.worker === null || this.underWay !== null || this.waiting.length === 0) return;
    this.underWay = this.waiting;
    this.waiting = [];
    this.sent++;
    this.limit(this.timeLimit);
    this.sentAt = performance.now();
    // The first state shows whether the script keeps what a copy can hold.
    const givesState = this.sent === 1 || this.busy >= this.timeLimit;
    const state = this.state === undefined ? {} : { state: this.state };
    this.state = undefined;
    this.worker.postMessage({ id: this.sent, calls: this.underWay, givesState, ...state });
  }

  private limit(time: number): void {
    this.timer = setTimeout(() => this.fail(`the script took longer than ${time / 1000} s and was stopped`), time);
  }

  private take(answer: ScriptAnswer): void {
    if (answer.id === 0 && !this.hasStarted) {
      this.hasStarted = true;
      if (this.timer !== null) clearTimeout(this.timer);
      this.send();
    }
    if (answer.id !== this.sent || this.underWay === null) return;
    if (this.timer !== null) clearTimeout(this.timer);
    const calls = this.underWay;
    this.underWay = null;
    const isUsedUp = this.busy >= this.timeLimit;
    this.busy += performance.now() - this.sentAt;
    if (answer.error !== undefined) {
      this.fail(answer.error);
      return;
    }
    const results = Array.isArray(answer.results) ? answer.results : [];
    const rows = calls.flatMap((call, index) => rowsOf(results[index]).map((fields) => ({ fields, call })));
    this.onResults(
      rows.map(({ fields }) => fields),
      rows.map(({ call }) => call),
    );
    // The results may have ended the script.
    if (isUsedUp && this.worker !== null) this.replace(answer.state);
    else this.send();
  }

  private fail(problem: string): void {
    if (this.worker === null) return;
    this.close();
    this.problem = problem;
    this.onProblem(problem);
  }
}

function startWorker(): ScriptWorker {
  return new Worker(new URL('./script.worker.ts', import.meta.url)) as unknown as ScriptWorker;
}
