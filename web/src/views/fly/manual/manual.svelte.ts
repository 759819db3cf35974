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
import { AxisCalibration, NO_PROFILE, PadButtons, type PadProfile } from './pad';
import { actByPad } from './padActions';
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
  /** The axes and pressed buttons of the gamepad as they are. */
  pad: { readonly axes: readonly number[]; readonly pressed: readonly number[] } | null = $state.raw(null);
  /** The sticks are moved to their ends, to calibrate them. */
  isCalibrating = $state(false);
  /** The profile of each gamepad, by its name. */
  readonly profiles = new Persisted<Readonly<Record<string, PadProfile>>>('fly.pads', {});
  readonly touch = new TouchSticks();

  private readonly buttons = new PadButtons();
  private calibration: AxisCalibration | null = null;
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
    this.isCalibrating = false;
    this.calibration = null;
    this.buttons.clear();
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
    const pad = connectedPad();
    this.padName = pad?.id ?? null;
    if (pad === null) {
      this.buttons.clear();
      this.calibration = null;
      this.isCalibrating = false;
      this.pad = null;
      return null;
    }
    const pressed = pad.buttons.flatMap((button, index) => (button.pressed ? [index] : []));
    if (this.ticks % SHOW_EVERY === 0) this.pad = { axes: [...pad.axes], pressed };
    if (this.isLearning) this.learn(pad);
    this.calibration?.sample(pad);
    this.act(now, pad);
    // Sticks that are moved to their ends for the calibration steer nothing.
    if (this.calibration) return { roll: 0, pitch: 0, throttle: 0, yaw: 0, buttons: 0, isHeld: false };
    return padSticks(pad, this.settings.value, hasButtons, this.profile);
  }

  /** The profile of the gamepad that is connected. */
  get profile(): PadProfile {
    return this.profiles.value[this.padName ?? ''] ?? NO_PROFILE;
  }

  setProfile(changed: Partial<PadProfile>): void {
    if (this.padName === null) return;
    this.profiles.value = { ...this.profiles.value, [this.padName]: { ...this.profile, ...changed } };
  }

  /** Begins the calibration; the sticks must be centred now. */
  beginCalibration(): void {
    const pad = connectedPad();
    this.calibration = pad && new AxisCalibration(pad);
    this.isCalibrating = pad !== null;
  }

  /** Ends the calibration, and keeps the ranges of the axes that were moved. */
  endCalibration(): void {
    const found = this.calibration?.ranges() ?? {};
    this.setProfile({ ranges: { ...this.profile.ranges, ...found } });
    this.calibration = null;
    this.isCalibrating = false;
  }

  /** Carries out the actions of buttons; the button that is held to steer has none. */
  private act(now: number, pad: Gamepad): void {
    const vehicle = fleet.selected;
    const { [this.settings.value.deadMan]: _, ...actions } = this.profile.actions;
    const mayAct = !document.hidden && document.hasFocus() && status.link === 'open' && !this.isLearning;
    if (!mayAct || this.calibration !== null || vehicle === null || isAmbiguous(vehicle.state)) {
      this.buttons.clear();
      return;
    }
    for (const action of this.buttons.tick(now, pad, actions, vehicle.system)) actByPad(action, vehicle);
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

function connectedPad(): Gamepad | null {
  return navigator.getGamepads().find((each) => each?.connected) ?? null;
}

/** Listens before the elements of the page do: a button with the focus must not see the space bar. */
function listen(target: EventTarget, name: string, listener: (event: Event) => void): () => void {
  target.addEventListener(name, listener, true);
  return () => target.removeEventListener(name, listener, true);
}

export const manual = new Manual();
