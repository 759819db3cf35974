/** Steering by sticks in the page: reads the chosen source 50 times a second and obeys the dead-man rule. */
import { fleet } from '$lib/store/fleet.svelte';
import { Persisted } from '$lib/store/settings.svelte';
import { status } from '$lib/store/status.svelte';
import { isAmbiguous } from '$lib/vehicle/Vehicle';

import {
  ManualControl,
  type ManualState,
  SEND_INTERVAL,
  type Sticks,
  type StopReason,
  throttleKind,
} from './ManualControl';
import { DEFAULT_MANUAL, isStickKey, KeySticks, type ManualSettings, padSticks, TouchSticks } from './sticks';

export type StickSource = 'pad' | 'keys' | 'touch';

/** Where keys write or choose. */
const WRITING = 'input:not([type=checkbox]), select, textarea, dialog';
/** The shown state changes at every fourth tick only. */
const SHOW_EVERY = 4;

class Manual {
  isEnabled = $state(false);
  source: StickSource = $state('pad');
  settings = new Persisted<ManualSettings>('fly.manual', DEFAULT_MANUAL);
  state: ManualState = $state('off');
  reason: StopReason = $state(null);
  /** Name of the gamepad, or null. */
  padName: string | null = $state(null);
  sticks: Sticks | null = $state.raw(null);
  /** Messages sent in the last second. */
  rate = $state(0);
  /** The next button that is pressed becomes the dead-man button. */
  isLearning = $state(false);
  readonly touch = new TouchSticks();

  private readonly keys = new KeySticks();
  private readonly control = new ManualControl((system, fields) => {
    this.sent += 1;
    fleet.send('MANUAL_CONTROL', { target: system, ...fields });
  });
  private timer: ReturnType<typeof setInterval> | null = null;
  private ticks = 0;
  private sent = 0;
  private ends: (() => void)[] = [];

  enable(source: StickSource): void {
    this.source = source;
    this.isEnabled = true;
    if (this.timer !== null) return;
    this.timer = setInterval(() => this.tick(performance.now()), SEND_INTERVAL);
    this.ends = [
      listen(document, 'visibilitychange', () => document.hidden && this.control.halt('hidden')),
      listen(window, 'pagehide', () => this.control.halt('hidden')),
      listen(window, 'blur', () => this.lostFocus()),
      listen(window, 'keydown', (event) => this.key(event as KeyboardEvent, true)),
      listen(window, 'keyup', (event) => this.key(event as KeyboardEvent, false)),
    ];
  }

  /** Stops at once, and sends nothing any more. */
  disable(): void {
    this.isEnabled = false;
    this.keys.clear();
    this.touch.clear();
    this.tick(performance.now());
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
    for (const end of this.ends.splice(0)) end();
    this.show();
    this.rate = 0;
  }

  private tick(now: number): void {
    const state = fleet.selected?.state ?? null;
    const isUsable = state !== null && !isAmbiguous(state) && fleet.selected?.capabilities.manualControl !== false;
    const sticks = this.isEnabled ? this.read(now, state?.type === 'sub') : null;
    this.control.tick(now, sticks, {
      isEnabled: this.isEnabled,
      isVisible: !document.hidden && document.hasFocus(),
      isLinked: status.link === 'open',
      system: isUsable ? state.system : null,
      isHeard: state?.alive ?? false,
      throttle: throttleKind(state?.firmware ?? 'other', state?.type ?? 'unknown'),
    });
    this.sticks = sticks;
    this.ticks += 1;
    if (this.ticks % SHOW_EVERY === 0 || this.control.state !== this.state) this.show();
    if (this.ticks % (1000 / SEND_INTERVAL) === 0) {
      this.rate = this.sent;
      this.sent = 0;
    }
  }

  private show(): void {
    this.state = this.control.state;
    this.reason = this.control.reason;
  }

  private read(now: number, hasButtons: boolean): Sticks | null {
    if (this.source === 'touch') return this.touch.read();
    if (this.source === 'keys') return this.keys.read(now);
    const pad = navigator.getGamepads().find((each) => each?.connected) ?? null;
    this.padName = pad?.id ?? null;
    if (pad === null) return null;
    if (this.isLearning) this.learn(pad);
    return padSticks(pad, this.settings.value, hasButtons);
  }

  private learn(pad: Gamepad): void {
    const pressed = pad.buttons.findIndex((button) => button.pressed);
    if (pressed < 0) return;
    this.settings.value = { ...this.settings.value, deadMan: pressed };
    this.isLearning = false;
  }

  /** Keys and buttons that are released in another window send no event. */
  private lostFocus(): void {
    this.keys.clear();
    this.control.halt('hidden');
  }

  private key(event: KeyboardEvent, isDown: boolean): void {
    if (this.source !== 'keys' || !isStickKey(event.code)) return;
    const target = event.target as HTMLElement | null;
    if (isDown && target?.closest?.(WRITING) != null) return;
    if (isDown && (event.ctrlKey || event.altKey || event.metaKey)) return;
    // The space bar would hold the button with the focus, arrow keys would move the map.
    event.preventDefault();
    event.stopPropagation();
    // A key that was held while the focus was elsewhere repeats: only a new press counts.
    if (isDown && !event.repeat) this.keys.press(event.code);
    else if (!isDown) this.keys.release(event.code);
  }
}

/** Listens before the elements of the page do: a button with the focus must not see the space bar. */
function listen(target: EventTarget, name: string, listener: (event: Event) => void): () => void {
  target.addEventListener(name, listener, true);
  return () => target.removeEventListener(name, listener, true);
}

export const manual = new Manual();
