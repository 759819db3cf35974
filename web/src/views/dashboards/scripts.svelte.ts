/** The scripts of the shown dashboard: called with the newest values of their inputs, their results fed as series. */
import { ScriptRunner } from '$lib/scripts/ScriptRunner';
import { live } from '$lib/series/live.svelte';
import type { Series } from '$lib/series/SeriesHub';

import type { UserScript } from './model';

const INTERVAL = 50;

class Running {
  private readonly inputs: readonly (readonly [string, Series])[];
  private readonly runner: ScriptRunner;
  private readonly stopFrames: () => void;
  private readonly readsFrames: boolean;
  private seen = -1;

  constructor(script: UserScript, onProblem: (problem: string) => void) {
    const source = `script:${script.name}`;
    this.inputs = Object.entries(script.inputs).map(([name, ref]) => [name, live.hub.watch(ref)] as const);
    this.runner = new ScriptRunner(
      script.code,
      (results, calls) => {
        results.forEach((fields, index) =>
          live.takeRow({ source, message: 'OUT', time: calls[index]!.time * 1000, fields }),
        );
      },
      onProblem,
    );
    if (this.runner.problem !== null) onProblem(this.runner.problem);
    this.stopFrames =
      script.frames === ''
        ? () => {}
        : live.onFrame(script.frames, (bytes, time) =>
            this.runner.call({ values: this.values(), time: time / 1000, bytes }),
          );
    this.readsFrames = script.frames !== '';
  }

  /** Calls the script if an input has a new value. */
  step(): void {
    if (this.readsFrames) return;
    const pushed = this.inputs.reduce((sum, [, series]) => sum + series.ring.pushed, 0);
    if (pushed === this.seen || pushed === 0) return;
    this.seen = pushed;
    const time = Math.max(...this.inputs.map(([, series]) => series.time ?? 0)) / 1000;
    this.runner.call({ values: this.values(), time });
  }

  private values(): Readonly<Record<string, number | null>> {
    return Object.fromEntries(this.inputs.map(([name, series]) => [name, series.value]));
  }

  close(): void {
    this.stopFrames();
    for (const [, series] of this.inputs) live.hub.release(series);
    this.runner.close();
  }
}

export class Scripts {
  /** Why a script was stopped, by its name. */
  problems: Readonly<Record<string, string>> = $state.raw({});
  private running: Running[] = [];
  private timer: ReturnType<typeof setInterval> | null = null;

  start(scripts: readonly UserScript[]): void {
    this.stop();
    this.running = scripts.map(
      (script) => new Running(script, (problem) => (this.problems = { ...this.problems, [script.name]: problem })),
    );
    if (scripts.length === 0) return;
    this.timer = setInterval(() => {
      for (const each of this.running) each.step();
    }, INTERVAL);
  }

  stop(): void {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
    for (const each of this.running) each.close();
    this.running = [];
    this.problems = {};
  }
}
