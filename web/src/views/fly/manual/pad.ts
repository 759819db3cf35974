/** The profile of a gamepad or joystick: the ranges of its axes, their use, and actions of its buttons. */

import type { AxisName, PadReading } from './sticks';

/** The values of an axis at its ends and in its middle. */
export interface AxisRange {
  readonly min: number;
  readonly centre: number;
  readonly max: number;
}

/** Actions that buttons have; those that start motors or end a flight need a longer press. */
export const PAD_ACTIONS = ['hold', 'rtl', 'land', 'mission', 'arm', 'disarm', 'photo', 'center'] as const;
export type PadAction = (typeof PAD_ACTIONS)[number];

export interface PadProfile {
  /** Ranges by the index of the axis, of those that were calibrated. */
  readonly ranges: Readonly<Record<number, AxisRange>>;
  /** Indices of axes that differ from those of a standard gamepad. */
  readonly places: Readonly<Partial<Record<AxisName, number>>>;
  /** Actions by the index of the button. */
  readonly actions: Readonly<Record<number, PadAction>>;
}

export const NO_PROFILE: PadProfile = { ranges: {}, places: {}, actions: {} };

/** Share of the way that an axis must have moved to both sides, so that its range counts. */
const MIN_TRAVEL = 0.25;

/** Returns the value of an axis between -1 and 1. */
export function calibrated(value: number, range: AxisRange | undefined): number {
  if (range === undefined || !Number.isFinite(value)) return value;
  const end = value < range.centre ? range.centre - range.min : range.max - range.centre;
  return end <= 0 ? 0 : Math.max(-1, Math.min(1, (value - range.centre) / end));
}

/** Watches the axes while the sticks are moved to all their ends; it begins with centred sticks. */
export class AxisCalibration {
  private readonly centres: readonly number[];
  private readonly low: number[];
  private readonly high: number[];

  constructor(pad: PadReading) {
    this.centres = [...pad.axes];
    this.low = [...pad.axes];
    this.high = [...pad.axes];
  }

  /** Takes the axes as they are now. */
  sample(pad: PadReading): void {
    this.centres.forEach((_, index) => {
      const value = pad.axes[index];
      if (value === undefined || !Number.isFinite(value)) return;
      this.low[index] = Math.min(this.low[index]!, value);
      this.high[index] = Math.max(this.high[index]!, value);
    });
  }

  /** Returns the ranges of the axes that moved to both sides. */
  ranges(): Record<number, AxisRange> {
    const found: Record<number, AxisRange> = {};
    this.centres.forEach((centre, index) => {
      const [min, max] = [this.low[index]!, this.high[index]!];
      if (centre - min > MIN_TRAVEL && max - centre > MIN_TRAVEL) found[index] = { min, centre, max };
    });
    return found;
  }
}

/** Milliseconds for which a button must be pressed. */
const PRESSES: Readonly<Record<PadAction, number>> = {
  hold: 0,
  rtl: 0,
  land: 0,
  mission: 1000,
  arm: 1000,
  disarm: 1000,
  photo: 0,
  center: 0,
};

/** Finds the actions of buttons that are pressed; each press acts once. */
export class PadButtons {
  /** When each button was pressed; null: it has acted, or was pressed before it was seen released. */
  private readonly pressed = new Map<number, number | null>();
  private isFirst = true;
  private system: number | null = null;

  /** Forgets all buttons: those that are pressed now must be released first. */
  clear(): void {
    this.pressed.clear();
    this.isFirst = true;
  }

  /** Returns the actions that the buttons cause now. A press that began for another vehicle causes none.
   *
   * @param now - Milliseconds.
   * @param system - The system id of the vehicle that the actions are for.
   */
  tick(now: number, pad: PadReading, actions: PadProfile['actions'], system: number): PadAction[] {
    if (system !== this.system) this.clear();
    this.system = system;
    const found: PadAction[] = [];
    pad.buttons.forEach(({ pressed }, index) => {
      const action = actions[index];
      if (!pressed || action === undefined) {
        this.pressed.delete(index);
        return;
      }
      if (!this.pressed.has(index)) this.pressed.set(index, this.isFirst ? null : now);
      const since = this.pressed.get(index) ?? null;
      if (since === null || now - since < PRESSES[action]) return;
      this.pressed.set(index, null);
      found.push(action);
    });
    this.isFirst = false;
    return found;
  }
}
