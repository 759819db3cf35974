/** Sticks of gamepads, of the keyboard, and of the screen. */
import type { Sticks } from './ManualControl';
import { calibrated, NO_PROFILE, type PadProfile } from './pad';

/** Which stick does what: mode 2 (left: throttle and yaw) is the usual one. */
export type StickMode = 1 | 2 | 3 | 4;

export interface ManualSettings {
  readonly mode: StickMode;
  /** Share of the way around the centre that counts as centred. */
  readonly deadZone: number;
  /** 0: linear; 1: fine around the centre. */
  readonly expo: number;
  /** Index of the gamepad's button that must be held. */
  readonly deadMan: number;
  /** Axes whose direction is turned around: roll, pitch, throttle, yaw. */
  readonly inverted: readonly AxisName[];
}

export type AxisName = 'roll' | 'pitch' | 'throttle' | 'yaw';

/** The left shoulder button of a standard gamepad. */
export const DEFAULT_MANUAL: ManualSettings = { mode: 2, deadZone: 0.08, expo: 0.3, deadMan: 4, inverted: [] };

/** Returns the index of an axis of a gamepad. */
export function placeOf(name: AxisName, mode: StickMode, profile: PadProfile): number {
  return profile.places[name] ?? AXES[mode][name];
}

/** Axes of a standard gamepad: left x, left y, right x, right y; up is negative. */
const AXES: Readonly<Record<StickMode, Readonly<Record<AxisName, number>>>> = {
  1: { yaw: 0, pitch: 1, roll: 2, throttle: 3 },
  2: { yaw: 0, throttle: 1, roll: 2, pitch: 3 },
  3: { roll: 0, pitch: 1, yaw: 2, throttle: 3 },
  4: { roll: 0, throttle: 1, yaw: 2, pitch: 3 },
};

/** Return an axis without its dead zone, and finer around the centre. */
export function shaped(value: number, deadZone: number, expo: number): number {
  const size = Math.abs(value);
  if (!Number.isFinite(value) || size <= deadZone) return 0;
  const share = Math.min(1, (size - deadZone) / (1 - deadZone));
  return Math.sign(value) * ((1 - expo) * share + expo * share ** 3);
}

export interface PadReading {
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly pressed: boolean }[];
}

/** Return the sticks of a gamepad; `hasButtons` sends its buttons too (submarines use them). */
export function padSticks(
  pad: PadReading,
  settings: ManualSettings,
  hasButtons = false,
  profile: PadProfile = NO_PROFILE,
): Sticks {
  const read = (name: AxisName): number => {
    // Up and forward are negative on a gamepad.
    const turn = name === 'throttle' || name === 'pitch' ? -1 : 1;
    const sign = settings.inverted.includes(name) ? -turn : turn;
    const place = placeOf(name, settings.mode, profile);
    const value = calibrated(pad.axes[place] ?? 0, profile.ranges[place]);
    return sign * shaped(value, settings.deadZone, settings.expo) + 0;
  };
  return {
    roll: read('roll'),
    pitch: read('pitch'),
    throttle: read('throttle'),
    yaw: read('yaw'),
    buttons: hasButtons ? buttonBits(pad, settings.deadMan, profile) : 0,
    isHeld: pad.buttons[settings.deadMan]?.pressed ?? false,
  };
}

function buttonBits(pad: PadReading, deadMan: number, profile: PadProfile): number {
  return pad.buttons.slice(0, 16).reduce((bits, { pressed }, index) => {
    return pressed && index !== deadMan && profile.actions[index] === undefined ? bits | (1 << index) : bits;
  }, 0);
}

/** Keys by their place on the keyboard, so that they lie together on every layout. */
const KEYS: Readonly<Record<string, readonly [AxisName, number]>> = {
  KeyW: ['throttle', 1],
  KeyS: ['throttle', -1],
  KeyA: ['yaw', -1],
  KeyD: ['yaw', 1],
  ArrowUp: ['pitch', 1],
  ArrowDown: ['pitch', -1],
  ArrowLeft: ['roll', -1],
  ArrowRight: ['roll', 1],
};
export const DEAD_MAN_KEY = 'Space';
const KEY_DEFLECTION = 0.5;
/** Full deflection is reached in so many ms, so that a short press is a small movement. */
const KEY_RAMP = 250;

/** Whether a key is one of those that steer. */
export function isStickKey(code: string): boolean {
  return code === DEAD_MAN_KEY || code in KEYS;
}

/** Sticks by keys: they ramp up while a key is held, and spring back. */
export class KeySticks {
  private readonly held = new Set<string>();
  private readonly values: Record<AxisName, number> = { roll: 0, pitch: 0, throttle: 0, yaw: 0 };
  private time: number | null = null;

  press(code: string): void {
    this.held.add(code);
  }

  release(code: string): void {
    this.held.delete(code);
  }

  /** Forget all keys: the window lost the focus, and no key-up will come. */
  clear(): void {
    this.held.clear();
    for (const name of Object.keys(this.values) as AxisName[]) this.values[name] = 0;
  }

  read(now: number): Sticks {
    const step = this.time === null ? 0 : Math.min(1, (now - this.time) / KEY_RAMP) * KEY_DEFLECTION;
    this.time = now;
    const wanted: Record<AxisName, number> = { roll: 0, pitch: 0, throttle: 0, yaw: 0 };
    for (const code of this.held) {
      const action = KEYS[code];
      if (action !== undefined) wanted[action[0]] += action[1] * KEY_DEFLECTION;
    }
    for (const name of Object.keys(wanted) as AxisName[]) {
      const gap = wanted[name] - this.values[name];
      // Back to the centre at once: a released key must not act on.
      const limit = wanted[name] === 0 ? Infinity : step;
      this.values[name] += Math.sign(gap) * Math.min(Math.abs(gap), limit);
    }
    return { ...this.values, buttons: 0, isHeld: this.held.has(DEAD_MAN_KEY) };
  }
}

/** Sticks on a touch screen: held while a finger is on one of them. */
export class TouchSticks {
  private left: readonly [number, number] | null = null;
  private right: readonly [number, number] | null = null;

  /** Set a stick: x to the right and y up between -1 and 1, or null when the finger has left it. */
  set(side: 'left' | 'right', place: readonly [number, number] | null): void {
    this[side] = place;
  }

  /** Forget the fingers: the sticks are shown no longer, and no event will tell that they were left. */
  clear(): void {
    this.left = null;
    this.right = null;
  }

  read(): Sticks {
    const [yaw, throttle] = this.left ?? [0, 0];
    const [roll, pitch] = this.right ?? [0, 0];
    return { roll, pitch, throttle, yaw, buttons: 0, isHeld: this.left !== null || this.right !== null };
  }
}
