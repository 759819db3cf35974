import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { encodeMessage } from './codec';
import type { Firmware } from './facts';
import { encodeFrame, FrameReader } from './frame';
import { MspClient, type MspLine } from './MspClient';

const BETAFLIGHT: Firmware = { variant: 'BTFL', api: [1, 46] };
const text = (line: string): Uint8Array => new TextEncoder().encode(line);

/** A line to a flight controller that answers by a table; commands that are not in it are refused. */
class StandIn implements MspLine {
  readonly asked: number[] = [];
  readonly answers = new Map<number, Uint8Array>([
    [1, Uint8Array.of(0, 1, 46)],
    [2, text('BTFL')],
    [3, Uint8Array.of(4, 5, 1)],
    [4, text('S405')],
    [10, text('quad')],
    [250, new Uint8Array()],
  ]);
  /** Requests that get no answer, as on a noisy line. */
  lost = 0;
  cliReply: string | null = null;
  written = '';
  private readonly reader = new FrameReader();
  private listener: (data: Uint8Array) => void = () => undefined;

  onData(listener: (data: Uint8Array) => void): () => void {
    this.listener = listener;
    return () => (this.listener = () => undefined);
  }

  give(data: Uint8Array): void {
    this.listener(data);
  }

  send(data: Uint8Array): void {
    if (this.cliReply !== null) {
      const line = new TextDecoder().decode(data);
      this.written += line;
      if (line === '#') this.give(text('\r\nEntering CLI Mode\r\n\r\n# '));
      else this.give(text(`${line.split('\n')[0]}\r\n${this.cliReply}\r\n# ${line.split('\n')[1] ?? ''}`));
      return;
    }
    for (const { command } of this.reader.feed(data)) {
      this.asked.push(command);
      if (this.lost > 0) {
        this.lost -= 1;
        continue;
      }
      const reply = this.answers.get(command);
      this.give(encodeFrame(command, reply, undefined, reply ? '>' : '!'));
    }
  }
}

let line: StandIn;
let client: MspClient;
beforeEach(() => {
  vi.useFakeTimers();
  line = new StandIn();
  client = new MspClient(line);
});
afterEach(() => {
  client.close();
  vi.useRealTimers();
});

describe('client of MSP', () => {
  it('knows firmware, version and board', async () => {
    expect(await client.identify()).toMatchObject({
      firmware: 'Betaflight',
      version: '4.5.1',
      board: 'S405',
      name: 'quad',
      api: [1, 46],
    });
  });

  it('refuses to guess another firmware', async () => {
    line.answers.set(2, text('ARDU'));
    await expect(client.identify()).rejects.toThrow('neither Betaflight nor iNav');
  });

  it('repeats a request that is not answered, and gives up in the end', async () => {
    client.firmware = BETAFLIGHT;
    line.answers.set(108, encodeMessage('Attitude', { roll: 1.5, pitch: -2, heading: 90 }, BETAFLIGHT));
    line.lost = 2;
    const attitude = client.get('Attitude');
    await vi.advanceTimersByTimeAsync(2000);
    expect(await attitude).toEqual({ roll: 1.5, pitch: -2, heading: 90 });
    expect(line.asked).toEqual([108, 108, 108]);
    line.lost = 9;
    const failed = expect(client.get('Attitude')).rejects.toThrow('no answer');
    await vi.advanceTimersByTimeAsync(3000);
    await failed;
  });

  it('reports a refusal, and goes on', async () => {
    await expect(client.get('Attitude')).rejects.toThrow('refused');
    await client.save();
    expect(line.asked).toEqual([108, 250]);
  });

  it('asks one question after the other', async () => {
    line.lost = 1;
    const both = Promise.all([client.exchange(1), client.exchange(2)]);
    expect(line.asked).toEqual([]);
    await vi.advanceTimersByTimeAsync(700);
    await both;
    expect(line.asked).toEqual([1, 1, 2]);
  });

  it('opens the command line, and leaves it with exit', async () => {
    line.cliReply = 'p_roll = 45';
    const reply = client.cli('get p_roll');
    await vi.advanceTimersByTimeAsync(500);
    expect(await reply).toBe('p_roll = 45');
    await expect(client.exchange(1)).rejects.toThrow('leave it first');
    await expect(client.cli('what?')).rejects.toThrow('completion');
    await client.cli('exit');
    expect(client.hasCli).toBe(false);
    expect(line.written).toBe('#get p_roll\n# end 1\nexit\n');
  });
});
