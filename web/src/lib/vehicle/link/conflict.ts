/**
 * Notices two vehicles with one system id on a link of the page itself, where no station watches.
 *
 * A vehicle has one unique id, one type and one clock since its boot. A change of one of them is a reboot, or another
 * vehicle in its place; a change back within seconds is not: both are there. Vehicles that agree in all of them, such
 * as two of one type without unique ids that were switched on together, are not noticed.
 */

import type { DecodedMessage } from '$lib/decoder/Decoder';

import type { Conflict } from '../Vehicle';

/** Difference in ms between two clocks that latency does not explain. */
const MIN_CLOCK_DIFFERENCE = 4000;
/** A change back within this time in ms comes from a second sender. */
const MAX_RETURN_TIME = 10_000;
/** Changes back that a conflict needs: one may be a packet that was held up. */
const MIN_RETURNS = 2;
/** A conflict ends after this time in ms without a further change. */
const LIFETIME = 30_000;

/** Why neither of two vehicles on one link can be chosen or renumbered. */
export const ONE_LINK =
  'both vehicles are on this link: disconnect one of them, then set its system id by its parameter';

/** One property of which a vehicle has one value. */
class Property {
  private now: number | string | null = null;
  private before: { value: number | string; leftAt: number } | null = null;
  private returns: number[] = [];
  private readonly isSame: (one: number | string, other: number | string) => boolean;

  constructor(isSame: Property['isSame'] = (one, other) => one === other) {
    this.isSame = isSame;
  }

  take(value: number | string, time: number): void {
    if (this.now === null || this.isSame(this.now, value)) {
      this.now = value;
      return;
    }
    const { before } = this;
    const isReturn = before !== null && this.isSame(before.value, value) && time - before.leftAt <= MAX_RETURN_TIME;
    if (isReturn) this.returns = [...this.returns, time].slice(-MIN_RETURNS);
    else this.returns = [];
    this.before = { value: this.now, leftAt: time };
    this.now = value;
  }

  isDouble(time: number): boolean {
    return this.returns.length >= MIN_RETURNS && time - this.returns.at(-1)! < LIFETIME;
  }

  clear(): void {
    [this.now, this.before, this.returns] = [null, null, []];
  }
}

export class ConflictDetector {
  private readonly properties: Readonly<Record<'unique id' | 'boot time' | 'type', Property>> = {
    'unique id': new Property(),
    'boot time': new Property((one, other) => Math.abs(Number(one) - Number(other)) < MIN_CLOCK_DIFFERENCE),
    type: new Property(),
  };
  private system = 0;
  private last = 0;
  private shown: Conflict | null = null;

  /** Takes a message of the autopilot. */
  take({ system, name, fields, time }: DecodedMessage): void {
    // A replay that was moved goes on elsewhere in the flight.
    if (time < this.last) for (const property of Object.values(this.properties)) property.clear();
    this.last = time;
    this.system = system;
    if (typeof fields.time_boot_ms === 'number') this.properties['boot time'].take(time - fields.time_boot_ms, time);
    if (name === 'HEARTBEAT') this.properties.type.take(`${Number(fields.type)}/${Number(fields.autopilot)}`, time);
    const id = name === 'AUTOPILOT_VERSION' ? uniqueId(fields) : '';
    if (id !== '') this.properties['unique id'].take(id, time);
  }

  /** Returns the conflict at a time; the same object while nothing changes, null without one. */
  conflict(time: number): Conflict | null {
    const { type, 'unique id': id, 'boot time': boot } = this.properties;
    if (!type.isDouble(time) && !id.isDouble(time) && !boot.isDouble(time)) return (this.shown = null);
    const differs = Object.entries(this.properties)
      .filter(([, property]) => property.isDouble(time))
      .map(([name]) => name);
    // Which property shows it first says nothing new.
    return (this.shown ??= {
      text:
        `two vehicles use system id ${this.system} on this link (they differ in ${differs.join(', ')}): ` +
        'disconnect one of them',
      senders: [],
      chosen: null,
    });
  }
}

function uniqueId(fields: DecodedMessage['fields']): string {
  const long = fields.uid2;
  const bytes = long instanceof Uint8Array ? long : [];
  if (bytes.some((byte) => byte !== 0)) return Array.from(bytes, (byte) => byte.toString(16).padStart(2, '0')).join('');
  const short = String(fields.uid ?? 0);
  return short === '0' ? '' : short;
}
